#include "detail/restarts.hpp"

#include <algorithm>
#include <cmath>

#include "detail/outcome.hpp"

namespace pdoik::detail {
namespace {

/// What a solve may spend on bringing answers clear of obstacles, of what it spends on finding
/// answers.
constexpr double kRepairShare = 0.1;
/// What it may spend on finding out by how much those that do not solve fall short.
constexpr double kMeasureShare = 0.02;
/// Obstacles this far from the hulls are left out while answers are brought clear [m].
constexpr double kRepairMargin = 0.1;
/// Looking at this many obstacles costs about as much as evaluating the goal.
constexpr double kObstaclesPerEvaluation = 60.0;
/// Starts where no answer can exist: for the nearest to a target out of reach; for the goal alone
/// where the base is in collision, which ends with the first that reaches it.
constexpr int kStartsOutOfReach = 16, kStartsForGoalAlone = 100;

double squared_distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                        const Eigen::VectorXd& weights) {
  return ((a - b).array().square() * weights.array()).sum();
}

}  // namespace

Restarts::Attempt::Attempt(Eigen::Index dof, std::size_t ahead) : trials(ahead), candidates(dof) {
  for (Eigen::VectorXd* each : {&start, &lower, &upper, &best.q}) each->setZero(dof);
  for (Trial& trial : trials) trial.q.setZero(dof);
}

Restarts::Restarts(Workspace& workspace)
    : workspace_(workspace),
      model_(workspace.model()),
      in_lanes_(model_.options.inner == InnerMethod::LevenbergMarquardt &&
                !model_.options.balance.wanted()),
      lanes_(in_lanes_ ? static_cast<std::size_t>(workspace.lanes.width()) : 0) {
  const std::size_t count = std::max<std::size_t>(lanes_.size(), 1);
  attempts_.reserve(count);
  for (std::size_t k = 0; k < count; ++k) attempts_.emplace_back(model_.robot.dof(), 2 * count);
  q_.setZero(model_.robot.dof());
}

void Restarts::run(Requests& requests) {
  worked_for_ = nullptr;
  Request request;
  Result* result = nullptr;
  bool more = requests.next(request, result);
  const auto in_use = [](const Attempt& attempt) { return attempt.result != nullptr; };
  while (true) {
    bool busy = std::any_of(attempts_.begin(), attempts_.end(), in_use);
    for (Attempt& attempt : attempts_) {
      if (!more || in_use(attempt)) continue;
      if (in_lanes_ && busy && !workspace_.lanes.is_kind_of(request.goals)) break;
      if (in_lanes_ && !busy) workspace_.lanes.set_kind(request.goals);
      begin(attempt, request, *result);
      busy = true;
      more = requests.next(request, result);
    }
    if (!busy) return;
    if (!in_lanes_) {
      search_in_turn(attempts_.front());
      continue;
    }
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
    const auto now = std::chrono::steady_clock::now();
    for (Attempt& attempt : attempts_) {
      if (!in_use(attempt)) continue;
      if (attempt.deadline.passed_at(now))
        finish(attempt);
      else
        advance(attempt);
    }
  }
}

void Restarts::fill_lanes() {
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    Lane& lane = lanes_[k];
    if (lane.attempt != nullptr) continue;
    Attempt* const attempt = who_has_fewest_lanes();
    if (attempt == nullptr) return;
    lane = {attempt, attempt->next_start++};
    ++attempt->lanes;
    attempt->trial(lane.start).is_known = false;
    starting_point(*attempt, lane.start, q_);
    const LevenbergMarquardtOptions& options =
        (attempt->stays_near(lane.start) ? workspace_.patient : workspace_.brisk).options();
    workspace_.lanes.start(static_cast<int>(k), attempt->request.goals, q_, attempt->lower,
                           attempt->upper, {options.stall_ratio, options.stall_window});
  }
}

Restarts::Attempt* Restarts::who_has_fewest_lanes() {
  Attempt* fewest = nullptr;
  for (Attempt& attempt : attempts_) {
    const int ahead = attempt.next_start - attempt.next_verdict;
    if (attempt.result == nullptr || attempt.next_start > attempt.last_start ||
        ahead >= static_cast<int>(attempt.trials.size()))
      continue;
    if (fewest == nullptr || attempt.lanes < fewest->lanes) fewest = &attempt;
  }
  return fewest;
}

void Restarts::advance(Attempt& attempt) {
  while (attempt.next_verdict < attempt.next_start &&
         attempt.trial(attempt.next_verdict).is_known) {
    const int k = attempt.next_verdict++;
    if (take(attempt, k) || attempt.next_verdict > attempt.last_start ||
        attempt.deadline.passed()) {
      finish(attempt);
      return;
    }
  }
}

