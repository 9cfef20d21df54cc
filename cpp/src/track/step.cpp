#include "track/step.hpp"

#include <algorithm>
#include <cmath>

#include "search/outcome.hpp"

namespace pdoik::detail {
namespace {

constexpr int kRounds = 6;    ///< candidates in a step
constexpr int kPulled = 2;    ///< Gauss-Newton steps with the posture
constexpr int kExactly = 25;  ///< and without it, until the goals are reached
/// Barriers are looked for at twice what a step can reach, since it may take half of it, and no
/// farther than this [m].
constexpr double kShareOfReach = 2.0, kFarthestBarrier = 0.3;
/// Of the largest diagonal entry of the Hessian: where the goals leave a joint free it stays.
constexpr double kDamping = 1e-5, kLeastDamping = 1e-11;
constexpr double kStalled = 0.98;                 ///< share of a cost that a turn may leave
constexpr double kEasier = 0.3, kHarder = 4.0;    ///< after a turn that went downhill, or did not
constexpr double kFulfilled = 0.1;                ///< share of what was foreseen that is downhill
constexpr double kShares[] = {0.5, 0.25, 0.125};  ///< of a way that is not to be gone whole
constexpr double kSettled = 1e-10;                ///< a change of joints that is none [rad], [m]
constexpr double kMuchNearer = 0.25;              ///< share of what goals cost that is much less
/// How much more what stands weighs than what does not: as good as first, and still one sum. What
/// then bends the valley that goals are in is gone along in many small turns.
constexpr double kStands = 1e7;
/// A way bends what stands: all joints go only so much of what they may, less where the gate would
/// not have it, and more again.
constexpr double kShorter = 0.5, kLonger = 1.25, kShortest = 0.1;
constexpr double kWorthwhile = 0.98;  ///< share of a shortfall that may be left by a round

}  // namespace

Step::Step(Workspace& workspace)
    : workspace_(workspace),
      model_(workspace.model()),
      gate_(workspace),
      barriers_(model_),
      program_(model_.robot.dof()),
      factor_(model_.robot.dof()) {
  before_.reserve(kMostGoals);
  const Eigen::Index n = model_.robot.dof();
  hessian_.setZero(n, n);
  for (Eigen::VectorXd* each : {&gradient_, &moved_, &q_, &pulled_, &next_, &least_, &most_})
    each->setZero(n);
}

double Step::modelled(const Eigen::VectorXd& way) {
  moved_.noalias() = hessian_.selfadjointView<Eigen::Upper>() * way;
  return way.dot(0.5 * moved_ + gradient_);
}

double Step::descend(const Eigen::VectorXd& about, int turns, Result& result) {
  LeastSquaresProblem& problem = workspace_.least_squares;
  double goals = problem.evaluate_goals(q_), value = goals + problem.posture.value(q_);
  ++result.evaluations;
  double damping = -1.0;
  for (int turn = 0; turn < turns && !late(); ++turn) {
    if (!problem.posture.wanted() && problem.reached()) break;
    problem.linearise_goals(hessian_, gradient_);
    problem.posture.linearise(q_, hessian_, gradient_);
    const double scale =
        std::max(hessian_.diagonal().maxCoeff() / (gate_.stands() ? kStands : 1.0), 1e-12);
    if (damping < 0.0) damping = kDamping * scale + value;
    damping = std::max(damping, kLeastDamping * scale);
    hessian_.diagonal().array() += damping;
    next_ = q_ - about;
    gradient_.noalias() -= hessian_.selfadjointView<Eigen::Upper>() * next_;
    const double here = modelled(next_);
    ++result.iterations;
    if (!program_.factorise(hessian_) ||
        !program_.solve(gradient_, barriers_.within(least_, most_), next_))
      break;
    const double foreseen = here - modelled(next_);
    next_ += about;
    const double change = (next_ - q_).cwiseAbs().maxCoeff();
    const double goals_there = problem.evaluate_goals(next_),
                 there = goals_there + problem.posture.value(next_);
    ++result.evaluations;
    if (there < value - kFulfilled * foreseen) {
      const bool stalls = there > kStalled * value;
      q_ = next_;
      value = there;
      goals = goals_there;
      damping *= kEasier;
      if (stalls && !gate_.stands()) break;
    } else {
      problem.evaluate_goals(q_);
      damping *= kHarder;
    }
    if (change < kSettled) break;
  }
  return goals;
}

bool Step::look(const StepRequest& step, const Eigen::VectorXd& about, double stride) {
  least_ = *step.from + stride * (*step.lower - *step.from) - about;
  most_ = *step.from + stride * (*step.upper - *step.from) - about;
  workspace_.least_squares.place(about);
  next_ = most_.cwiseMax(-least_);
  if (late() || !barriers_.find(workspace_.problem,
                                std::min(kShareOfReach * step.margin, kFarthestBarrier), next_))
    return false;
  barriers_.come_to_terms(least_, most_);
  return true;
}

bool Step::look_there(const Eigen::VectorXd& about) {
  workspace_.least_squares.place(gate_.tried());
  next_ = gate_.tried() - about;
  if (late() || !barriers_.cut(workspace_.problem, next_)) return false;
  barriers_.come_to_terms(least_, most_);
  return true;
}

void Step::propose(const StepRequest& step, const Eigen::VectorXd& about, Result& result) {
  LeastSquaresProblem& problem = workspace_.least_squares;
  q_ = about + barriers_.way_out();
  problem.posture.set(step.pull_to, step.pull);
  const double left = descend(about, kPulled, result), pull = problem.posture.value(q_);
  pulled_ = q_;
  problem.posture.set(nullptr, nullptr);
  const double exactly = descend(about, kExactly, result);
  // Goals come first: where they are next to reached, or nearly, whatever pulls.
  if (problem.reached() || exactly < kMuchNearer * left) return;
  problem.posture.set(step.pull_to, step.pull);
  if (exactly + problem.posture.value(q_) > left + pull) q_ = pulled_;
}

void Step::take_a_part(const Eigen::VectorXd& about) {
  for (const double share : kShares) {
    if (late() || gate_.consider(q_, share)) return;
  }
  // At least out of what it is in, whatever becomes of the goals.
  q_ = about + barriers_.way_out();
  if (!gate_.clear() && !late()) gate_.consider(q_);
}

void Step::go_on(const StepRequest& step, Result& result) {
  Eigen::VectorXd& about = workspace_.q;
  about = *step.from;
  bool looks = true;
  double stride = gate_.stands() ? stride_ : 1.0;
  for (int round = 0; round < kRounds; ++round) {
    if (gate_.done()) return;
    const double before = gate_.shortfall();
    if (looks && !look(step, about, stride)) return;
    propose(step, about, result);
    if ((q_ - about).cwiseAbs().maxCoeff() < kSettled) return;
    // Time is kept for it, though the clock has struck.
    const double share = gate_.share_in_time(q_);
    const bool taken = gate_.consider(q_, share);
    if (late()) return;
    looks = true;
    if (taken) {
      stride = stride_ = std::min(1.0, kLonger * stride_);
      if (gate_.clear() && gate_.shortfall() > kWorthwhile * before) return;
    } else if (gate_.gives_way()) {
      stride = stride_ *= kShorter;
    } else if (gate_.missed() > 0.0 && round + 1 < kRounds) {
      if (!look_there(about)) return;
      looks = false;
      continue;
    } else if (brought_near_) {
      bring_near(step, false);
    } else if (round + 1 < kRounds && kShorter * stride > kShortest) {
      stride *= std::min(share, kShorter);  // a way that bends may be worth it only where it begins
    } else {
      return take_a_part(about);
    }
    about = gate_.aim();
  }
}

void Step::bring_near(const StepRequest& step, bool near) {
  workspace_.problem.set_goals(step.goals);
  for (GoalTerm& goal : workspace_.problem.goals) {
    if (goal.stands()) goal.weigh(kStands);
  }
  brought_near_ = false;
  if (!near) return;
  workspace_.least_squares.evaluate_goals(*step.from);
  for (GoalTerm& goal : workspace_.problem.goals)
    brought_near_ |= goal.come_within(step.advance, step.turn);
}

void Step::follow(std::span<const Goal> goals, const Eigen::VectorXd& from, Braking& braking) {
  if (!braking.limited()) return;
  braking.stop_drifting();
  const bool alike = std::equal(goals.begin(), goals.end(), before_.begin(), before_.end(),
                                [](const Goal& one, const Goal& other) {
                                  return one.tip == other.tip && one.type == other.type &&
                                         one.relative_to == other.relative_to;
                                });
  if (braking.follows() && alike) {
    // Joints that go on as the goals did: what their errors changed by, by least squares.
    LeastSquaresProblem& problem = workspace_.least_squares;
    problem.posture.set(nullptr, nullptr);
    const auto gradient_of = [&](std::span<const Goal> of) {
      workspace_.problem.set_goals(of);
      problem.evaluate_goals(from);
      problem.linearise_goals(hessian_, gradient_);
    };
    gradient_of(before_);
    next_ = gradient_;
    gradient_of(goals);
    next_ = (next_ - gradient_) / braking.period();
    hessian_.diagonal().array() += kDamping * std::max(hessian_.diagonal().maxCoeff(), 1e-12);
    factor_.compute(hessian_);
    factor_.solveInPlace(next_);
    braking.set_drift(next_);
  }
  before_.assign(goals.begin(), goals.end());
}

void Step::take(const StepRequest& step, Result& result) {
  // Verdicts for which time is kept: of a way's end and of one before; of where it rests, and
  // brakes.
  const Deadline deadline = workspace_.deadline_in(step.max_time, step.braking->limited() ? 4 : 2);
  workspace_.watch(deadline);
  begin_result(result);
  gate_.open(step);
  bring_near(step, true);
  go_on(step, result);
  step.braking->made(*step.from, gate_.incumbent().q, gate_.meets_goals(), !gate_.took());
  restore(gate_.incumbent(), result);
  result.late_evaluations = gate_.late_evaluations();
  result.status = result.success      ? Status::Solved
                  : deadline.struck() ? Status::TimeLimit
                                      : Status::Exhausted;
  result.time = deadline.elapsed();
  result.intake = workspace_.scene().intake;
}

}  // namespace pdoik::detail
