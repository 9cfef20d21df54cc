#include "detail/verdicts.hpp"

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
/// Two ends came to the same if what they leave of wishes differs by no more than this share; of so
/// many ends so many have to have come to the best before others are not tried.
constexpr double kAlike = 2e-3;
constexpr int kAgreements = 5, kSettlements = 12;
constexpr double kWishShares[] = {100.0, 1.0, 1e-3};
/// Obstacles this far from the hulls are left out while answers are brought clear [m].
constexpr double kRepairMargin = 0.1;
/// From so many starts that all touch by the same pair one may conclude: of n that are clear by
/// chance p, none is with a chance of (1 - p)^n, 5 % of p = 0.06 and n = 48.
constexpr int kStartsThatTell = 48, kRepairsThatTell = 4;
/// Looking at this many obstacles costs about as much as evaluating the goal.
constexpr double kObstaclesPerEvaluation = 60.0;
/// ... or at this many pairs of a hull and a shape, most of which are far from each other.
constexpr double kShapesPerEvaluation = 60.0;
/// What it costs to look at two pieces of links, in evaluations of the goal.
constexpr double kEvaluationsPerLook = 4.0;

}  // namespace

Verdicts::Verdicts(Workspace& workspace) : workspace_(workspace), model_(workspace.model()) {
  q_.setZero(model_.robot.dof());
}

void Verdicts::work_for(Attempt& attempt, int alternative) {
  if (worked_for_ == &attempt && worked_for_alternative_ == alternative) return;
  worked_for_ = &attempt;
  worked_for_alternative_ = alternative;
  workspace_.problem.set_goals(attempt.goals(alternative));
  workspace_.watch(attempt.deadline);
}

bool Verdicts::take(Attempt& attempt, int k) {
  Trial& trial = attempt.trial(k);
  const int alternative = trial.alternative;
  work_for(attempt, alternative);
  Result& result = *attempt.result;
  result.iterations += trial.iterations;
  result.evaluations += trial.evaluations;
  result.restarts = k;
  if (attempt.is_given_up(alternative)) return attempt.live.empty();
  attempt.search_cost += trial.evaluations;
  if (attempt.alternatives() > 1 && attempt.request.costs.empty() && !attempt.ranks)
    attempt.note_left(k, trial.reached ? 0.0 : 2.0 * trial.value);
  if (attempt.compromises && !trial.reached) hold_position(attempt, trial);
  model_.wrap(attempt.start, trial.q);
  model_.unwind(attempt.wanted(), attempt.lower, attempt.upper, trial.q);
  if (attempt.collection != nullptr && trial.reached) attempt.collection->note(trial.q);
  if (trial.reached && is_clear(attempt, trial, attempt.stays_near(trial))) {
    workspace_.judge(attempt.goals(alternative), trial.q, result);
    result.goal_index = alternative;
    if (result.holds) return accept(attempt, alternative);
  }
  if (!attempt.found) keep_candidate(attempt, trial);
  if (attempt.collection != nullptr) return attempt.collection->is_full();
  if (trial.reached && is_blocked(attempt, alternative)) {
    attempt.give_up(alternative);
    if (!attempt.live.empty() || attempt.found) return false;
    attempt.hopeless = Status::Blocked;
    attempt.candidates.clear();  // nothing will be better than what reaches the goals
    attempt.candidates.add(trial.q, alternative, 0.0, true);
    return true;
  }
  if (trial.reached && all_end_alike(attempt, trial)) return true;
  if (attempt.for_goals_alone && trial.reached) return true;  // nothing better can be found
  return false;
}

bool Verdicts::accept(Attempt& attempt, int alternative) {
  Result& result = *attempt.result;
  if (attempt.collection != nullptr) {
    leave_idle(attempt, alternative);
    if (!attempt.found) attempt.best = result;
    attempt.found = true;
    attempt.collection->add(result);
    return attempt.collection->is_full();
  }
  if (attempt.request.posture != nullptr || attempt.ranks || attempt.wishes)
    settle(attempt, alternative);
  leave_idle(attempt, alternative);
  if (!attempt.ranks && attempt.request.costs.empty()) return true;
  const double cost = attempt.cost(alternative), left = left_of(attempt, result.q);
  const bool is_best = !attempt.found || cost < attempt.least_cost ||
                       (cost == attempt.least_cost && left < attempt.least);
  const bool is_agreed_on = attempt.compromises && is_agreed(attempt, left, is_best);
  if (is_best) {
    attempt.found = true;
    attempt.least = left;
    attempt.least_cost = cost;
    attempt.best = result;
  }
  for (int other = 0; !attempt.request.costs.empty() && other < attempt.alternatives(); ++other) {
    const double theirs = attempt.cost(other);
    if (theirs > attempt.least_cost || (theirs == attempt.least_cost && !attempt.ranks))
      attempt.give_up(other);
  }
  return is_agreed_on || attempt.live.empty();
}

