#include "search/acceptance.hpp"

#include <algorithm>
#include <cmath>

#include "search/outcome.hpp"

namespace pdoik::detail {
namespace {

/// How much wishes weigh, one after the other: see Acceptance::settle.
constexpr double kWishShares[] = {100.0, 1.0, 1e-3};
/// Obstacles this far from the hulls are left out while answers are brought clear [m].
constexpr double kRepairMargin = 0.1;
/// From so many starts that all touch by the same pair one may conclude: of n that are clear by
/// chance p, none is with a chance of (1 - p)^n, 5 % of p = 0.06 and n = 48.
constexpr int kStartsThatTell = 48;
/// Looking at this many obstacles costs about as much as evaluating the goal.
constexpr double kObstaclesPerEvaluation = 60.0;
/// ... or at this many pairs of a hull and a shape, most of which are far from each other.
constexpr double kShapesPerEvaluation = 60.0;
/// What it costs to look at two pieces of links, in evaluations of the goal.
constexpr double kEvaluationsPerLook = 4.0;

}  // namespace

Acceptance::Acceptance(Workspace& workspace) : workspace_(workspace), model_(workspace.model()) {
  q_.setZero(model_.robot.dof());
}

void Acceptance::work_for(SolveState& solve, int alternative) {
  if (worked_for_ == &solve && worked_for_alternative_ == alternative) return;
  worked_for_ = &solve;
  worked_for_alternative_ = alternative;
  workspace_.problem.set_goals(solve.goals(alternative));
  workspace_.watch(solve.deadline());
}

void Acceptance::unwind(const SolveState& solve, Trial& trial) const {
  model_.wrap(solve.start(), trial.q);
  model_.unwind(solve.preferred(), solve.lower(), solve.upper(), trial.q);
}

bool Acceptance::holds(SolveState& solve, const Trial& trial) {
  workspace_.judge(solve.goals(trial.alternative), trial.q, solve.result());
  solve.result().goal_index = trial.alternative;
  return solve.result().holds;
}

bool Acceptance::accept(SolveState& solve, int alternative) {
  if (solve.collects()) {
    leave_idle(solve, alternative);
    solve.add_solution();
    return solve.has_collected();
  }
  const Wanted& wanted = solve.wanted();
  if (wanted.settles()) settle(solve, alternative);
  leave_idle(solve, alternative);
  if (!wanted.best_of_many() && !wanted.costs) return true;
  return solve.rank(alternative, left_of(solve, solve.result().q));
}

void Acceptance::keep_position(SolveState& solve, Trial& trial) {
  if (solve.deadline().passed()) return;
  workspace_.least_squares.count_no_obstacles();
  trial.value = workspace_.minimise(workspace_.patient, trial.q, solve.lower(), solve.upper(),
                                    solve.result());
  trial.reached = workspace_.least_squares.reached();
}

std::optional<WorstConstraint> Acceptance::tool_contact(SolveState& solve, const Trial& trial) {
  if (!solve.may_check_tool(trial.alternative)) return std::nullopt;
  return workspace_.tool.contact(solve.goals(trial.alternative), workspace_.scene());
}

bool Acceptance::all_end_alike(SolveState& solve, const Trial& trial) {
  if (solve.has_found() || solve.wanted().goals_alone || solve.alternatives() > 1 ||
      model_.options.inner == InnerMethod::Lbfgs || solve.deadline().passed())
    return false;
  workspace_.least_squares.place(trial.q);
  solve.contacts().note(workspace_.problem);
  return solve.contacts().starts() >= kStartsThatTell && solve.has_repaired_enough();
}

bool Acceptance::is_clear(SolveState& solve, Trial& trial) {
  const bool stay_near = solve.stays_near(trial);
  LeastSquaresProblem& problem = workspace_.least_squares;
  if (solve.wanted().goals_alone || model_.options.inner == InnerMethod::Lbfgs)
    return !solve.wanted().goals_alone;
  if (!workspace_.problem.can_touch()) return true;
  if (solve.deadline().passed()) return false;
  solve.effort().search(cost_of_all());
  problem.place(trial.q);
  if (!problem.touches()) return true;
  if (!solve.wanted().redundant || !(stay_near || solve.effort().repair_pays(usual_repair())) ||
      solve.deadline().passed())
    return false;
  solve.count_repair();
  Result& result = solve.result();
  const int before = result.evaluations;
  const std::int64_t looks = problem.looks();
  problem.count_obstacles_within(kRepairMargin);
  if (!solve.deadline().passed()) {
    trial.value = workspace_.minimise(stay_near ? workspace_.patient : workspace_.brisk, trial.q,
                                      solve.lower(), solve.upper(), result);
  }
  model_.wrap(solve.start(), trial.q);
  const double each = 1.0 + problem.obstacle_count() / kObstaclesPerEvaluation;
  solve.effort().repair(2.0 * cost_of_all() + each * (result.evaluations - before) +
                        kEvaluationsPerLook * static_cast<double>(problem.looks() - looks));
  if (solve.deadline().passed()) return false;
  problem.evaluate(trial.q);  // the last step may have been taken back
  trial.reached = problem.reached();
  return trial.reached && !problem.touches();
}

double Acceptance::cost_of_all() const {
  const Scene& scene = workspace_.scene();
  const double hulls =
      static_cast<double>(model_.hulls.moving.size()) + scene.attachments().count();
  const double pairs = hulls * ShapeTree::usually_seen(scene.shapes().parts());
  // Of a cloud in order most is passed by in blocks.
  return pairs / kShapesPerEvaluation +
         (scene.obstacles()->in_order()
              ? 20.0 + 0.01 * scene.within_reach() / kObstaclesPerEvaluation
              : scene.within_reach() / kObstaclesPerEvaluation);
}

double Acceptance::usual_repair() const {
  constexpr int kUsualEvaluations = 8, kUsuallyAbout = 200;
  const int about = std::min(workspace_.scene().within_reach(), kUsuallyAbout);
  return 2.0 * cost_of_all() + kUsualEvaluations * (1.0 + about / kObstaclesPerEvaluation);
}

void Acceptance::keep_candidate(SolveState& solve, const Trial& trial) {
  const bool by_lagrangian =
      model_.options.inner == InnerMethod::Lbfgs;  // whose shortfall nobody knows
  bool measured = solve.wanted().goals_alone || (!workspace_.problem.can_touch() && !by_lagrangian);
  double shortfall = trial.value;
  const double cost = 1.0 + cost_of_all();
  const bool pays = by_lagrangian || solve.effort().measure_pays(cost);
  if (!measured && pays && !solve.deadline().passed()) {
    LeastSquaresProblem& problem = workspace_.least_squares;
    const std::int64_t before = problem.looks();
    problem.count_all_obstacles();
    shortfall = problem.evaluate(trial.q);
    measured = true;
    solve.effort().measure(cost +
                           kEvaluationsPerLook * static_cast<double>(problem.looks() - before));
  }
  solve.candidates().add(trial.q, trial.alternative, shortfall, measured);
}

void Acceptance::leave_idle(SolveState& solve, int alternative) {
  if (model_.options.balance.wanted() || solve.wanted().center_of_mass) return;
  const Robot& robot = model_.robot;
  Result &result = solve.result(), &saved = workspace_.saved;
  q_ = solve.preferred().cwiseMax(solve.lower()).cwiseMin(solve.upper());
  const auto keep = [&](int tip) {
    workspace_.problem.rollout.for_each_joint(
        robot.body_of_link(robot.tips()[static_cast<std::size_t>(tip)]),
        [&](int dof, double, bool, const Frame&) { q_[dof] = result.q[dof]; });
  };
  for (const Goal& goal : solve.goals(alternative)) {
    keep(goal.tip);
    if (goal.relative_to >= 0) keep(goal.relative_to);
  }
  if (q_ == result.q || solve.deadline().passed()) return;
  saved = result;
  workspace_.judge(solve.goals(alternative), q_, result);
  if (!result.holds) restore(saved, result);
}

double Acceptance::left_of(const SolveState& solve, const Eigen::VectorXd& q) {
  const bool wishes = solve.wanted().has_wishes();
  const double way = solve.wanted().posture || !wishes ? solve.distance_to_preferred(q) : 0.0;
  if (!wishes) return way;
  workspace_.least_squares.place(q);
  return way + 2.0 * workspace_.least_squares.wishes();
}

void Acceptance::settle(SolveState& solve, int alternative) {
  Result &result = solve.result(), &saved = workspace_.saved;
  LeastSquaresProblem& problem = workspace_.least_squares;
  const bool wishes = solve.wanted().has_wishes();
  const Eigen::VectorXd& posture = solve.preferred();
  saved = result;
  const double before = left_of(solve, result.q);
  q_ = result.q;
  problem.count_all_obstacles();
  if (solve.wanted().posture || !wishes) problem.posture.set(&posture, &model_.pull);
  if (wishes) {
    // The less wishes weigh the less they bend what is hard, and the less far they lead. Where
    // position comes first, starts are all over the place already, and are to stay apart.
    for (const double share : kWishShares) {
      if (solve.wanted().compromises && share > 1.0) continue;
      problem.wishes_count = share;
      workspace_.minimise(workspace_.wishing, q_, solve.lower(), solve.upper(), result);
    }
    problem.wishes_count = 0.0;
  } else {
    workspace_.minimise(workspace_.settling, q_, solve.lower(), solve.upper(), result);
  }
  problem.posture.set(nullptr, nullptr);
  workspace_.minimise(workspace_.patient, q_, solve.lower(), solve.upper(), result);
  model_.wrap(solve.start(), q_);
  model_.unwind(posture, solve.lower(), solve.upper(), q_);
  workspace_.judge(solve.goals(alternative), q_, result);
  result.goal_index = alternative;
  if (result.holds && left_of(solve, q_) < before) return;
  restore(saved, result);
}

void Acceptance::finish(SolveState& solve) {
  Result& result = solve.result();
  if (solve.has_found())
    restore(solve.best(), result);
  else if (!result.holds)
    return_nearest(solve);
  end_result(solve.hopeless(), solve.deadline(), workspace_.scene().intake, result);
  name_base_contact(workspace_.scene(), model_.options, result);
}

void Acceptance::return_nearest(SolveState& solve) {
  Result& result = solve.result();
  Candidates& candidates = solve.candidates();
  solve.add_unjudged();
  if (candidates.empty()) candidates.add(solve.start(), 0, 0.0, true);
  if (!solve.wanted().goals_alone) {
    candidates.measure(
        [&](const Candidates::Entry& entry) {
          work_for(solve, entry.alternative);
          workspace_.least_squares.count_all_obstacles();
          return workspace_.least_squares.evaluate(entry.q);
        },
        [&] { return solve.deadline().passed(); });
  }
  const Candidates::Entry& best = candidates.best();
  work_for(solve, best.alternative);
  // May solve by a tolerance's breadth.
  workspace_.judge(solve.goals(best.alternative), best.q, result);
  result.goal_index = best.alternative;
  if (result.holds || solve.hopeless() != Status::Blocked) return;
  std::optional<WorstConstraint> contact = solve.contact();
  if (!contact) {
    workspace_.least_squares.place(result.q);
    contact = solve.contacts().deepest(workspace_.problem);
  }
  if (contact) result.worst = *contact;
}

}  // namespace pdoik::detail
