#pragma once

#include <span>

#include "detail/workspace.hpp"

namespace pdoik::detail {

/// What one step of a control loop is asked.
struct StepRequest {
  std::span<const Goal> goals;
  const Eigen::VectorXd *from, *lower, *upper;  ///< the last answer, and bounds about it
  const Eigen::VectorXd *pull_to, *pull;        ///< see PosturePull; may be null
  double max_time;                              ///< [s]
  /// Obstacles farther than this from the hulls cannot be met within a step; may be infinite [m].
  double margin;
  double advance, turn;  ///< how far a tip may be asked to go in one step [m], [rad]
  double look;           ///< clearance beyond this is told as this [m]
};

/// The step from the last answer that comes nearest to goals and constraints, downhill.
class Step {
 public:
  /// The workspace outlives it.
  explicit Step(Workspace& workspace);

  /// result.status is Solved, TimeLimit or Exhausted. Allocates nothing if result.q has its size.
  void take(const StepRequest& request, Result& result);

 private:
  /// The configuration within bounds that comes nearest, into q_; obstacles farther than a margin
  /// cannot be met [m].
  void approach(const StepRequest& request, double margin, Result& result);
  double minimise(LevenbergMarquardt& minimiser, Result& result) {
    return workspace_.minimise(minimiser, q_, lower_, upper_, result);
  }
  /// Whether hulls stay clear of obstacles and each other on the straight way to q_.
  bool is_clear_on_the_way(const StepRequest& request);
  /// How far hulls may move before one meets an obstacle or another; negative if they do [m].
  double room(const Result& verdict) const;
  /// A bound on how far any part of a hull gets on that way [m].
  double way_from(const Eigen::VectorXd& from);

  Workspace& workspace_;
  const Model& model_;
  const Deadline* deadline_ = nullptr;
  Result probe_;  ///< on the way
  Eigen::VectorXd q_, lower_, upper_, at_, levers_, held_levers_;
};

}  // namespace pdoik::detail
