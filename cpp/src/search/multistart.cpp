#include "search/multistart.hpp"

#include <algorithm>
#include <utility>

namespace pdoik::detail {
namespace {

/// Steps of all lanes between looks at the clock, each of which takes a tenth of a step.
constexpr unsigned kBetweenLooks = 4;

}  // namespace

// The method, on this page: searches for the goals alone, from one start after the other; ...
void Multistart::run(Requests& requests) {
  Next next;
  next.exists = requests.next(next.request, next.result);
  std::chrono::steady_clock::time_point now;
  for (unsigned turn = 0;; ++turn) {
    begin_solves(requests, next);
    for (SolveState& solve : solves_) {
      if (solve.in_turn()) search_in_turn(solve);
    }
    if (std::ranges::none_of(solves_, &SolveState::in_lanes)) {
      if (!next.exists && std::ranges::none_of(solves_, &SolveState::in_use)) return;
      continue;
    }
    lanes_.step(solves_);
    if (turn % kBetweenLooks == 0) now = std::chrono::steady_clock::now();
    for (SolveState& solve : solves_) {
      if (!solve.in_use()) continue;
      if (solve.deadline().passed_at(now))
        finish(solve);
      else
        conclude_ended(solve);
    }
  }
}

// ... and what each comes to is an answer, is brought clear, or is one of those to return if there
// is no answer.
bool Multistart::conclude(SolveState& solve, Trial& trial) {
  acceptance_.work_for(solve, trial.alternative);
  if (!solve.count(trial)) return solve.has_given_up();
  if (solve.wanted().compromises && !trial.reached) acceptance_.keep_position(solve, trial);
  acceptance_.unwind(solve, trial);
  if (solve.collects() && trial.reached) solve.note_end(trial);

  if (trial.reached && acceptance_.is_clear(solve, trial) && acceptance_.holds(solve, trial))
    return acceptance_.accept(solve, trial.alternative);

  if (!solve.has_found()) acceptance_.keep_candidate(solve, trial);
  if (solve.collects()) return solve.has_collected();
  if (!trial.reached) return false;
  if (const auto contact = acceptance_.tool_contact(solve, trial))
    return solve.block(trial, *contact);
  if (acceptance_.all_end_alike(solve, trial)) {
    solve.block();
    return true;
  }
  return solve.wanted().goals_alone;  // nothing better can be found
}

Multistart::Multistart(Workspace& workspace)
    : workspace_(workspace), lanes_(workspace), acceptance_(workspace) {
  solves_.reserve(lanes_.count());
  for (std::size_t k = 0; k < lanes_.count(); ++k)
    solves_.emplace_back(workspace.model(), 2 * lanes_.count());
}

void Multistart::begin_solves(Requests& requests, Next& next) {
  bool busy = std::ranges::any_of(solves_, &SolveState::in_lanes);
  for (SolveState& solve : solves_) {
    if (!next.exists || solve.in_use()) continue;
    const bool by_lanes = lanes_.knows(next.request);
    if (by_lanes && !lanes_.take_kind(next.request, busy)) return;
    solve.begin(next.request, *next.result, workspace_.deadline_in(workspace_.max_time()),
                workspace_.scene().base_collides(), !by_lanes);
    acceptance_.forget(solve);
    requests.prepare(solve);
    busy |= by_lanes;
    next.exists = requests.next(next.request, next.result);
  }
}

void Multistart::search_in_turn(SolveState& solve) {
  if (solve.is_exhausted()) return finish(solve);
  Trial& trial = solve.take_start();
  solve.start_at(trial, trial.q);
  acceptance_.work_for(solve, trial.alternative);
  Result& result = solve.result();
  const int iterations = result.iterations, evaluations = result.evaluations;
  if (workspace_.model().options.inner == InnerMethod::Lbfgs && !solve.wanted().goals_alone) {
    workspace_.map.inverse(trial.q, workspace_.omega, workspace_.model().options.start_inset);
    workspace_.minimise_lagrangian(result);
    workspace_.map.positions(workspace_.omega, trial.q);
    trial.reached = !solve.deadline().struck();  // perhaps: the judge will say
    trial.value = 0.0;
  } else {
    workspace_.least_squares.count_no_obstacles();
    trial.value =
        workspace_.minimise(solve.stays_near(trial) ? workspace_.patient : workspace_.brisk,
                            trial.q, solve.lower(), solve.upper(), result);
    trial.reached = workspace_.least_squares.done();
  }
  // They count when the trial does.
  trial.iterations = std::exchange(result.iterations, iterations) - iterations;
  trial.evaluations = std::exchange(result.evaluations, evaluations) - evaluations;
  trial.is_known = true;
  conclude_ended(solve);
}

void Multistart::conclude_ended(SolveState& solve) {
  if (solve.is_exhausted()) return finish(solve);  // there was nothing to start from
  while (Trial* const trial = solve.next_ended()) {
    if (conclude(solve, *trial) || solve.is_exhausted() || solve.deadline().passed())
      return finish(solve);
  }
}

void Multistart::finish(SolveState& solve) {
  lanes_.stop(solve);
  acceptance_.finish(solve);
  solve.end();
}

}  // namespace pdoik::detail
