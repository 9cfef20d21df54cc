#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

#include "pdoik/abi.hpp"

namespace pdoik {

/// Why a solve ended.
enum class Status {
  Solved,         ///< pose, limits and clearance hold to their tolerances
  TimeLimit,      ///< max_time struck first; q is the best found
  Exhausted,      ///< every start ended in a local minimum; q is the best found
  OutOfReach,     ///< the target lies farther from the arm's root than its links stretch, or no
                  ///< joint moves its tip; q is the nearest of a few starts
  BaseCollision,  ///< an obstacle point lies in a hull that no joint moves: no answer exists; q is
                  ///< the best found for the goal alone, and the worst constraint says which
                  ///< obstacle is in which of these hulls
  Blocked,  ///< what is rigid to the tip is in an obstacle at the target, so no answer exists; or
            ///< some fifty starts that reached it all ended with the same hull in the same
            ///< obstacle, so that none is likely. q is the best found, and the worst constraint
            ///< says what touches what
  Nearest,  ///< position and all constraints hold; of a goal whose position comes first orientation
            ///< cannot, and rotation_error is the least that was found
};

/// A status in lower case with underscores, as the Python module gives it.
const char* to_string(Status status);

/// What keeps a configuration from being a solution by most, or comes nearest to that.
struct WorstConstraint {
  /// Which kind of constraint.
  enum class Kind {
    None,                  ///< nothing was asked
    Position,              ///< of a tip
    Rotation,              ///< of a tip
    Limit,                 ///< of a joint
    Clearance,             ///< of a hull to a point
    Balance,               ///< of the centre of mass
    SelfCollision,         ///< of two hulls
    Shape,                 ///< of a hull to a shape
    AttachmentPoint,       ///< of what is attached to a point
    AttachmentShape,       ///< of what is attached to a shape
    AttachmentHull,        ///< of what is attached to a hull
    AttachmentAttachment,  ///< of what is attached to what is attached to another link
    HeldPoint [[deprecated("AttachmentPoint")]] = AttachmentPoint,           ///< old name
    HeldShape [[deprecated("AttachmentShape")]] = AttachmentShape,           ///< old name
    HeldHull [[deprecated("AttachmentHull")]] = AttachmentHull,              ///< old name
    HeldHeld [[deprecated("AttachmentAttachment")]] = AttachmentAttachment,  ///< old name
  };
  Kind kind = Kind::None;  ///< which kind of constraint
  /// The tip for Position and Rotation, the joint for Limit, the hull (spheres first, then
  /// spheroids, then capsules) for Clearance, Shape and SelfCollision; for Balance 0 to 5 the box's
  /// lower and upper x, y, z, then 6 the support polygon. For those of what is attached its place,
  /// in the order that it was attached.
  int index = -1;
  /// The point's row for Clearance and AttachmentPoint, the shape's place for Shape and
  /// AttachmentShape, the other hull for SelfCollision and AttachmentHull, the place of the other
  /// that is attached for AttachmentAttachment.
  int obstacle = -1;
  double violation =
      0.0;  ///< by how much it is missed beyond its tolerance [m] or [rad]; at most 0 if it holds
};

/// How near the robot, and what is attached to it, is to one obstacle.
struct ObstacleClearance {
  int shape = -1;         ///< its place among the shapes; -1 for the points
  double distance = 0.0;  ///< negative by how deep it is [m]; infinite if nothing is to keep off it
  int hull = -1;          ///< the nearest hull's place in the occupancy, or
  int held = -1;          ///< that of the nearest of what is attached
  int point = -1;         ///< the nearest point's row
};

/// The outcome of a solve, with what is needed to judge it without trusting the solver: every error
/// is recomputed from q alone.
struct Result {
  Eigen::VectorXd q;     ///< [rad] or [m]
  bool success = false;  ///< goals, limits and constraints hold to their tolerances
  /// The same, but for the orientation of goals whose position comes first (Priority::Position).
  bool holds = false;
  Status status = Status::Exhausted;  ///< why the solve ended
  int goal_index = 0;                 ///< which of Request::any_of it meets, or comes nearest to
  double position_error = std::numeric_limits<double>::infinity();  ///< largest over goals [m]
  double rotation_error =
      std::numeric_limits<double>::infinity();  ///< largest over goals [rad]; 0 for position goals
  /// Least distance of obstacles, but for those whose contact does not count [m]; infinite without
  /// any, at most Options::report_clearance else.
  double clearance = std::numeric_limits<double>::infinity();
  double limit_violation = 0.0;  ///< [rad] or [m], largest over joints
  /// In the base frame, where balance is asked for [m].
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();
  double balance_violation = 0.0;  ///< how far it is outside its region, 0 inside [m]
  /// Least distance between hulls of links that are not adjacent, where that is asked for: between
  /// the capsules that hold them, which is never more [m].
  double self_distance = std::numeric_limits<double>::infinity();
  /// Least of what distances of obstacles are beyond what is wanted of each pair, negative where
  /// one is nearer: without rules of contact clearance less Options::clearance [m].
  double room = std::numeric_limits<double>::infinity();
  /// The same of what self_distance is of [m].
  double self_room = std::numeric_limits<double>::infinity();
  WorstConstraint worst;  ///< what is missed by most, or comes nearest to that
  int iterations = 0;     ///< of the inner minimisers
  int evaluations = 0;    ///< rollouts
  int restarts = 0;       ///< starts beyond the first
  double time = 0.0;      ///< [s]
  /// What taking the obstacles in took, the last time that they changed: it is in no budget and not
  /// in `time` [s].
  double intake = 0.0;
  /// Evaluations and looks at all obstacles that were begun after max_time had struck: the verdict
  /// takes one.
  int late_evaluations = 0;
};

}  // namespace pdoik
