#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

#include "bytes.hpp"
#include "pdoik/floating_base.hpp"
#include "pdoik/solver.hpp"
#include "random_robots.hpp"

/// Robots, options, goals and clouds from bytes. What is asked is sensible more often than not, so
/// that it gets past the checks at the border; each part may turn wild and is then anything. Bytes
/// are taken once in an expression, or in a list in braces: compilers differ in which operand they
/// evaluate first, and an input must mean the same to all.
namespace pdoik::fuzz {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Wild in about one of eight parts; then most numbers are still sensible.
inline void choose_wildness(Bytes& bytes) {
  const std::uint8_t kind = bytes.byte();
  bytes.be_wild(kind < 224 ? 0 : kind < 240 ? 16 : 2);
}

inline Eigen::Vector3d vector3(Bytes& bytes, double extent) {
  const double x = bytes.number(-extent, extent), y = bytes.number(-extent, extent);
  return {x, y, bytes.number(-extent, extent)};
}

inline Eigen::VectorXd vector(Bytes& bytes, Eigen::Index size, double low, double high) {
  Eigen::VectorXd v(size);
  for (double& each : v) each = bytes.number(low, high);
  return v;
}

/// A direction: an axis of the frame as often as not.
inline Eigen::Vector3d direction(Bytes& bytes) {
  const int kind = bytes.integer(0, 7);
  if (kind < 6) return (kind < 3 ? 1.0 : -1.0) * Eigen::Vector3d::Unit((kind + 2) % 3);
  return vector3(bytes, 1.0);
}

/// A rigid transform, if the bytes are not wild.
inline Eigen::Isometry3d pose(Bytes& bytes, double extent) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = vector3(bytes, extent);
  if (bytes.one_in(2)) {
    const Eigen::Vector3d axis = vector3(bytes, 1.0) + Eigen::Vector3d(0.0, 0.0, 1e-3);
    T.linear() = Eigen::AngleAxisd(bytes.number(-M_PI, M_PI), axis.normalized()).toRotationMatrix();
  }
  if (bytes.one_in(32)) {
    const double value = bytes.any_double();
    const int row = bytes.integer(0, 2), column = bytes.integer(0, 2);
    T.linear()(row, column) = value;
  }
  return T;
}

/// A tree of 1 to 9 joints of all kinds. Links are l0, l1, ...
inline RobotDescription description(Bytes& bytes) {
  choose_wildness(bytes);
  RobotDescription result;
  result.name = "fuzzed";
  const int joints = bytes.integer(1, 9);
  const bool branches = bytes.one_in(4);
  const bool has_mass = bytes.one_in(3);
  for (int i = 0; i <= joints; ++i) {
    LinkDescription link{.name = "l" + std::to_string(i)};
    if (has_mass) {
      link.mass = bytes.number(0.0, 5.0);
      link.center_of_mass = vector3(bytes, 0.2);
    }
    result.links.push_back(link);
  }
  constexpr JointType kTypes[] = {JointType::Revolute,   JointType::Revolute,  JointType::Revolute,
                                  JointType::Continuous, JointType::Prismatic, JointType::Fixed};
  constexpr double kSpeeds[] = {2.0, 0.0, 1e-300, 1e-3, 1e3, 1e300, kInfinity};
  for (int i = 1; i <= joints; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = bytes.pick(kTypes);
    joint.parent_link = "l" + std::to_string(branches ? bytes.integer(0, i - 1) : i - 1);
    joint.child_link = "l" + std::to_string(i);
    joint.T_parent_child = pose(bytes, 0.5);
    joint.axis = direction(bytes);
    if (joint.type != JointType::Continuous &&
        !(joint.type == JointType::Prismatic && bytes.one_in(3))) {
      joint.lower = bytes.number(-4.0, 1.0);
      joint.upper = joint.lower + bytes.number(0.0, 7.0);
    }
    joint.velocity = bytes.one_in(3) ? bytes.number(0.0, 5.0) : bytes.pick(kSpeeds);
    if (i > 1 && bytes.one_in(6)) {
      joint.mimic = Mimic{"j" + std::to_string(bytes.integer(1, i)), bytes.number(-2.0, 2.0),
                          bytes.number(-0.5, 0.5)};
    }
    result.joints.push_back(joint);
  }
  if (bytes.one_in(8)) {
    FloatingBaseBounds bounds;
    for (int k = 0; k < 6; ++k) {
      bounds.lower[k] = bytes.number(-1.5, 0.0);
      bounds.upper[k] = bytes.number(0.0, 1.5);
    }
    result = with_floating_base(result, "l0", bounds);
  }
  return result;
}

