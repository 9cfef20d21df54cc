#pragma once

#include <Eigen/Core>
#include <limits>
#include <span>
#include <vector>

#include "pdoik/goal.hpp"
#include "pdoik/request.hpp"
#include "pdoik/result.hpp"

namespace pdoik {

/// What makes one whole path better than another: weights of what is added up along it.
struct PathCosts {
  double motion = 1.0;     ///< of how far the joints go [1/rad] or [1/m]
  double limits = 0.0;     ///< of nearness to limits: 1 at a limit, 0 in the middle of the range
  double obstacles = 0.0;  ///< of nearness to contact: 1 touching, 0 from `room` on
  double singularities = 0.0;  ///< of nearness to a singularity: 1 there, 0 from `room` on
  double room = 0.1;           ///< what counts as far from contact and from a singularity [m]
};

/// How a path is searched for, and what it has to keep between its stations.
struct PathOptions {
  double max_time = 10.0;  ///< for all of it [s]
  /// How far the tool may be off between stations, where it is to be on the straight way from one
  /// to the next, turning evenly [m]. At stations the goals' own tolerances hold.
  double position_tolerance = 1e-4;
  double rotation_tolerance = 1e-3;  ///< the same of how it is turned [rad]
  double max_joint_step = 0.12;  ///< largest from one row of the answer to the next [rad] or [m]
  PathCosts costs = {};          ///< what is least of all whole paths that are found
  /// Whether what cannot be one motion may be several, with moves between them where joints go
  /// elsewhere while the tool leaves the path.
  bool reconfigure = true;
};

/// A path: stations one after the other, and what is known of its ends.
struct PathRequest {
  /// Goals of each station. All ask the same kind of thing of the same tips, so that there is a way
  /// between them. None is soft.
  std::span<const std::vector<Goal>> stations = {};
  const Eigen::VectorXd* start = nullptr;  ///< where joints are at the first station, shape (n,)
  const Eigen::VectorXd* end = nullptr;    ///< where they are to be at the last, shape (n,)
  /// Whether the path goes on from the last station to the first, and ends where it began.
  bool closed = false;
  std::span<const Lock> locks = {};  ///< joints that keep a position
};

/// What became of a path.
enum class PathStatus {
  Whole,       ///< one motion meets all of it
  Pieces,      ///< several do, with a move between one and the next
  Impossible,  ///< no motion meets it: all solutions of its stations are known, and none goes on
  NotFound,    ///< no motion was found that meets it
  TimeLimit,   ///< max_time struck first
};

/// A status in lower case with underscores, as the Python module gives it.
const char* to_string(PathStatus status);

/// Some rows of the answer that are one motion.
struct PathPiece {
  int first = 0;      ///< its first row
  int last = 0;       ///< its last
  double from = 0.0;  ///< where on the path it begins, see PathResult::at
  double to = 0.0;    ///< where it ends
  /// The first row of `PathResult::moves` of those that lead from this piece's end to where the
  /// next begins; there are none of the last piece, and where no move was found.
  int first_move = 0;
  int last_move = -1;  ///< the last of these; before the first, where there are none
};

/// Where a motion that was tried ends, and against what.
struct PathEnd {
  double at = 0.0;    ///< where on the path
  Eigen::VectorXd q;  ///< the last configuration on it, shape (n,)
  Result beyond;      ///< what a step further comes to: its worst constraint says why
};

/// The outcome of a path. What is in it was judged: at stations as a solve's result, and between
/// two rows, which are joined by straight lines of joint positions, for the way of the tool and for
/// contact, by intervals.
struct PathResult {
  PathStatus status = PathStatus::NotFound;  ///< what became of it
  /// Configurations one after the other, shape (m, n) [rad] or [m]. Of several pieces all of them.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> q;
  Eigen::VectorXd at;  ///< where on the path a row is: 2.5 is half way from station 2 to station 3
  std::vector<PathPiece> pieces;  ///< one, if it is whole
  /// Moves between pieces, shape (k, n).
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> moves;
  /// Where it breaks: what ends motions at the place that fewest get beyond.
  std::vector<PathEnd> ends;
  std::vector<int> unsolved;  ///< stations for which no solution was found
  bool complete = false;  ///< whether all solutions of all stations that were looked at are known
  double length = 0.0;    ///< of all pieces: the sum of |dq| from row to row [rad] or [m]
  /// Least of all rows; beyond 0.6 m it is reported as that much [m].
  double clearance = std::numeric_limits<double>::infinity();
  double self_distance = std::numeric_limits<double>::infinity();  ///< the same [m]
  double largest_step = 0.0;    ///< of a joint from one station to the next, in pieces
  double position_error = 0.0;  ///< largest at stations [m]
  double rotation_error = 0.0;  ///< [rad]
  double time = 0.0;            ///< [s]
};

/// How a move is searched for.
struct MotionOptions {
  double max_time = 1.0;  ///< [s]
  int goal_count = 16;    ///< so many configurations that meet goals are led to, at most
  bool shorten = true;    ///< whether detours are taken out
};

/// A move from a configuration to goals, clear of everything.
struct MotionRequest {
  const Eigen::VectorXd* from = nullptr;           ///< shape (n,)
  const Eigen::VectorXd* to = nullptr;             ///< one configuration to end at, or
  std::span<const std::vector<Goal>> any_of = {};  ///< lists of goals of which any one will do
  std::span<const Lock> locks = {};                ///< joints that keep a position
};

/// What became of a move.
enum class MotionStatus {
  Solved,        ///< it is clear, all along
  BlockedStart,  ///< it would begin in something, or outside limits
  BlockedGoal,   ///< no configuration that meets a goal is clear and inside limits
  TimeLimit,     ///< max_time struck first: none was found
};

/// A status in lower case with underscores, as the Python module gives it.
const char* to_string(MotionStatus status);

/// The outcome of a move.
struct MotionResult {
  MotionStatus status = MotionStatus::TimeLimit;  ///< what became of it
  /// Corners of the way, joined by straight lines of joint positions, shape (m, n).
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> q;
  int goal_index = -1;  ///< which of any_of it ends at
  double length = 0.0;  ///< the sum of |dq| [rad] or [m]
  Result at_fault;      ///< where it is blocked: the verdict that says by what
  int checks = 0;       ///< looks at a configuration
  double time = 0.0;    ///< [s]
};

}  // namespace pdoik
