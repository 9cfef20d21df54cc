#include "detail/restarts.hpp"

#include <algorithm>

namespace pdoik::detail {
namespace {

/// Steps of all lanes between looks at the clock, each of which takes a tenth of a step.
constexpr unsigned kBetweenLooks = 4;

}  // namespace

Restarts::Restarts(Workspace& workspace)
    : workspace_(workspace),
      model_(workspace.model()),
      in_lanes_(model_.options.inner == InnerMethod::LevenbergMarquardt &&
                !model_.options.balance.wanted()),
      lanes_(in_lanes_ ? static_cast<std::size_t>(workspace.lanes.width()) : 0),
      verdicts_(workspace) {
  const std::size_t count = std::max<std::size_t>(lanes_.size(), 1);
  attempts_.reserve(count);
  for (std::size_t k = 0; k < count; ++k) attempts_.emplace_back(model_, 2 * count);
  q_.setZero(model_.robot.dof());
}

void Restarts::run(Requests& requests) {
  Request request;
  Result* result = nullptr;
  bool more = requests.next(request, result);
  std::chrono::steady_clock::time_point now;
  for (unsigned turn = 0;; ++turn) {
    const auto in_lanes = [](const Attempt& attempt) {
      return attempt.in_use() && !attempt.in_turn;
    };
    bool busy = std::any_of(attempts_.begin(), attempts_.end(), in_lanes);  // of the lanes
    for (Attempt& attempt : attempts_) {
      if (!more || attempt.in_use()) continue;
      const bool by_lanes = in_lanes_ && is_for_lanes(request);
      const std::span<const Goal> first = request.alternative(0);
      if (by_lanes && !workspace_.lanes.is_kind_of(first)) {
        if (busy) break;
        workspace_.lanes.set_kind(first);
      }
      begin(attempt, request, *result);
      requests.prepare(attempt);
      attempt.in_turn = !by_lanes;
      busy |= by_lanes;
      more = requests.next(request, result);
    }
    bool waits = false;
    for (Attempt& attempt : attempts_) {
      if (attempt.in_use() && attempt.in_turn) {
        if (attempt.is_exhausted())
          finish(attempt);
        else
          search_in_turn(attempt);
      }
      waits |= attempt.in_use();
    }
    if (!busy) {
      if (!waits && !more) return;
      continue;
    }
    search_in_lanes();
    if (turn % kBetweenLooks == 0) now = std::chrono::steady_clock::now();
    for (Attempt& attempt : attempts_) {
      if (!attempt.in_use()) continue;
      if (attempt.deadline.passed_at(now))
        finish(attempt);
      else
        advance(attempt);
    }
  }
}

bool Restarts::is_for_lanes(const Request& request) const {
  const std::span<const Goal> first = request.alternative(0);
  return workspace_.lanes.knows(first) &&
         std::ranges::all_of(request.any_of, [&](const std::vector<Goal>& goals) {
           return LaneSearch::are_alike(goals, first);
         });
}

void Restarts::begin(Attempt& attempt, const Request& request, Result& result) {
  attempt.begin(request, result, workspace_.deadline_in(workspace_.max_time()),
                workspace_.scene().base_collides());
  verdicts_.forget(attempt);
}

void Restarts::search_in_lanes() {
  fill_lanes();
  unsigned ended = workspace_.lanes.tick();
  for (; ended != 0; ended &= ended - 1) {
    Lane& lane = lanes_[static_cast<std::size_t>(__builtin_ctz(ended))];
    Trial& trial = lane.attempt->trial(lane.start);
    const LaneSearch::End end = workspace_.lanes.end(__builtin_ctz(ended), trial.q);
    trial.is_known = true;
    trial.reached = end.reached;
    trial.value = end.value;
    trial.iterations = end.iterations;
    trial.evaluations = end.evaluations;
    --lane.attempt->lanes;
    lane.attempt = nullptr;
  }
}

void Restarts::fill_lanes() {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    Lane& lane = lanes_[k];
    if (lane.attempt != nullptr) continue;
    Attempt* const attempt = who_has_fewest_lanes();
    if (attempt == nullptr) return;
    lane = {attempt, attempt->take_start()};
    ++attempt->lanes;
    const Trial& trial = attempt->trial(lane.start);
    attempt->start_at(trial, q_);
    const LevenbergMarquardtOptions& options =
        (attempt->stays_near(trial) ? workspace_.patient : workspace_.brisk).options();
    workspace_.lanes.start(static_cast<int>(k), attempt->goals(trial.alternative), q_,
                           attempt->lower, attempt->upper,
                           {options.stall_ratio, options.stall_window}, trial.round % 2 == 1);
  }
}

Attempt* Restarts::who_has_fewest_lanes() {
  Attempt* fewest = nullptr;
  for (Attempt& attempt : attempts_) {
    if (!attempt.may_start_another()) continue;
    if (fewest == nullptr || attempt.lanes < fewest->lanes) fewest = &attempt;
  }
  return fewest;
}

void Restarts::search_in_turn(Attempt& attempt) {
  Trial& trial = attempt.trial(attempt.take_start());
  attempt.start_at(trial, trial.q);
  verdicts_.work_for(attempt, trial.alternative);
  trial.iterations = trial.evaluations = 0;
  Result& result = *attempt.result;
  const int iterations = result.iterations, evaluations = result.evaluations;
  if (model_.options.inner == InnerMethod::Lbfgs && !attempt.for_goals_alone) {
    workspace_.map.inverse(trial.q, workspace_.omega, model_.options.start_inset);
    workspace_.minimise_lagrangian(result);
    workspace_.map.positions(workspace_.omega, trial.q);
    trial.reached = !attempt.deadline.struck();  // perhaps: the judge will say
    trial.value = 0.0;
  } else {
    workspace_.least_squares.count_no_obstacles();
    trial.value =
        workspace_.minimise(attempt.stays_near(trial) ? workspace_.patient : workspace_.brisk,
                            trial.q, attempt.lower, attempt.upper, result);
    trial.reached = workspace_.least_squares.done();
  }
  std::swap(trial.iterations, result.iterations);
  std::swap(trial.evaluations, result.evaluations);
  trial.iterations -= iterations;
  trial.evaluations -= evaluations;
  result.iterations = iterations;
  result.evaluations = evaluations;
  trial.is_known = true;
  advance(attempt);
}

void Restarts::advance(Attempt& attempt) {
  if (attempt.is_exhausted()) return finish(attempt);  // there was nothing to start from
  while (attempt.next_verdict < attempt.next_start &&
         attempt.trial(attempt.next_verdict).is_known) {
    const int k = attempt.next_verdict++;
    if (verdicts_.take(attempt, k) || attempt.is_exhausted() || attempt.deadline.passed()) {
      finish(attempt);
      return;
    }
  }
}

void Restarts::finish(Attempt& attempt) {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    if (lanes_[k].attempt != &attempt) continue;
    if (!attempt.found && !attempt.result->holds &&
        !attempt.is_blocked()) {  // what runs still may be the best there is
      const LaneSearch::End end = workspace_.lanes.end(static_cast<int>(k), q_);
      attempt.result->iterations += end.iterations;
      attempt.result->evaluations += end.evaluations;
      model_.wrap(attempt.start, q_);
      attempt.candidates.add(q_, attempt.trial(lanes_[k].start).alternative, end.value,
                             attempt.for_goals_alone);
    }
    workspace_.lanes.stop(static_cast<int>(k));
    lanes_[k].attempt = nullptr;
  }
  verdicts_.finish(attempt);
  attempt.result = nullptr;
}

}  // namespace pdoik::detail
