#pragma once

#include <cmath>
#include <span>

#include "brute_force.hpp"
#include "decode.hpp"
#include "pdoik/solver.hpp"
#include "property.hpp"

/// What must hold of an answer, recomputed from q by Robot::fk and plain loops.
namespace pdoik::fuzz {

/// Inside the limits exactly, and numbers.
inline void check_configuration(const Robot& robot, const Eigen::VectorXd& q) {
  PDOIK_PROPERTY(q.size() == robot.dof(), q.size());
  PDOIK_PROPERTY(q.allFinite(), q.transpose());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    PDOIK_PROPERTY(robot.lower()[i] <= q[i] && q[i] <= robot.upper()[i],
                   "q[" << i << "] = " << q[i] << " outside " << robot.lower()[i] << " to "
                        << robot.upper()[i]);
  }
}

/// The length of what each component has beyond its slack.
inline double beyond(const Eigen::Vector3d& error, const Eigen::Vector3d& slack) {
  return (error.cwiseAbs() - slack).cwiseMax(0.0).norm();
}

inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return 2.0 * std::atan2((a.normalized() - b.normalized()).norm(),
                          (a.normalized() + b.normalized()).norm());
}

inline double rotation_error(const Goal& goal, const Eigen::Isometry3d& T,
                             const Eigen::Isometry3d& T_base_target) {
  const Eigen::Matrix3d R = T.linear(), target = T_base_target.linear();
  if (goal.type == GoalType::LookAt) {
    const Eigen::Vector3d way = T_base_target.translation() - T.translation();
    if (way.norm() < 1e-6) return 0.0;  // nowhere to look
    return std::max(0.0, angle_between(R * goal.axis, way) - goal.rotation_slack.maxCoeff());
  }
  if (goal.type == GoalType::Position) return 0.0;
  if (goal.type == GoalType::Axis) {
    const double angle = angle_between(R * goal.axis, target * goal.axis);
    return std::max(0.0, angle - goal.rotation_slack.maxCoeff());
  }
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(target.transpose() * R));
  const double angle = turn.angle();
  if (goal.rotation_slack.isZero(0.0)) return angle;
  return beyond(angle * turn.axis(), goal.rotation_slack);
}

/// A success is one: goals, limits and clearance by other means than the library's own.
/// @param look  Clearance is not told beyond this [m].
inline void check_success(const Robot& robot, const Options& options, std::span<const Goal> goals,
                          const Cloud& obstacles, const Result& result, double look = kInfinity) {
  // What rounding of the target's and the tip's coordinates may hide.
  double scale = 1.0;
  for (const Goal& goal : goals)
    scale = std::max(scale, goal.T_base_tip.translation().cwiseAbs().maxCoeff());
  if (result.q.size() > 0) scale = std::max(scale, result.q.cwiseAbs().maxCoeff());
  const double rounding = 1e-9 * scale;
  PDOIK_PROPERTY(!goals.empty());
  for (const Goal& goal : goals) {
    if (goal.soft) continue;
    const auto at = [&](int tip) {
      return robot.fk(result.q, robot.tips()[static_cast<std::size_t>(tip)]);
    };
    const Eigen::Isometry3d T = at(goal.tip) * goal.T_tip_tool;
    Eigen::Isometry3d target = goal.T_base_tip;
    if (goal.relative_to >= 0) target = at(goal.relative_to) * target;
    const Eigen::Vector3d off =
        target.linear().transpose() * (T.translation() - target.translation());
    const double position = goal.type == GoalType::LookAt ? 0.0 : beyond(off, goal.position_slack);
    const double allowed = std::max(options.position_tolerance, goal.position_tolerance);
    PDOIK_PROPERTY(position <= allowed + rounding,
                   "tip " << goal.tip << ": " << position << ", told " << result.position_error);
    const double rotation = rotation_error(goal, T, target);
    // A target may itself be off a rotation by 1e-6.
    PDOIK_PROPERTY(rotation <= options.rotation_tolerance + rounding + 4e-6,
                   "tip " << goal.tip << ": " << rotation << ", told " << result.rotation_error);
  }
  if (obstacles.rows() > 0 && options.base_collision) {
    const double clearance = testing::brute_force_clearance(robot, result.q, obstacles, 100);
    const double blur = 1e-7 + rounding + 1e-12 * obstacles.cwiseAbs().maxCoeff();
    PDOIK_PROPERTY(clearance >= options.clearance - options.clearance_tolerance - blur,
                   clearance << ", told " << result.clearance << ", wanted " << options.clearance);
    PDOIK_PROPERTY(result.clearance <= clearance + blur || clearance >= look,
                   clearance << ", told " << result.clearance);
  }
  if (options.balance.wanted()) {
    const Eigen::Vector3d com = robot.center_of_mass(result.q);
    const double slack = options.clearance_tolerance + 1e-9 * scale;
    for (int axis = 0; axis < 3; ++axis) {
      PDOIK_PROPERTY(com[axis] >= options.balance.com_lower[axis] - slack &&
                         com[axis] <= options.balance.com_upper[axis] + slack,
                     "centre of mass " << com.transpose());
    }
  }
}

}  // namespace pdoik::fuzz
