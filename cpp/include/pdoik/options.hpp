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

// An option is typed here once: python/bindings/option_fields.py writes what checks, binds and
// documents it from its declaration and its comment, which ends with the range and the unit.

/// Where the centre of mass has to be (Eq. com). The base link's mass counts.
struct BalanceOptions {
  /// Lower corner of a box along the base frame's axes [m].
  Eigen::Vector3d com_lower = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
  /// Its upper corner [m].
  Eigen::Vector3d com_upper = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  /// Points by which links stand on the ground. The centre of mass has to be over their convex
  /// hull, seen along `up`; empty for anywhere.
  std::vector<Contact> contacts;
  double support_margin = 0.0;  ///< at least this far inside the hull's edges, in (-inf, inf) [m]
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
  /// Obstacles that are no farther than this from a goal's target may be touched; 0 for none, in
  /// [0, inf) [m].
  double radius = 0.0;
  double depth = 0.01;  ///< no deeper than this, of a point whatever its radius, in [0, inf] [m]
  /// Which links may touch them; empty for a tip's and those after it.
  std::vector<std::string> links = {};
};

/// What a solver aims at and how. Metres, radians, seconds.
struct Options {
  /// @name What is asked
  /// @{

  /// What the tip has to match of targets that are bare poses: GoalType::Pose all 6 degrees of
  /// freedom, GoalType::Axis its position and the direction of one axis, GoalType::Position nothing
  /// but its position.
  GoalType goal = GoalType::Pose;
  /// In the tip frame, for GoalType::Axis, of any length.
  Eigen::Vector3d goal_axis = Eigen::Vector3d::UnitZ();
  /// What of the tip has to be at targets that are bare poses, in the tip link's frame: a tool on
  /// the flange [m].
  Eigen::Isometry3d T_tip_tool = Eigen::Isometry3d::Identity();
  /// What comes first of targets that are bare poses where not all can be met.
  Priority priority = Priority::Both;
  Method method = Method::Default;  ///< which algorithm solves

  double position_tolerance = 1e-5;  ///< largest position error of a success, in (0, inf) [m]
  /// Largest rotation (or axis) error of a success, in (0, inf) [rad].
  double rotation_tolerance = 1e-5;
  /// @}
  /// @name Obstacles
  /// @{

  /// Least distance wanted between obstacles and hulls, or what links carry, but for pairs of which
  /// a ContactRule says otherwise. Negative: how deep obstacles may lie in hulls, of points for
  /// Method::Default with InnerMethod::LevenbergMarquardt. In [-1e6, 1e6] [m].
  double clearance = 0.0;
  /// By how much a success may miss `clearance`, in [0, inf) [m].
  double clearance_tolerance = 1e-6;
  /// How far obstacles are looked for to report Result::clearance: beyond this it is reported as
  /// this, or as `clearance` where that is more. Far ones take time among points that change with
  /// each solve; whether an answer holds does not depend on it. In [0, inf] [m].
  double report_clearance = std::numeric_limits<double>::infinity();

  /// Whether an obstacle in a hull that no joint moves, about which no answer can do anything,
  /// makes a solve fail. Off for clouds that show the table the robot stands on; clearance is then
  /// that of the other hulls.
  bool base_collision = true;
  /// Whether a link's own pieces decide where its capsules touch something, so that `success` is
  /// true of the link to their tolerance (see Occupancy::pieces); else capsules decide.
  bool exact_contact = true;
  /// Whether a robot that has no hulls may be among obstacles, and carry something: but for what it
  /// carries nothing of it then keeps off anything. Off: such a robot is refused among obstacles,
  /// and steps of a Tracker hold the last answer.
  bool ignore_obstacles_without_hulls = false;
  TouchOptions touch = {};  ///< what may be touched at the target, and by which links
  /// @}
  /// @name Balance and self-collision
  /// @{

  BalanceOptions balance = {};  ///< where the centre of mass has to be
  /// Keep hulls of links that are not adjacent off one another, but for Robot::ignored_pairs;
  /// std::nullopt for where that says something of the links: there are such pairs (a shipped
  /// robot, one with an SRDF) and the hulls are close (there are capsules). Not with Method::Paper.
  /// See `keeps_off_itself`.
  std::optional<bool> self_collision = std::nullopt;
  /// By at least this much, but for pairs of which a ContactRule says otherwise, in [-1e6, 1e6]
  /// [m].
  double self_clearance = 0.0;
  /// @}

  /// @name Which solution
  /// @{

  /// Prefer::First ends with the first solution found; Prefer::Nearest spends the budget on finding
  /// one near the posture, or the start if none is given.
  Prefer prefer = Prefer::First;
  /// Weight of the squared distance to the posture, where one is given, against goals and
  /// constraints, which are met first, in (0, inf) [m^2/rad^2].
  double posture_weight = 1e-3;
  /// What each joint's distance to the posture counts relative to the others', shape (n,), not
  /// negative; empty for all alike. Also what "nearest" means.
  Eigen::VectorXd joint_weights = {};
  /// @}

  /// @name Budget
  /// @{

  /// Deadline of a solve, which taking in obstacles is not part of; may be infinite. What the last
  /// verdicts took, but no more than half, is kept for the verdict at the end. In (0, inf] [s].
  double max_time = 0.01;
  int max_restarts = 1000;  ///< starts after the first; Method::Paper has none, in [0, inf)
  std::uint64_t seed = 0;   ///< of the restarts' sequence
  /// @}

  /// @name Inside the method
  /// @{

  /// How Method::Default minimises from one start.
  InnerMethod inner = InnerMethod::LevenbergMarquardt;
  /// Obstacle points that fit without a further allocation, in [0, 1e7].
  int max_obstacles = 1024;

  /// Metres that one radian weighs in Levenberg-Marquardt's residual; 0 for by the robot's size:
  /// 0.3 m where its farthest tip reaches 0.2 m to 3 m, a quarter of the reach of larger and
  /// smaller ones. In [0, inf) [m].
  double rotation_weight = 0.0;
  /// Weight of a metre of penetration in Levenberg-Marquardt's residual, in (0, inf).
  double collision_weight = 0.5;
  /// Starts for the slack variables keep this fraction of a range off the limits, in (0, 0.5).
  double start_inset = 0.01;
  /// k_p = q_p, where the goal's points sit on the tip's axes (Eq. vwep); 0 for by the robot's
  /// size: 0.5 m where `rotation_weight` is 0.3 m, and in proportion. In [0, inf) [m].
  double point_distance = 0.0;

  /// The limited-memory BFGS minimiser.
  LbfgsOptions lbfgs{.first_step = 5.0, .max_step = 4.0, .curvature = 0.5};
  AugmentedLagrangianOptions augmented_lagrangian = {};  ///< Algorithm IK's outer loop
  /// The least-squares minimiser.
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
