#include "humanoid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace pdoik::bench {
namespace {

constexpr double kHipHalfSpan = 0.20286;  // half the ankles' distance at q = 0 [m]

/// Pose of an ankle at x: ahead is -y, left is +x.
Eigen::Isometry3d ankle(double x) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() << 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  T.translation().x() = x;
  return T;
}

Robot standing_robot() {
  const Robot h1 = Robot::builtin("h1");
  Robot robot(mounted(builtin_description("h1"), "left_ankle_link", ankle(kHipHalfSpan)), "world",
              {"right_ankle_link"});
  robot.set_occupancy(h1.occupancy());
  robot.set_ignored_pairs(h1.ignored_pairs());
  return robot;
}

// Knees a little bent, arms off the body, the centre of mass over the soles: as joint_names. [rad]
constexpr std::array kStanding{-0.2788, 0.3517, -0.0728, 0.0,     -0.0007, -0.0007, 0.0,
                               -0.0726, 0.3515, -0.2789, 0.0020,  0.1935,  0.1118,  -0.0058,
                               0.7988,  0.1914, -0.1870, -0.0056, 0.7992};

}  // namespace

Standing::Standing() : robot(standing_robot()) {
  right_foot.T_base_tip = ankle(-kHipHalfSpan);
  q0 = Eigen::Map<const Eigen::VectorXd>(kStanding.data(), kStanding.size());
}

Options Standing::options() const {
  Options result;
  result.self_collision = true;
  result.balance.com_lower = {-0.16, -0.07, 0.8};
  result.balance.com_upper = {0.16, 0.075, 0.94};
  return result;
}

Eigen::VectorXd Standing::posture(double t) const {
  const double s = 0.5 - 0.5 * std::cos(3.0 * t);
  Eigen::VectorXd q = q0;
  const auto add = [&](const std::string& joint, double angle) {
    const auto& names = robot.joint_names();
    const auto at = std::find(names.begin(), names.end(), joint) - names.begin();
    q[at] += s * angle;
  };
  for (const std::string side : {"left", "right"}) {
    add(side + "_knee_joint", 0.8);
    add(side + "_ankle_joint", -0.4);
    add(side + "_hip_pitch_joint", -0.4);
  }
  add("torso_joint", 0.5);
  add("left_shoulder_roll_joint", 0.6);
  add("right_shoulder_pitch_joint", -1.0);
  return q;
}

Points swinging_ball(double t) {
  const double y = -1.0 + 0.5 * std::abs(std::remainder(t, 4.0));
  Points points(168, 3);
  for (int i = 0; i < points.rows(); ++i)
    points.row(i) << 0.3 + 0.03 * std::cos(i), y + 0.05 * std::sin(1.7 * i),
        1.1 + 0.1 * std::cos(0.3 * i);
  return points;
}

}  // namespace pdoik::bench
