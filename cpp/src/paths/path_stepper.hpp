#pragma once

#include <Eigen/Core>
#include <vector>

#include "paths/path_goals.hpp"
#include "paths/sweep.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// A configuration that meets a path at a place, and is clear.
struct PathPoint {
  double at = 0.0;
  Eigen::VectorXd q;
  Sweep::Room room;
};

/// Leads configurations along a path: from one place to another nearby, or between two that are
/// known, until what is between is as exact and clear as they are.
class PathStepper {
 public:
  /// All of these outlive it. Bounds are those of the joints on this path.
  PathStepper(Workspace& workspace, PathGoals& goals, const PathOptions& options,
              const Deadline& deadline, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

  /// Whether a configuration meets the path at a place and is clear, as it is; then `point` is it.
  bool stands(double at, const Eigen::VectorXd& q, PathPoint& point);
  /// Bring a configuration to a place of the path, going no farther from it than a step, and clear
  /// of everything. @returns Whether it is there; `fault` says why not.
  bool bring(double at, const Eigen::VectorXd& from, double step, PathPoint& point);
  /// Whether joints get from one point to a later one along the path. What is between is added to
  /// `points`, as close as the path's tolerances ask, and the later one.
  bool bridge(const PathPoint& one, const PathPoint& other, std::vector<PathPoint>& points);

  /// Why the last of these failed, and where.
  const Result& fault() const { return fault_; }
  double fault_at() const { return fault_at_; }
  Sweep& sweep() { return sweep_; }
  PathGoals& goals() { return goals_; }
  Workspace& workspace() { return workspace_; }
  const Deadline& deadline() const { return deadline_; }
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }

 private:
  /// Whether the tool is on the path all along a straight way.
  bool is_on_path(const PathPoint& one, const PathPoint& other);
  bool bridge(const PathPoint& one, const PathPoint& other, std::vector<PathPoint>& points,
              int depth);
  void add_straight(const PathPoint& one, const PathPoint& other, std::vector<PathPoint>& points);
  bool fail(double at, const Result& why);

  Workspace& workspace_;
  PathGoals& goals_;
  const PathOptions& options_;
  const Deadline& deadline_;
  const Eigen::VectorXd &lower_, &upper_;
  Sweep sweep_;
  Result verdict_, fault_;
  double fault_at_ = 0.0;
  Eigen::VectorXd at_, low_, high_;
};

}  // namespace pdoik::detail
