#include "detail/verdicts.hpp"

#include <algorithm>

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
/// From so many starts that all touch by the same pair one may conclude: of n that are clear by
/// chance p, none is with a chance of (1 - p)^n, 5 % of p = 0.06 and n = 48.
constexpr int kStartsThatTell = 48, kRepairsThatTell = 4;
/// Looking at this many obstacles costs about as much as evaluating the goal.
constexpr double kObstaclesPerEvaluation = 60.0;
/// ... or at this many pairs of a hull and a shape, most of which are far from each other.
constexpr double kShapesPerEvaluation = 60.0;

}  // namespace

Verdicts::Verdicts(Workspace& workspace) : workspace_(workspace), model_(workspace.model()) {
  q_.setZero(model_.robot.dof());
}

void Verdicts::work_for(Attempt& attempt) {
  if (worked_for_ == &attempt) return;
  worked_for_ = &attempt;
  workspace_.problem.set_goals(attempt.request.goals);
  workspace_.watch(attempt.deadline);
}

bool Verdicts::take(Attempt& attempt, int k) {
  work_for(attempt);
  Trial& trial = attempt.trial(k);
  Result& result = *attempt.result;
  result.iterations += trial.iterations;
  result.evaluations += trial.evaluations;
  result.restarts = k;
  attempt.search_cost += trial.evaluations;
  model_.wrap(attempt.start, trial.q);
  model_.unwind(attempt.wanted(), attempt.lower, attempt.upper, trial.q);
  if (trial.reached && is_clear(attempt, trial, attempt.stays_near(k))) {
    workspace_.judge(attempt.request.goals, trial.q, result);
    if (result.success) {
      if (attempt.request.posture != nullptr || attempt.nearest) settle(attempt);
      leave_idle(attempt);
      if (!attempt.nearest) return true;
      const double distance = attempt.distance_to_wanted(result.q);
      if (!attempt.found || distance < attempt.least) {
        attempt.found = true;
        attempt.least = distance;
        attempt.best = result;
      }
      return false;
    }
  }
  if (!attempt.found) keep_candidate(attempt, trial);
  if (trial.reached && is_blocked(attempt)) {
    attempt.candidates.clear();  // nothing will be better than what reaches the goals
    attempt.candidates.add(trial.q, 0.0, true);
    return true;
  }
  if (trial.reached && all_end_alike(attempt, trial)) return true;
  if (attempt.for_goals_alone && trial.reached) return true;  // nothing better can be found
  return false;
}

bool Verdicts::is_blocked(Attempt& attempt) {
  if (attempt.tool_checked || attempt.found || attempt.for_goals_alone) return false;
  attempt.tool_checked = true;
  attempt.contact = workspace_.tool.contact(attempt.request.goals, workspace_.scene());
  if (attempt.contact) attempt.hopeless = Status::Blocked;
  return attempt.contact.has_value();
}

bool Verdicts::all_end_alike(Attempt& attempt, const Trial& trial) {
  if (attempt.found || attempt.for_goals_alone || model_.options.inner == InnerMethod::Lbfgs ||
      attempt.deadline.passed())
    return false;
  workspace_.least_squares.place(trial.q);
  attempt.common.note(workspace_.problem);
  if (attempt.common.starts() < kStartsThatTell ||
      (attempt.redundant && attempt.repairs < kRepairsThatTell))
    return false;
  attempt.hopeless = Status::Blocked;
  return true;
}

bool Verdicts::is_clear(Attempt& attempt, Trial& trial, bool stay_near) {
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
  ++attempt.repairs;
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

double Verdicts::cost_of_all() const {
  const Scene& scene = workspace_.scene();
  const double pairs = static_cast<double>(
      scene.shapes().count() *
      (model_.hulls.moving.size() + static_cast<std::size_t>(scene.held().count())));
  // Of a cloud in order most is passed by in blocks.
  return pairs / kShapesPerEvaluation +
         (scene.obstacles()->in_order()
              ? 20.0 + 0.01 * scene.within_reach() / kObstaclesPerEvaluation
              : scene.within_reach() / kObstaclesPerEvaluation);
}

bool Verdicts::repair_pays(const Attempt& attempt) const {
  constexpr int kUsualEvaluations = 8, kUsuallyAbout = 200;
  const int about = std::min(workspace_.scene().within_reach(), kUsuallyAbout);
  const double usual =
      2.0 * cost_of_all() + kUsualEvaluations * (1.0 + about / kObstaclesPerEvaluation);
  return attempt.repair_cost + usual < kRepairShare * attempt.search_cost;
}

void Verdicts::keep_candidate(Attempt& attempt, const Trial& trial) {
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

void Verdicts::leave_idle(Attempt& attempt) {
  if (model_.options.balance.wanted()) return;
  const Robot& robot = model_.robot;
  Result &result = *attempt.result, &saved = workspace_.saved;
  q_ = attempt.wanted().cwiseMax(attempt.lower).cwiseMin(attempt.upper);
  for (const Goal& goal : attempt.request.goals) {
    const int link = robot.tips()[static_cast<std::size_t>(goal.tip)];
    workspace_.problem.rollout.for_each_joint(
        robot.body_of_link(link),
        [&](int dof, double, bool, const Frame&) { q_[dof] = result.q[dof]; });
  }
  if (q_ == result.q || attempt.deadline.passed()) return;
  saved = result;
  workspace_.judge(attempt.request.goals, q_, result);
  if (!result.success) restore(saved, result);
}

void Verdicts::settle(Attempt& attempt) {
  Result &result = *attempt.result, &saved = workspace_.saved;
  LeastSquaresProblem& problem = workspace_.least_squares;
  const Eigen::VectorXd& posture = attempt.wanted();
  saved = result;
  const double before = attempt.distance_to_wanted(result.q);
  q_ = result.q;
  problem.count_all_obstacles();
  problem.posture.set(&posture, &model_.pull);
  workspace_.minimise(workspace_.settling, q_, attempt.lower, attempt.upper, result);
  problem.posture.set(nullptr, nullptr);
  workspace_.minimise(workspace_.patient, q_, attempt.lower, attempt.upper, result);
  model_.wrap(attempt.start, q_);
  model_.unwind(posture, attempt.lower, attempt.upper, q_);
  workspace_.judge(attempt.request.goals, q_, result);
  if (result.success && attempt.distance_to_wanted(q_) < before) return;
  restore(saved, result);
}

void Verdicts::finish(Attempt& attempt) {
  Result& result = *attempt.result;
  work_for(attempt);
  if (attempt.found) {
    restore(attempt.best, result);
  } else if (!result.success) {
    // What waits for an earlier start may be the best there is.
    for (int k = attempt.next_verdict; k < attempt.next_start && !attempt.contact; ++k) {
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
    if (attempt.hopeless == Status::Blocked && !attempt.contact && !result.success) {
      workspace_.least_squares.place(result.q);
      attempt.contact = attempt.common.deepest(workspace_.problem);
    }
    if (attempt.contact && !result.success) result.worst = *attempt.contact;
  }
  end_result(attempt.hopeless, attempt.deadline, workspace_.scene().intake, result);
  name_base_contact(workspace_.scene(), model_.options, result);
}

}  // namespace pdoik::detail