inline std::string any_link(Bytes& bytes, const Robot& robot) {
  return robot.link_names()[bytes.byte() % robot.link_names().size()];
}

inline Occupancy occupancy(Bytes& bytes, const Robot& robot) {
  choose_wildness(bytes);
  Occupancy result;
  const int spheres = bytes.integer(0, 4), spheroids = bytes.integer(0, 4);
  for (int i = 0; i < spheres; ++i) {
    const std::string link = any_link(bytes, robot);
    const Eigen::Vector3d center = vector3(bytes, 0.1);
    result.spheres.push_back({link, center, bytes.number(0.01, 0.2)});
  }
  for (int i = 0; i < spheroids; ++i) {
    Spheroid s;
    s.link_a = any_link(bytes, robot);
    s.link_b = any_link(bytes, robot);
    s.focus_a = vector3(bytes, 0.1);
    s.focus_b = vector3(bytes, 0.1);
    s.semi_major = bytes.number(0.2, 0.6);
    result.spheroids.push_back(s);
  }
  return result;
}

/// A robot with hulls and tips. Throws what its makers throw.
inline Robot robot(Bytes& bytes) {
  const RobotDescription parts = description(bytes);
  constexpr int kLastLink = 0, kEveryLeaf = 1, kTwoLinks = 2;
  const int tips = bytes.integer(kLastLink, kTwoLinks);
  const auto some_link = [&] { return parts.links[bytes.byte() % parts.links.size()].name; };
  std::vector<std::string> tip_links;
  if (tips == kLastLink) tip_links = {parts.joints.back().child_link};
  if (tips == kTwoLinks) tip_links = {some_link(), some_link()};
  const std::string base = bytes.one_in(8) ? some_link() : "";  // the root, "world" if it floats
  Robot result(parts, base, tips == kEveryLeaf ? std::vector<std::string>{} : tip_links);
  if (!bytes.one_in(8)) result.set_occupancy(occupancy(bytes, result));
  if (bytes.one_in(8)) {
    const std::string one = any_link(bytes, result);
    result.set_ignored_pairs({{one, any_link(bytes, result)}});
  }
  return result;
}

inline BalanceOptions balance(Bytes& bytes, const Robot& robot) {
  BalanceOptions result;
  if (bytes.one_in(2)) {
    for (int axis = 0; axis < 3; ++axis) {
      result.com_lower[axis] = bytes.number(-1.0, 0.0);
      result.com_upper[axis] = bytes.number(0.0, 1.0);
    }
  }
  const int contacts = bytes.integer(0, 2);
  for (int i = 0; i < contacts; ++i) {
    Contact contact{.link = any_link(bytes, robot), .points = {}};
    const int points = bytes.integer(0, 4);
    for (int k = 0; k < points; ++k) contact.points.push_back(vector3(bytes, 0.3));
    result.contacts.push_back(contact);
  }
  result.support_margin = bytes.number(0.0, 0.1);
  if (bytes.one_in(4)) result.up = direction(bytes);
  return result;
}