void Restarts::search_in_turn(Attempt& attempt) {
  const int k = attempt.next_start++;
  Trial& trial = attempt.trial(k);
  starting_point(attempt, k, trial.q);
  work_for(attempt);
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
    trial.value = workspace_.minimise(attempt.stays_near(k) ? workspace_.patient : workspace_.brisk,
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

void Restarts::begin(Attempt& attempt, const Request& request, Result& result) {
  const Options& options = model_.options;
  attempt.request = request;
  attempt.result = &result;
  attempt.deadline = workspace_.deadline_in(options.max_time);
  begin_result(result);
  attempt.for_goals_alone = workspace_.scene().base_collides();
  attempt.hopeless = why_hopeless(model_, request.goals, attempt.for_goals_alone);
  attempt.redundant = model_.is_redundant(request.goals);
  attempt.nearest = options.prefer == Prefer::Nearest;
  attempt.found = false;
  const int enough = attempt.for_goals_alone ? kStartsForGoalAlone
                     : attempt.hopeless      ? kStartsOutOfReach
                                             : options.max_restarts;
  attempt.last_start = std::min(options.max_restarts, enough);
  attempt.next_start = attempt.next_verdict = attempt.lanes = 0;
  attempt.search_cost = attempt.repair_cost = attempt.measure_cost = 0.0;
  attempt.candidates.clear();
  set_start(attempt);
  if (worked_for_ == &attempt) worked_for_ = nullptr;
}

void Restarts::set_start(Attempt& attempt) const {
  const Request& request = attempt.request;
  Eigen::VectorXd &lower = attempt.lower, &upper = attempt.upper, &start = attempt.start;
  lower = model_.robot.lower();
  upper = model_.robot.upper();
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    const bool bounded = std::isfinite(lower[i]) && std::isfinite(upper[i]);
    start[i] = request.q0 != nullptr ? std::clamp((*request.q0)[i], lower[i], upper[i])
               : bounded             ? 0.5 * (lower[i] + upper[i])
                                     : 0.0;
    if (model_.turns[static_cast<std::size_t>(i)] == Model::Turn::Bound) {
      lower[i] = start[i] - M_PI;
      upper[i] = start[i] + M_PI;
    }
    if (request.max_step == nullptr) continue;
    lower[i] = std::max(lower[i], start[i] - (*request.max_step)[i]);
    upper[i] = std::min(upper[i], start[i] + (*request.max_step)[i]);
  }
}

void Restarts::starting_point(const Attempt& attempt, int k, Eigen::VectorXd& q) const {
  if (k == 0)
    q = attempt.start;
  else
    restart_configuration(attempt, k, q);
}

void Restarts::restart_configuration(const Attempt& attempt, int k, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!model_.matters[static_cast<std::size_t>(i)]) {
      q[i] = attempt.start[i];
      continue;
    }
    const bool bounded = std::isfinite(attempt.lower[i]) && std::isfinite(attempt.upper[i]);
    const double low = bounded ? attempt.lower[i] : attempt.start[i] - M_PI,
                 high = bounded ? attempt.upper[i] : attempt.start[i] + M_PI;
    q[i] = low + model_.sequence(k, i) * (high - low);
    if (!attempt.nearest) continue;
    // Close to what is wanted as often as far from it: the whole range, half of it, a quarter, ...
    constexpr double kScales[] = {0.5, 0.25, 0.125, 1.0};
    q[i] =
        std::clamp(attempt.wanted()[i] + kScales[k % 4] * (q[i] - 0.5 * (low + high)), low, high);
  }
}

void Restarts::work_for(Attempt& attempt) {
  if (worked_for_ == &attempt) return;
  worked_for_ = &attempt;
  workspace_.problem.set_goals(attempt.request.goals);
  workspace_.watch(attempt.deadline);
}

bool Restarts::take(Attempt& attempt, int k) {
  work_for(attempt);
  Trial& trial = attempt.trial(k);
  Result& result = *attempt.result;
  result.iterations += trial.iterations;
  result.evaluations += trial.evaluations;
  result.restarts = k;
  attempt.search_cost += trial.evaluations;
  model_.wrap(attempt.start, trial.q);
  if (trial.reached && is_clear(attempt, trial, attempt.stays_near(k))) {
    workspace_.judge(attempt.request.goals, trial.q, result);
    if (result.success) {
      if (attempt.request.posture != nullptr || attempt.nearest) settle(attempt);
      if (!attempt.nearest) return true;
      const double distance = squared_distance(result.q, attempt.wanted(), model_.pull);
      if (!attempt.found || distance < attempt.least) {
        attempt.found = true;
        attempt.least = distance;
        attempt.best = result;
      }
      return false;
    }
  }
  if (!attempt.found) keep_candidate(attempt, trial);
  if (attempt.for_goals_alone && trial.reached) return true;  // nothing better can be found
  return false;
}

