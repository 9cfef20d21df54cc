#pragma once

#include <Eigen/Geometry>

#include "pdoik/abi.hpp"

namespace pdoik {

/// What a tip has to match of its target.
enum class GoalType {
  Pose,      ///< position and orientation, 6 degrees of freedom
  Axis,      ///< position and the direction of one axis of the tip, 5
  Position,  ///< position, 3
};

/// What one solve asks of one tip.
struct Goal {
  int tip = 0;                                                   ///< its place in robot.tips()
  Eigen::Isometry3d T_base_tip = Eigen::Isometry3d::Identity();  ///< the target
  GoalType type = GoalType::Pose;                                ///< what of it counts
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< in the tip frame, for GoalType::Axis
  double weight = 1.0;  ///< of its squared errors, against the other goals': counts where not all
                        ///< can be met

  /// Whether a Tracker gives nothing of it up for goals that do not stand: a foot on the ground
  /// whatever the hands are asked. Where it is met it stays so, to 0.05 mm and what that is of a
  /// turn, else it is left no farther. A Solver weighs all goals alike. Not for trackers whose
  /// acceleration is limited.
  bool stands = false;

  /// How far the tip may be off along each axis of the target frame without it being an error [m].
  Eigen::Vector3d position_slack = Eigen::Vector3d::Zero();
  /// How far it may be turned about each axis of the target frame, as the components of the
  /// rotation vector from target to tip [rad]; pi frees an axis. For GoalType::Axis the largest
  /// entry is half the angle of a cone.
  Eigen::Vector3d rotation_slack = Eigen::Vector3d::Zero();
};

}  // namespace pdoik
