#include "detail/reach.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {

double farthest_slide(const Body& body, double lower, double upper) {
  if (body.multiplier == 0.0)
    return std::abs(body.offset);  // whatever the limits: 0 times infinity
  return std::max(std::abs(body.multiplier * lower + body.offset),
                  std::abs(body.multiplier * upper + body.offset));
}

Reach reach_of(const Robot& robot, int body, double offset) {
  Reach reach{0, offset};
  for (int b = body; b > 0;) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(b)];
    if (joint.prismatic) {
      reach.distance += farthest_slide(joint, robot.lower()[joint.dof], robot.upper()[joint.dof]);
    }
    reach.root = b;
    b = joint.parent;
    if (b > 0) reach.distance += joint.T_parent_joint.translation().norm();
  }
  return reach;
}

}  // namespace pdoik::detail
