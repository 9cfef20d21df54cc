#include "pdoik/options.hpp"

#include "pdoik/robot.hpp"

namespace pdoik {

bool Options::keeps_off_itself(const Robot& robot) const {
  return self_collision.value_or(method != Method::Paper && !robot.ignored_pairs().empty() &&
                                 !robot.occupancy().capsules.empty());
}

}  // namespace pdoik
