#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>

namespace pdoik {

enum class Status {
  Solved,         ///< pose, limits and clearance hold to their tolerances
  TimeLimit,      ///< max_time struck first; q is the best found
  Exhausted,      ///< every start ended in a local minimum; q is the best found
  OutOfReach,     ///< the target lies farther from the arm's root than its links stretch; q is the
                  ///< nearest found
  BaseCollision,  ///< an obstacle point lies in a hull that no joint moves; q is the best found
                  ///< otherwise
};

/// A status in lower case with underscores, as the Python module gives it.
const char* to_string(Status status);

/// What keeps a configuration from being a solution by most, or comes nearest to that.
struct WorstConstraint {
  enum class Kind { None, Position, Rotation, Limit, Clearance };
  Kind kind = Kind::None;
  int index = -1;  ///< the joint for Limit, the hull (spheres first, then spheroids) for Clearance
  int obstacle = -1;  ///< the obstacle's row for Clearance
  double violation =
      0.0;  ///< by how much it is missed beyond its tolerance [m] or [rad]; at most 0 if it holds
};

/// The outcome of a solve, with what is needed to judge it without trusting the solver: every error
/// is recomputed from q alone.
struct Result {
  Eigen::VectorXd q;  ///< [rad] or [m]
  bool success = false;
  Status status = Status::Exhausted;
  double position_error = std::numeric_limits<double>::infinity();  ///< [m]
  double rotation_error = std::numeric_limits<double>::infinity();  ///< [rad]; 0 for position goals
  double clearance = std::numeric_limits<double>::infinity();  ///< [m]; infinite without obstacles
  double limit_violation = 0.0;  ///< [rad] or [m], largest over joints
  WorstConstraint worst;
  int iterations = 0;   ///< of the inner minimisers
  int evaluations = 0;  ///< rollouts
  int restarts = 0;     ///< starts beyond the first
  double time = 0.0;    ///< [s]
};

}  // namespace pdoik
