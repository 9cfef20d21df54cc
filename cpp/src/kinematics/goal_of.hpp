#pragma once

#include "pdoik/options.hpp"

namespace pdoik::detail {

/// The goal of the options' type for a tip.
inline Goal goal_of(const Options& options, const Eigen::Isometry3d& T_base_tip, int tip = 0) {
  Goal goal;
  goal.tip = tip;
  goal.T_base_tip = T_base_tip;
  goal.type = options.goal;
  goal.axis = options.goal_axis;
  goal.T_tip_tool = options.T_tip_tool;
  goal.priority = options.priority;
  return goal;
}

/// What a goal allows: its own tolerance, or the options'.
inline double position_tolerance(const Goal& goal, const Options& options) {
  return goal.position_tolerance > 0.0 ? goal.position_tolerance : options.position_tolerance;
}
inline double rotation_tolerance(const Goal& goal, const Options& options) {
  return goal.rotation_tolerance > 0.0 ? goal.rotation_tolerance : options.rotation_tolerance;
}

inline bool has_slack(const Goal& goal) {
  return !goal.position_slack.isZero(0.0) || !goal.rotation_slack.isZero(0.0);
}
/// Whether a hard goal says where its tip has to be, and in the base frame.
inline bool has_place(const Goal& goal) {
  return !goal.soft && goal.relative_to < 0 && goal.type != GoalType::LookAt &&
         goal.type != GoalType::CenterOfMass;
}

}  // namespace pdoik::detail