inline Options options(Bytes& bytes, const Robot& robot) {
  choose_wildness(bytes);
  constexpr GoalType kGoals[] = {GoalType::Pose, GoalType::Axis, GoalType::Position};
  constexpr double kTimes[] = {1e-3, 1e-3, 3e-3, 1e-4, 1e-6, 1e-12, kInfinity};
  Options o;
  o.goal = bytes.pick(kGoals);
  if (bytes.one_in(4)) o.goal_axis = direction(bytes);
  const int method = bytes.integer(0, 3);
  o.method = method == 3 ? Method::Paper : Method::Default;
  o.inner = method == 2 ? InnerMethod::Lbfgs : InnerMethod::LevenbergMarquardt;
  if (bytes.one_in(2)) {
    constexpr double kTolerances[] = {1e-3, 1e-5, 1e-9, 1e-15, 0.1, 10.0};
    o.position_tolerance = bytes.pick(kTolerances);
    o.rotation_tolerance = bytes.pick(kTolerances);
    o.clearance_tolerance = bytes.pick(kTolerances);
  }
  if (bytes.one_in(2)) o.clearance = bytes.number(-0.2, 0.2);
  o.base_collision = !bytes.one_in(4);
  o.ignore_obstacles_without_hulls = true;  // some robots have none
  if (bytes.one_in(4)) o.balance = balance(bytes, robot);
  o.self_collision = bytes.one_in(4);
  if (o.self_collision) o.self_clearance = bytes.number(-0.1, 0.1);
  o.prefer = bytes.one_in(6) ? Prefer::Nearest : Prefer::First;
  if (bytes.one_in(6)) o.joint_weights = vector(bytes, robot.dof(), 0.0, 2.0);
  o.max_time = bytes.one_in(16) ? bytes.number(0.0, 2e-3) : bytes.pick(kTimes);
  if (o.max_time > 3e-3) o.max_time = 3e-3;  // so that executions are many
  o.max_restarts = bytes.integer(0, 6);
  if (bytes.one_in(64)) o.max_restarts -= 7;
  o.seed = bytes.byte();
  if (bytes.one_in(8)) {  // everything else
    constexpr int kCounts[] = {1, 0, -1, 2, 100, 2000, std::numeric_limits<int>::min()};
    o.max_obstacles = bytes.pick(kCounts);
    o.posture_weight = bytes.number(1e-6, 1.0);
    o.rotation_weight = bytes.number(1e-3, 2.0);
    o.collision_weight = bytes.number(1e-3, 2.0);
    o.start_inset = bytes.number(1e-6, 0.49);
    o.point_distance = bytes.number(1e-3, 2.0);
    o.lbfgs.memory = bytes.pick(kCounts);
    o.lbfgs.max_iterations = bytes.pick(kCounts);
    o.lbfgs.max_line_search = bytes.pick(kCounts);
    o.lbfgs.gradient_tolerance = bytes.number(0.0, 1e-3);
    o.lbfgs.relative_decrease = bytes.number(0.0, 1e-3);
    o.lbfgs.first_step = bytes.number(1e-3, 10.0);
    o.lbfgs.max_step = bytes.number(1e-3, 10.0);
    o.lbfgs.armijo = bytes.number(1e-4, 0.3);
    o.lbfgs.curvature = bytes.number(0.3, 0.99);
    o.augmented_lagrangian.rho = bytes.number(0.1, 10.0);
    o.augmented_lagrangian.rho_growth = bytes.number(1.0, 100.0);
    o.augmented_lagrangian.rho_max = bytes.number(1.0, 1e12);
    o.augmented_lagrangian.beta = bytes.number(0.1, 1.0);
    o.augmented_lagrangian.constraint_tolerance = bytes.number(0.0, 1e-3);
    o.augmented_lagrangian.max_outer_iterations = bytes.pick(kCounts);
    o.levenberg_marquardt.max_iterations = bytes.pick(kCounts);
    o.levenberg_marquardt.first_damping = bytes.number(1e-6, 1.0);
    o.levenberg_marquardt.damping_decrease = bytes.number(0.01, 1.0);
    o.levenberg_marquardt.damping_increase = bytes.number(1.1, 10.0);
    o.levenberg_marquardt.max_damping = bytes.number(1.0, 1e9);
    o.levenberg_marquardt.stall_ratio = bytes.number(0.1, 1.0);
    o.levenberg_marquardt.stall_window = bytes.pick(kCounts);
  }
  return o;
}

