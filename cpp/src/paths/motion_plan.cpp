#include "paths/motion_plan.hpp"

#include <algorithm>

#include "paths/motion_search.hpp"
#include "search/all_solutions.hpp"
#include "search/outcome.hpp"

namespace pdoik::detail {
namespace {

/// What of the time may go into finding configurations that meet goals, and into taking detours out
/// once a move is known.
constexpr double kSolveShare = 0.3, kShortenShare = 0.3;

/// Configurations to end at.
class Ends {
 public:
  Ends(Workspace& workspace, Multistart& multistart, const MotionRequest& request,
       const MotionOptions& options)
      : workspace_(workspace), multistart_(multistart), request_(request), options_(options) {}

  MotionSearch::Way places;
  std::vector<int> alternatives;  ///< whose goals each meets
  Result best;                    ///< where there are none, what comes nearest

  void find(const Deadline& deadline) {
    Request asked;
    asked.any_of = request_.any_of;
    asked.q0 = request_.from;
    asked.locks = request_.locks;
    OneRequest requests(asked, best);
    multistart_.run(requests);  // the likeliest first, and what cannot be had is known soon
    if (!best.holds) return;
    add(best, best.goal_index);
    look_for(best.goal_index);
    for (int k = 0; k < static_cast<int>(request_.any_of.size()) && !is_enough(deadline); ++k) {
      if (k != best.goal_index) look_for(k);
    }
  }

 private:
  bool is_enough(const Deadline& deadline) const {
    return static_cast<int>(places.size()) >= options_.goal_count ||
           deadline.elapsed() > kSolveShare * options_.max_time;
  }
  void add(const Result& result, int alternative) {
    places.push_back(result.q);
    alternatives.push_back(alternative);
  }
  void look_for(int alternative) {
    Request asked;
    asked.goals = request_.any_of[static_cast<std::size_t>(alternative)];
    asked.q0 = request_.from;
    asked.locks = request_.locks;
    const int all = static_cast<int>(request_.any_of.size());
    Result ignored;
    const Solutions found = all_solutions(workspace_, multistart_, asked,
                                          {std::max(1, options_.goal_count / all), 0.0}, ignored);
    for (const Result& each : found.results) add(each, alternative);
  }

  Workspace& workspace_;
  Multistart& multistart_;
  const MotionRequest& request_;
  const MotionOptions& options_;
};

}  // namespace

MotionResult plan_motion(Workspace& workspace, Multistart& multistart, const MotionRequest& request,
                         const MotionOptions& options, const Bounds& bounds) {
  const Deadline deadline(options.max_time, workspace.interrupt);
  Sweep sweep(workspace);
  MotionResult result;
  const auto end = [&](MotionStatus status) {
    result.status = status;
    result.checks = sweep.looks();
    result.time = deadline.elapsed();
    return result;
  };
  const auto is_fine = [&](const Eigen::VectorXd& q) {
    workspace.watch(deadline);
    begin_result(result.at_fault);
    workspace.judge({}, q, result.at_fault, Sweep::kLook);
    return result.at_fault.success;
  };

  const std::span<const Goal> goals =
      request.any_of.empty() ? std::span<const Goal>() : request.any_of.front();
  if (!is_fine(*request.from)) return end(MotionStatus::BlockedStart);
  Ends ends(workspace, multistart, request, options);
  if (request.to != nullptr) {
    if (!is_fine(*request.to)) return end(MotionStatus::BlockedGoal);
    ends.places.push_back(*request.to);
    ends.alternatives.push_back(-1);
  } else {
    ends.find(deadline);
    workspace.watch(deadline);
    if (ends.places.empty()) {
      result.at_fault = ends.best;
      return end(MotionStatus::BlockedGoal);
    }
  }

  MotionSearch search(workspace, sweep, goals, bounds.lower, bounds.upper, deadline);
  int reached = 0;
  auto way = search.find(*request.from, ends.places, reached);
  if (!way) return end(MotionStatus::TimeLimit);
  if (options.shorten)
    search.shorten(*way, std::min(deadline.left(), kShortenShare * options.max_time));
  result.goal_index = ends.alternatives[static_cast<std::size_t>(reached)];
  result.length = length_of(*way);
  result.q.resize(static_cast<Eigen::Index>(way->size()), request.from->size());
  for (std::size_t k = 0; k < way->size(); ++k)
    result.q.row(static_cast<Eigen::Index>(k)) = (*way)[k];
  return end(MotionStatus::Solved);
}

}  // namespace pdoik::detail
