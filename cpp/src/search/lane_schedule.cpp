#include "search/lane_schedule.hpp"

#include <algorithm>

namespace pdoik::detail {
namespace {

bool has_lanes(const Options& options) {
  return options.inner == InnerMethod::LevenbergMarquardt && !options.balance.wanted();
}

}  // namespace

LaneSchedule::LaneSchedule(Workspace& workspace)
    : workspace_(workspace),
      lanes_(has_lanes(workspace.model().options)
                 ? static_cast<std::size_t>(workspace.lanes.width())
                 : 0) {
  q_.setZero(workspace.model().robot.dof());
}

bool LaneSchedule::knows(const Request& request) const {
  const std::span<const Goal> first = request.alternative(0);
  return !lanes_.empty() && workspace_.lanes.knows(first) &&
         std::ranges::all_of(request.any_of, [&](const std::vector<Goal>& goals) {
           return LaneSearch::are_alike(goals, first);
         });
}

bool LaneSchedule::take_kind(const Request& request, bool busy) {
  const std::span<const Goal> first = request.alternative(0);
  if (workspace_.lanes.is_kind_of(first)) return true;
  if (!busy) workspace_.lanes.set_kind(first);
  return !busy;
}

void LaneSchedule::step(std::span<SolveState> solves) {
  fill(solves);
  unsigned ended = workspace_.lanes.tick();
  for (; ended != 0; ended &= ended - 1) {
    Lane& lane = lanes_[static_cast<std::size_t>(__builtin_ctz(ended))];
    Trial& trial = *lane.trial;
    const LaneSearch::End end = workspace_.lanes.end(__builtin_ctz(ended), trial.q);
    trial.is_known = true;
    trial.reached = end.reached;
    trial.value = end.value;
    trial.iterations = end.iterations;
    trial.evaluations = end.evaluations;
    lane = {};
  }
}

void LaneSchedule::fill(std::span<SolveState> solves) {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    if (lanes_[k].solve != nullptr) continue;
    SolveState* const solve = who_has_fewest(solves);
    if (solve == nullptr) return;
    Trial& trial = solve->take_start();
    lanes_[k] = {solve, &trial};
    solve->start_at(trial, q_);
    const LevenbergMarquardtOptions& options =
        (solve->stays_near(trial) ? workspace_.patient : workspace_.brisk).options();
    workspace_.lanes.start(static_cast<int>(k), solve->goals(trial.alternative), q_, solve->lower(),
                           solve->upper(), {options.stall_ratio, options.stall_window},
                           trial.round % 2 == 1);
  }
}

SolveState* LaneSchedule::who_has_fewest(std::span<SolveState> solves) const {
  SolveState* chosen = nullptr;
  std::ptrdiff_t fewest = 0;
  for (SolveState& solve : solves) {
    if (!solve.may_start_another()) continue;
    const std::ptrdiff_t count = std::ranges::count(lanes_, &solve, &Lane::solve);
    if (chosen != nullptr && count >= fewest) continue;
    chosen = &solve;
    fewest = count;
  }
  return chosen;
}

void LaneSchedule::stop(SolveState& solve) {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    if (lanes_[k].solve != &solve) continue;
    if (solve.wants_candidates()) {
      const LaneSearch::End end = workspace_.lanes.end(static_cast<int>(k), q_);
      solve.result().iterations += end.iterations;
      solve.result().evaluations += end.evaluations;
      workspace_.model().wrap(solve.start(), q_);
      solve.add_unjudged(lanes_[k].trial->alternative, q_, end.value);
    }
    workspace_.lanes.stop(static_cast<int>(k));
    lanes_[k] = {};
  }
}

}  // namespace pdoik::detail
