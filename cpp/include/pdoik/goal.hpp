#pragma once

#include <Eigen/Geometry>
#include <cstddef>

#include "pdoik/abi.hpp"

namespace pdoik {

/// What a goal asks.
enum class GoalType {
  Pose,          ///< position and orientation of a tip, 6 degrees of freedom
  Axis,          ///< position and the direction of one axis of it, 5
  Position,      ///< position, 3
  LookAt,        ///< that one axis of it points at the target's origin from wherever it is, 2
  CenterOfMass,  ///< of the whole robot, the position: a box along the base's axes, no tip's
};

/// What comes first where not all of a goal can be met.
enum class Priority {
  Both,      ///< nothing: position and orientation are one sum
  Position,  ///< position is met, and orientation as near as can be: see Status::Nearest
};

/// So many goals can be asked of one solve.
inline constexpr std::size_t kMostGoals = 64;

/// One requirement. A solve is asked several: of one tip or of many, hard ones and soft ones.
struct Goal {
  int tip = 0;                                                   ///< its place in robot.tips()
  Eigen::Isometry3d T_base_tip = Eigen::Isometry3d::Identity();  ///< the target
  /// Another tip's place in robot.tips(), in whose frame the target then is instead: two hands on
  /// one thing, wherever it is. Less than 0: the base's frame.
  int relative_to = -1;
  GoalType type = GoalType::Pose;                   ///< what of it counts
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< in the tool frame, for Axis and LookAt
  /// What of the tip has to be at the target, in the tip link's frame: a tool on the flange.
  Eigen::Isometry3d T_tip_tool = Eigen::Isometry3d::Identity();
  double weight = 1.0;  ///< of its squared errors, against the other goals': counts where not all
                        ///< can be met
  /// Whether it is a wish: what is hard is met first, and of that what is soft falls short of least
  /// by going downhill from the first solution found, with Prefer::Nearest from all. What success
  /// means does not look at it. Not of the centre of mass, not for a Tracker.
  bool soft = false;
  Priority priority = Priority::Both;  ///< of a pose or an axis; not for a Tracker

  /// Whether a Tracker gives nothing of it up for goals that do not stand: a foot on the ground
  /// whatever the hands are asked. Where it is met it stays so, to 0.05 mm and what that is of a
  /// turn, else it is left no farther. A Solver weighs all goals alike. Not for trackers whose
  /// acceleration is limited.
  bool stands = false;

  /// How far the tip may be off along each axis of the target frame without it being an error [m];
  /// infinity frees it.
  Eigen::Vector3d position_slack = Eigen::Vector3d::Zero();
  /// How far it may be turned about each axis of the target frame, as the components of the
  /// rotation vector from target to tip [rad]; pi frees an axis. For Axis and LookAt the largest
  /// entry is half the angle of a cone.
  Eigen::Vector3d rotation_slack = Eigen::Vector3d::Zero();
  double position_tolerance = 0.0;  ///< largest error of a success [m]; 0 for the options'
  double rotation_tolerance = 0.0;  ///< [rad]; 0 for the options'

  /// Let the tip be anywhere in a box of the target frame: from `lower` to `upper` along its axes
  /// [m], either of which may be infinite.
  /// @throws std::invalid_argument  A lower bound is above its upper one, or is no number.
  Goal& between(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);
  /// Let it be turned by anything from `lower` to `upper` about the axes of the target frame [rad],
  /// counted as components of the rotation vector from the middle of the two. For Pose.
  /// @throws std::invalid_argument  The same, or infinity.
  Goal& turned_between(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper);
};

}  // namespace pdoik
