#pragma once

#include "paths/path_layers.hpp"

namespace pdoik::detail {

/// Whole paths: see Solver::solve_path.
class PathSearch {
 public:
  /// All of these outlive it; the obstacles are being read. Bounds are joint limits and locks.
  PathSearch(Workspace& workspace, Multistart& multistart, const PathRequest& request,
             const PathOptions& options, const Eigen::VectorXd& lower,
             const Eigen::VectorXd& upper);

  PathResult run();

 private:
  using Points = std::vector<PathPoint>;
  /// What is known of a motion that does not get through.
  void note_end(double reached, const Eigen::VectorXd& q);
  /// Get from one place to the next, and note whether it can be; what is between and the next are
  /// added to points. @returns Whether joints are there.
  bool go(const PathLayers::Place& one, const PathLayers::Place& other, Points& points);
  /// Follow a motion from a point as far as it gets, but no farther than a station.
  void follow_to_end(PathPoint at, int last);
  /// Try a route. @returns Whether joints get along all of it; then `points` are those.
  bool follow(const PathLayers::Route& route, Points& points);
  /// The same of points that may be off the layers' nodes.
  bool join(const Points& route, Points& points);
  /// A whole path, made shorter.
  bool find_whole(Points& points);
  void shorten(const PathLayers::Route& route, Points& points);
  /// As few pieces as the layers have. @returns Whether that is known: there are any, and time.
  bool find_pieces(std::vector<Points>& pieces);
  void explain(PathResult& result);
  /// Whether a station has one of its own; else what comes nearest.
  bool has_solution(int station, Result& best);
  /// Whether no motion at all can meet the path, as its ends tell.
  bool is_impossible(const PathResult& result);
  /// Whether its pieces meet every station.
  bool covers_all(const PathResult& result) const;
  void take(const std::vector<Points>& pieces, PathResult& result);
  /// Clear moves from each piece to the next.
  void find_moves(const std::vector<Points>& pieces, PathResult& result);

  const Deadline deadline_;
  const PathRequest& request_;
  const PathOptions& options_;
  Workspace& workspace_;
  const Eigen::VectorXd &lower_, &upper_;
  PathGoals goals_;
  PathStepper stepper_;
  PathCost cost_;
  PathLayers layers_;
  std::vector<PathEnd> ends_;
  bool is_late_ = false;  ///< whether the search for one motion had no more time
};

}  // namespace pdoik::detail
