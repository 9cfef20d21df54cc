#include "detail/reach.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {

Reach reach_of(const Robot& robot, int body, double offset) {
  Reach reach{0, offset};
  for (int b = body; b > 0;) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(b)];
    if (joint.prismatic) {
      const double low = joint.multiplier * robot.lower()[joint.dof] + joint.offset;
      const double high = joint.multiplier * robot.upper()[joint.dof] + joint.offset;
      reach.distance += std::max(std::abs(low), std::abs(high));
    }
    reach.root = b;
    b = joint.parent;
    if (b > 0) reach.distance += joint.T_parent_joint.translation().norm();
  }
  return reach;
}

}  // namespace pdoik::detail
