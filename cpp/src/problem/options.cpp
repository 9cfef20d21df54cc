#include "pdoik/options.hpp"

#include "kinematics/reach.hpp"
#include "pdoik/robot.hpp"

namespace pdoik {

bool Options::keeps_off_itself(const Robot& robot) const {
  return self_collision.value_or(method != Method::Paper && !robot.ignored_pairs().empty() &&
                                 !robot.occupancy().capsules.empty());
}

Options Options::sized_for(const Robot& robot) const {
  constexpr double kRotationWeight = 0.3, kPointDistance = 0.5;  // of usual arms [m]
  Options sized = *this;
  const double size = detail::relative_size(robot);
  if (rotation_weight == 0.0) sized.rotation_weight = kRotationWeight * size;
  if (point_distance == 0.0) sized.point_distance = kPointDistance * size;
  return sized;
}

}  // namespace pdoik