bool Verdicts::is_agreed(Attempt& attempt, double left, bool is_best) {
  ++attempt.settled;
  const bool is_alike = attempt.settled > 1 &&
                        std::abs(left - attempt.least) <= kAlike * std::max(left, attempt.least);
  attempt.agreed = is_alike ? attempt.agreed + 1 : is_best ? 1 : attempt.agreed;
  const bool solves = attempt.result->success && model_.options.prefer == Prefer::First &&
                      !attempt.wishes && attempt.request.posture == nullptr;
  return solves || (!attempt.redundant_for_all && attempt.agreed >= kAgreements &&
                    attempt.settled >= kSettlements);
}

void Verdicts::hold_position(Attempt& attempt, Trial& trial) {
  if (attempt.deadline.passed()) return;
  workspace_.least_squares.count_no_obstacles();
  trial.value = workspace_.minimise(workspace_.patient, trial.q, attempt.lower, attempt.upper,
                                    *attempt.result);
  trial.reached = workspace_.least_squares.reached();
}

bool Verdicts::is_blocked(Attempt& attempt, int alternative) {
  if (attempt.found || attempt.for_goals_alone) return false;
  char& checked = attempt.tool_checked[static_cast<std::size_t>(alternative)];
  if (checked != 0) return false;
  checked = 1;
  const auto contact = workspace_.tool.contact(attempt.goals(alternative), workspace_.scene());
  if (contact) attempt.contact = contact;
  return contact.has_value();
}

bool Verdicts::all_end_alike(Attempt& attempt, const Trial& trial) {
  if (attempt.found || attempt.for_goals_alone || attempt.alternatives() > 1 ||
      model_.options.inner == InnerMethod::Lbfgs || attempt.deadline.passed())
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
  const std::int64_t looks = problem.looks();
  problem.count_obstacles_within(kRepairMargin);
  if (!attempt.deadline.passed()) {
    trial.value = workspace_.minimise(stay_near ? workspace_.patient : workspace_.brisk, trial.q,
                                      attempt.lower, attempt.upper, result);
  }
  model_.wrap(attempt.start, trial.q);
  const double each = 1.0 + problem.obstacle_count() / kObstaclesPerEvaluation;
  attempt.repair_cost += 2.0 * cost_of_all() + each * (result.evaluations - before) +
                         kEvaluationsPerLook * static_cast<double>(problem.looks() - looks);
  if (attempt.deadline.passed()) return false;
  problem.evaluate(trial.q);  // the last step may have been taken back
  trial.reached = problem.reached();
  return trial.reached && !problem.touches();
}

double Verdicts::cost_of_all() const {
  const Scene& scene = workspace_.scene();
  const double hulls = static_cast<double>(model_.hulls.moving.size()) + scene.held().count();
  const double pairs = hulls * ShapeTree::usually_seen(scene.shapes().parts());
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
    LeastSquaresProblem& problem = workspace_.least_squares;
    const std::int64_t before = problem.looks();
    problem.count_all_obstacles();
    shortfall = problem.evaluate(trial.q);
    measured = true;
    attempt.measure_cost +=
        cost + kEvaluationsPerLook * static_cast<double>(problem.looks() - before);
  }
  attempt.candidates.add(trial.q, trial.alternative, shortfall, measured);
}

