#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/lbfgs.hpp"
#include "pdoik/levenberg_marquardt.hpp"

namespace pdoik {

class Robot;

/// Which algorithm solves.
enum class Method {
  Default,  ///< restarts from a low-discrepancy sequence, Levenberg-Marquardt and L-BFGS inside
  /// Algorithm IK with its misprints corrected, from one start. L-BFGS ends as soon as goal and
  /// constraints hold to the tolerances, which the paper leaves open.
  Paper,
};

/// How the default method minimises from one start.
enum class InnerMethod {
  LevenbergMarquardt,  ///< Gauss-Newton steps in joint positions inside their limits
  Lbfgs,               ///< the paper's: augmented Lagrangian with L-BFGS over the slack variables
};

/// Which of several solutions is wanted.
enum class Prefer {
  First,    ///< the first that is found
  Nearest,  ///< the one nearest to the posture (or the start) that the budget finds
};

/// Points by which a link stands on the ground.
struct Contact {
  std::string link;                     ///< by name
  std::vector<Eigen::Vector3d> points;  ///< corners of the sole, in the link frame [m]
};

/// Where the centre of mass has to be (Eq. com). The base link's mass counts.
struct BalanceOptions {
  /// A box along the base frame's axes [m].
  Eigen::Vector3d com_lower = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
  /// Its upper corner [m].
  Eigen::Vector3d com_upper = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  /// Over the convex hull of these, seen along `up`; empty for anywhere.
  std::vector<Contact> contacts;
  double support_margin = 0.0;                    ///< at least this far inside the hull's edges [m]
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< against gravity, in the base frame

  /// Whether anything is asked of the centre of mass.
  bool wanted() const {
    return !contacts.empty() ||
           !(com_lower.array() == -std::numeric_limits<double>::infinity()).all() ||
           !(com_upper.array() == std::numeric_limits<double>::infinity()).all();
  }
};

/// Contact that is wanted at the target: a gripper at what it grasps, a flange on a surface.
struct TouchOptions {
  /// Obstacles that are no farther than this from a goal's target may be touched; 0 for none [m].
  double radius = 0.0;
  double depth = 0.01;  ///< no deeper than this, of a point whatever its radius [m]
  /// Which links may touch them; empty for a tip's and those after it.
  std::vector<std::string> links = {};
};

/// What a solver aims at and how. Metres, radians, seconds.
struct Options {
  /// @name What is asked
  /// @{

  GoalType goal = GoalType::Pose;                        ///< of targets that are bare poses
  Eigen::Vector3d goal_axis = Eigen::Vector3d::UnitZ();  ///< in the tip frame, for GoalType::Axis
  /// Of targets that are bare poses: what of the tip has to be at the target, in its link's frame.
  Eigen::Isometry3d T_tip_tool = Eigen::Isometry3d::Identity();
  Priority priority = Priority::Both;  ///< of targets that are bare poses
  Method method = Method::Default;     ///< which algorithm

  double position_tolerance = 1e-5;  ///< largest position error of a success [m]
  double rotation_tolerance = 1e-5;  ///< largest rotation (or axis) error of a success [rad]
  /// @}
  /// @name Obstacles
  /// @{

  /// Least distance wanted of obstacles where no ContactRule says another; negative: how deep they
  /// may lie in hulls, of points for Method::Default with InnerMethod::LevenbergMarquardt [m].
  double clearance = 0.0;
  double clearance_tolerance = 1e-6;  ///< by how much a success may miss `clearance` [m]
  /// How far obstacles are looked for to tell Result::clearance: beyond this it is told as this, or
  /// as `clearance` where that is more. Far ones take time among points that change with each
  /// solve; whether an answer holds does not depend on it [m].
  double report_clearance = std::numeric_limits<double>::infinity();

  /// Whether an obstacle in a hull that no joint moves, about which no answer can do anything,
  /// makes a solve fail. Off for clouds that show the table the robot stands on.
  bool base_collision = true;
  /// Whether a link's own pieces decide where its capsules touch something, so that `success` is
  /// true of the link to their tolerance (see Occupancy::pieces); else capsules decide.
  bool exact_contact = true;
  /// Whether a robot that has no hulls may be among obstacles, and carry something: but for what it
  /// carries nothing of it then keeps off anything. Off: it is refused among them.
  bool ignore_obstacles_without_hulls = false;
  TouchOptions touch = {};  ///< what may be touched at the target
  /// @}
  /// @name Balance and self-collision
  /// @{

  BalanceOptions balance = {};  ///< where the centre of mass has to be
  /// Keep hulls of links that are not adjacent off one another; nothing for where this says
  /// something of the links: it is known which pairs may touch (the robot has ignored pairs) and
  /// hulls are close (it has capsules). Not with the paper's method.
  std::optional<bool> self_collision = std::nullopt;
  double self_clearance = 0.0;  ///< by at least this much, or what a ContactRule says [m]
  /// @}

  /// @name Which solution
  /// @{

  Prefer prefer = Prefer::First;  ///< which of several solutions
  /// Of the squared distance to the posture, where one is given, against goals and constraints,
  /// which are met first [m^2/rad^2].
  double posture_weight = 1e-3;
  /// What each joint's distance to the posture counts beside the others', shape (n,), not negative;
  /// empty for all alike. Also what "nearest" means.
  Eigen::VectorXd joint_weights = {};
  /// @}

  /// @name Budget
  /// @{

  /// Deadline of a solve, which taking in obstacles is not part of [s]. What the last verdicts
  /// took, but no more than half, is kept for the verdict at the end.
  double max_time = 0.01;
  int max_restarts = 1000;  ///< starts after the first; Method::Paper has none
  std::uint64_t seed = 0;   ///< of the restarts' sequence
  /// @}

  /// @name Inside the method
  /// @{

  InnerMethod inner = InnerMethod::LevenbergMarquardt;  ///< for Method::Default
  int max_obstacles = 1024;  ///< obstacle points that fit without a further allocation

  /// Metres that one radian weighs in Levenberg-Marquardt's residual; 0 for by the robot's size:
  /// 0.3 m for arms of the usual sizes, see `sized_for` [m].
  double rotation_weight = 0.0;
  double collision_weight =
      0.5;  ///< weight of a metre of penetration in Levenberg-Marquardt's residual
  double start_inset =
      0.01;  ///< starts for the slack variables keep this fraction of a range off the limits
  /// k_p = q_p, where the goal's points sit on the tip's axes; 0 for by the robot's size: 0.5 m for
  /// arms of the usual sizes [m] (Eq. vwep).
  double point_distance = 0.0;

  /// Of the paper's inner minimiser.
  LbfgsOptions lbfgs{.first_step = 5.0, .max_step = 4.0, .curvature = 0.5};
  AugmentedLagrangianOptions augmented_lagrangian = {};  ///< of Algorithm IK's outer loop
  /// Of the least-squares minimiser.
  LevenbergMarquardtOptions levenberg_marquardt{.stall_ratio = 0.8, .stall_window = 2};

  /// What self_collision comes to for a robot.
  bool keeps_off_itself(const Robot& robot) const;
  /// These with the lengths that are 0 for by the robot's size as they come to for a robot: times
  /// its reach over 1.2 m where no tip reaches 0.2 m from the first joint that moves it, or one
  /// does 3 m, slides left out; as they are said for usual sizes else.
  Options sized_for(const Robot& robot) const;
  /// @}
};

}  // namespace pdoik