using Cloud = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// 0 to 300 points from a seed, some of them then moved: into a link, onto each other, anywhere.
inline Cloud cloud(Bytes& bytes, const Robot& robot) {
  choose_wildness(bytes);
  const int count = bytes.one_in(4) ? bytes.integer(0, 5) : 60 * bytes.integer(0, 5);
  constexpr double kExtents[] = {1.0, 3.0, 0.3, 30.0, 1e-6, 1e5};
  const double extent = bytes.pick(kExtents);
  const double radius = bytes.one_in(3) ? bytes.number(0.0, 0.1) : 0.0;
  testing::Random random(bytes.byte());
  Cloud points = testing::random_obstacles(random, count, extent, radius);
  const int moved = std::min(count, bytes.integer(0, 4));
  for (int k = 0; k < moved; ++k) {
    if (bytes.one_in(2)) {
      const Eigen::Isometry3d T = robot.fk(robot.mid_configuration(), any_link(bytes, robot));
      points.row(k).head<3>() = T.translation().transpose();
    } else {
      for (Eigen::Index c = 0; c < points.cols(); ++c)
        points(k, c) = bytes.number(c == 3 ? 0.0 : -1.0, 1.0);
    }
  }
  if (bytes.one_in(64)) points = Cloud::Constant(count, bytes.integer(0, 6), 0.5);  // wrong shapes
  return points;
}

/// A configuration inside the limits, if the bytes are not wild.
inline Eigen::VectorXd configuration(Bytes& bytes, const Robot& robot) {
  choose_wildness(bytes);
  Eigen::VectorXd q(robot.dof());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool bounded = std::isfinite(robot.lower()[i]) && std::isfinite(robot.upper()[i]);
    const double share = bytes.number(0.0, 1.0);
    q[i] = bounded ? robot.lower()[i] + share * (robot.upper()[i] - robot.lower()[i])
                   : 2.0 * M_PI * (share - 0.5);
  }
  if (bytes.one_in(64)) q.conservativeResize(bytes.integer(0, 10));
  return q;
}

/// Goals for some tips: mostly what some configuration has, so that many can be met.
inline std::vector<Goal> goals(Bytes& bytes, const Robot& robot, const Options& options) {
  testing::Random random(bytes.byte());
  const Eigen::VectorXd reachable = testing::random_configuration(robot, random);
  choose_wildness(bytes);
  std::vector<Goal> result;
  const auto tips = static_cast<int>(robot.tips().size());
  const int count = bytes.one_in(64) ? bytes.integer(0, 3) : std::min(tips, bytes.integer(1, 3));
  constexpr GoalType kGoals[] = {GoalType::Pose, GoalType::Axis, GoalType::Position};
  for (int i = 0; i < count; ++i) {
    Goal goal;
    goal.tip = bytes.one_in(64) ? bytes.integer(-1, 3) : i;
    goal.type = bytes.one_in(3) ? bytes.pick(kGoals) : options.goal;
    goal.axis = bytes.one_in(4) ? direction(bytes) : options.goal_axis;
    const bool there_is = goal.tip >= 0 && goal.tip < tips;
    if (there_is && !bytes.one_in(3)) {
      goal.T_base_tip = robot.fk(reachable, robot.tips()[static_cast<std::size_t>(goal.tip)]);
      if (bytes.one_in(3)) goal.T_base_tip.translation() += vector3(bytes, 1e-3);
    } else {
      goal.T_base_tip = pose(bytes, 1.0);
    }
    if (bytes.one_in(6)) goal.weight = bytes.number(0.01, 10.0);
    if (bytes.one_in(6)) goal.position_slack = vector3(bytes, 0.1).cwiseAbs();
    if (bytes.one_in(6)) goal.rotation_slack = vector3(bytes, 3.2).cwiseAbs();
    if (bytes.one_in(8)) goal.T_tip_tool = pose(bytes, 0.3);
    if (bytes.one_in(8)) goal.type = GoalType::LookAt;
    if (bytes.one_in(8)) goal.relative_to = bytes.integer(-1, tips);
    if (bytes.one_in(12)) goal.soft = true;
    if (bytes.one_in(12)) goal.priority = Priority::Position;
    if (bytes.one_in(8)) goal.position_tolerance = bytes.number(1e-6, 1e-2);
    if (bytes.one_in(24)) goal.position_slack[bytes.integer(0, 2)] = kInfinity;
    result.push_back(goal);
  }
  return result;
}

}  // namespace pdoik::fuzz
