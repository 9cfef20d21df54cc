#include "kinematics/reach.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

constexpr double kUsualReach = 1.2;                    // of the arms whose numbers are known [m]
constexpr double kLeastUsual = 0.2, kMostUsual = 3.0;  // what the same numbers serve as well [m]

}  // namespace

double farthest_slide(const Body& body, double lower, double upper) {
  if (body.multiplier == 0.0)
    return std::abs(body.offset);  // whatever the limits: 0 times infinity
  return std::max(std::abs(body.multiplier * lower + body.offset),
                  std::abs(body.multiplier * upper + body.offset));
}

Reach reach_of(const Robot& robot, int body, double offset) {
  Reach reach{0, offset, 0.0};
  for (int b = body; b > 0;) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(b)];
    if (joint.prismatic) {
      const double slide =
          farthest_slide(joint, robot.lower()[joint.dof], robot.upper()[joint.dof]);
      reach.distance += slide;
      reach.slides += slide;
    }
    reach.root = b;
    b = joint.parent;
    if (b > 0) reach.distance += joint.T_parent_joint.translation().norm();
  }
  return reach;
}

double relative_size(const Robot& robot) {
  double whole = 0.0, links = 0.0;
  for (const int tip : robot.tips()) {
    const Reach reach =
        reach_of(robot, robot.body_of_link(tip), robot.T_body_link(tip).translation().norm());
    whole = std::max(whole, reach.distance);
    if (std::isfinite(reach.slides)) links = std::max(links, reach.distance - reach.slides);
  }
  if (links > kMostUsual) return links / kUsualReach;
  // One that does not even slide as far as a usual arm reaches.
  return whole > 0.0 && whole < kLeastUsual ? whole / kUsualReach : 1.0;
}

}  // namespace pdoik::detail