bool Restarts::is_clear(Attempt& attempt, Trial& trial, bool stay_near) {
  LeastSquaresProblem& problem = workspace_.least_squares;
  if (attempt.for_goals_alone || model_.options.inner == InnerMethod::Lbfgs)
    return !attempt.for_goals_alone;
  if (!workspace_.problem.can_touch()) return true;
  if (attempt.deadline.passed()) return false;
  attempt.search_cost += cost_of_all();
  problem.place(trial.q);
  if (!problem.touches()) return true;
  if (!attempt.redundant || !(stay_near || repair_pays(attempt)) || attempt.deadline.passed())
    return false;
  Result& result = *attempt.result;
  const int before = result.evaluations;
  problem.count_obstacles_within(kRepairMargin);
  if (!attempt.deadline.passed()) {
    trial.value = workspace_.minimise(stay_near ? workspace_.patient : workspace_.brisk, trial.q,
                                      attempt.lower, attempt.upper, result);
  }
  model_.wrap(attempt.start, trial.q);
  const double each = 1.0 + problem.obstacle_count() / kObstaclesPerEvaluation;
  attempt.repair_cost += 2.0 * cost_of_all() + each * (result.evaluations - before);
  if (attempt.deadline.passed()) return false;
  problem.evaluate(trial.q);  // the last step may have been taken back
  trial.reached = problem.reached();
  return trial.reached && !problem.touches();
}

double Restarts::cost_of_all() const {
  const Scene& scene = workspace_.scene();
  // Of a cloud in order most is passed by in blocks.
  return scene.obstacles()->in_order()
             ? 20.0 + 0.01 * scene.within_reach() / kObstaclesPerEvaluation
             : scene.within_reach() / kObstaclesPerEvaluation;
}

bool Restarts::repair_pays(const Attempt& attempt) const {
  constexpr int kUsualEvaluations = 8, kUsuallyAbout = 200;
  const int about = std::min(workspace_.scene().within_reach(), kUsuallyAbout);
  const double usual =
      2.0 * cost_of_all() + kUsualEvaluations * (1.0 + about / kObstaclesPerEvaluation);
  return attempt.repair_cost + usual < kRepairShare * attempt.search_cost;
}

void Restarts::keep_candidate(Attempt& attempt, const Trial& trial) {
  const bool by_lagrangian =
      model_.options.inner == InnerMethod::Lbfgs;  // whose shortfall nobody knows
  bool measured = attempt.for_goals_alone || (!workspace_.problem.can_touch() && !by_lagrangian);
  double shortfall = trial.value;
  const double cost = 1.0 + cost_of_all();
  const bool pays =
      by_lagrangian || attempt.measure_cost + cost < kMeasureShare * attempt.search_cost;
  if (!measured && pays && !attempt.deadline.passed()) {
    attempt.measure_cost += cost;
    workspace_.least_squares.count_all_obstacles();
    shortfall = workspace_.least_squares.evaluate(trial.q);
    measured = true;
  }
  attempt.candidates.add(trial.q, shortfall, measured);
}

void Restarts::settle(Attempt& attempt) {
  Result &result = *attempt.result, &saved = workspace_.saved;
  LeastSquaresProblem& problem = workspace_.least_squares;
  const Eigen::VectorXd& posture = attempt.wanted();
  saved = result;
  const double before = squared_distance(result.q, posture, model_.pull);
  q_ = result.q;
  problem.count_all_obstacles();
  problem.posture.set(&posture, &model_.pull);
  workspace_.minimise(workspace_.settling, q_, attempt.lower, attempt.upper, result);
  problem.posture.set(nullptr, nullptr);
  workspace_.minimise(workspace_.patient, q_, attempt.lower, attempt.upper, result);
  model_.wrap(attempt.start, q_);
  workspace_.judge(attempt.request.goals, q_, result);
  if (result.success && squared_distance(q_, posture, model_.pull) < before) return;
  restore(saved, result);
}

void Restarts::finish(Attempt& attempt) {
  Result& result = *attempt.result;
  work_for(attempt);
  if (attempt.found) {
    restore(attempt.best, result);
  } else if (!result.success) {
    // What runs still, and what waits for an earlier start, may be the best there is.
    for (std::size_t k = 0; k < lanes_.size(); ++k) {
      if (lanes_[k].attempt != &attempt) continue;
      const LaneSearch::End end = workspace_.lanes.end(static_cast<int>(k), q_);
      result.iterations += end.iterations;
      result.evaluations += end.evaluations;
      model_.wrap(attempt.start, q_);
      attempt.candidates.add(q_, end.value, attempt.for_goals_alone);
    }
    for (int k = attempt.next_verdict; k < attempt.next_start; ++k) {
      Trial& trial = attempt.trial(k);
      if (!trial.is_known) continue;
      model_.wrap(attempt.start, trial.q);
      attempt.candidates.add(trial.q, trial.value, attempt.for_goals_alone);
    }
    if (attempt.candidates.empty()) attempt.candidates.add(attempt.start, 0.0, true);
    if (!attempt.for_goals_alone) {
      workspace_.least_squares.count_all_obstacles();
      attempt.candidates.measure(
          [&](const auto& q) { return workspace_.least_squares.evaluate(q); },
          [&] { return attempt.deadline.passed(); });
    }
    // May solve by a tolerance's breadth.
    workspace_.judge(attempt.request.goals, attempt.candidates.best(), result);
  }
  end_result(attempt.hopeless, attempt.deadline, workspace_.scene().intake, result);
  for (std::size_t k = 0; k < lanes_.size(); ++k) {
    if (lanes_[k].attempt != &attempt) continue;
    workspace_.lanes.stop(static_cast<int>(k));
    lanes_[k].attempt = nullptr;
  }
  attempt.result = nullptr;
}

}  // namespace pdoik::detail