void Verdicts::leave_idle(Attempt& attempt, int alternative) {
  if (model_.options.balance.wanted() || attempt.of_mass) return;
  const Robot& robot = model_.robot;
  Result &result = *attempt.result, &saved = workspace_.saved;
  q_ = attempt.wanted().cwiseMax(attempt.lower).cwiseMin(attempt.upper);
  const auto keep = [&](int tip) {
    workspace_.problem.rollout.for_each_joint(
        robot.body_of_link(robot.tips()[static_cast<std::size_t>(tip)]),
        [&](int dof, double, bool, const Frame&) { q_[dof] = result.q[dof]; });
  };
  for (const Goal& goal : attempt.goals(alternative)) {
    keep(goal.tip);
    if (goal.relative_to >= 0) keep(goal.relative_to);
  }
  if (q_ == result.q || attempt.deadline.passed()) return;
  saved = result;
  workspace_.judge(attempt.goals(alternative), q_, result);
  if (!result.holds) restore(saved, result);
}

double Verdicts::left_of(const Attempt& attempt, const Eigen::VectorXd& q) {
  const bool wishes = attempt.wishes || attempt.compromises;
  const double way =
      attempt.request.posture != nullptr || !wishes ? attempt.distance_to_wanted(q) : 0.0;
  if (!wishes) return way;
  workspace_.least_squares.place(q);
  return way + 2.0 * workspace_.least_squares.wishes();
}

void Verdicts::settle(Attempt& attempt, int alternative) {
  Result &result = *attempt.result, &saved = workspace_.saved;
  LeastSquaresProblem& problem = workspace_.least_squares;
  const bool wishes = attempt.wishes || attempt.compromises;
  const Eigen::VectorXd& posture = attempt.wanted();
  saved = result;
  const double before = left_of(attempt, result.q);
  q_ = result.q;
  problem.count_all_obstacles();
  if (attempt.request.posture != nullptr || !wishes) problem.posture.set(&posture, &model_.pull);
  if (wishes) {
    // The less wishes weigh the less they bend what is hard, and the less far they lead. Where
    // position comes first, starts are all over the place already, and are to stay apart.
    for (const double share : kWishShares) {
      if (attempt.compromises && share > 1.0) continue;
      problem.wishes_count = share;
      workspace_.minimise(workspace_.wishing, q_, attempt.lower, attempt.upper, result);
    }
    problem.wishes_count = 0.0;
  } else {
    workspace_.minimise(workspace_.settling, q_, attempt.lower, attempt.upper, result);
  }
  problem.posture.set(nullptr, nullptr);
  workspace_.minimise(workspace_.patient, q_, attempt.lower, attempt.upper, result);
  model_.wrap(attempt.start, q_);
  model_.unwind(posture, attempt.lower, attempt.upper, q_);
  workspace_.judge(attempt.goals(alternative), q_, result);
  result.goal_index = alternative;
  if (result.holds && left_of(attempt, q_) < before) return;
  restore(saved, result);
}

void Verdicts::finish(Attempt& attempt) {
  Result& result = *attempt.result;
  if (attempt.found) {
    restore(attempt.best, result);
  } else if (!result.holds) {
    // What waits for an earlier start may be the best there is.
    for (int k = attempt.next_verdict; k < attempt.next_start && !attempt.is_blocked(); ++k) {
      Trial& trial = attempt.trial(k);
      if (!trial.is_known) continue;
      model_.wrap(attempt.start, trial.q);
      attempt.candidates.add(trial.q, trial.alternative, trial.value, attempt.for_goals_alone);
    }
    if (attempt.candidates.empty()) attempt.candidates.add(attempt.start, 0, 0.0, true);
    if (!attempt.for_goals_alone) {
      attempt.candidates.measure(
          [&](const Candidates::Entry& entry) {
            work_for(attempt, entry.alternative);
            workspace_.least_squares.count_all_obstacles();
            return workspace_.least_squares.evaluate(entry.q);
          },
          [&] { return attempt.deadline.passed(); });
    }
    const Candidates::Entry& best = attempt.candidates.best();
    work_for(attempt, best.alternative);
    // May solve by a tolerance's breadth.
    workspace_.judge(attempt.goals(best.alternative), best.q, result);
    result.goal_index = best.alternative;
    const bool is_blocked = attempt.hopeless == Status::Blocked;
    if (is_blocked && !attempt.contact && !result.holds) {
      workspace_.least_squares.place(result.q);
      attempt.contact = attempt.common.deepest(workspace_.problem);
    }
    if (is_blocked && attempt.contact && !result.holds) result.worst = *attempt.contact;
  }
  end_result(attempt.hopeless, attempt.deadline, workspace_.scene().intake, result);
  name_base_contact(workspace_.scene(), model_.options, result);
}

}  // namespace pdoik::detail
