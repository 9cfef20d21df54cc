#include "detail/step.hpp"

#include <algorithm>
#include <cmath>

#include "detail/outcome.hpp"
#include "detail/travel.hpp"

namespace pdoik::detail {
namespace {

/// What goals weigh against constraints when both cannot be had.
constexpr double kYieldingGoals = 1e-4;
/// Places on a longer way that are looked at are no nearer to each other than this share of it.
constexpr double kFinest = 0.1;

}  // namespace

Step::Step(Workspace& workspace)
    : workspace_(workspace), model_(workspace.model()), levers_(model_.levers) {
  for (Eigen::VectorXd* each : {&probe_.q, &q_, &lower_, &upper_, &at_, &held_levers_})
    each->setZero(model_.robot.dof());
}

void Step::approach(const StepRequest& step, double margin, Result& result) {
  LeastSquaresProblem& problem = workspace_.least_squares;
  workspace_.problem.set_goals(step.goals);
  q_ = *step.from;
  problem.posture.set(nullptr, nullptr);
  problem.count_no_obstacles();
  problem.evaluate(q_);
  // A goal that is farther than a step can bring it is approached by what a step can.
  for (GoalTerm& goal : workspace_.problem.goals) goal.come_within(step.advance, step.turn);
  if (workspace_.scene().within_reach() > 0)
    problem.count_obstacles_within(margin, true);
  else
    problem.count_shapes_alone();
  problem.remember_next();
  if (deadline_->passed()) return;
  if (step.pull_to != nullptr) {
    problem.posture.set(step.pull_to, step.pull);
    minimise(workspace_.settling, result);
    problem.posture.set(nullptr, nullptr);
  }
  minimise(workspace_.patient, result);
  if (step.pull_to != nullptr && !deadline_->struck() && !problem.holds()) {
    // The posture may have led astray: once more without it, and back if that is no better.
    at_ = q_;
    q_ = *step.from;
    minimise(workspace_.patient, result);
    if (!problem.holds()) {
      q_ = at_;
      if (!deadline_->passed()) problem.evaluate(q_);
    }
  }
  if (!deadline_->struck() && !problem.holds()) {
    // Not everything can be had: a goal that is far must not push the robot through a constraint.
    problem.scale_goals(kYieldingGoals / std::max(1.0, problem.goal_pull()));
    minimise(workspace_.settling, result);
    // What pulls at a constraint, however little, is a little beyond it.
    if (!deadline_->struck() && problem.touching()) {
      problem.scale_goals(0.0);
      minimise(workspace_.patient, result);
    }
    problem.scale_goals(1.0);
  }
}

double Step::way_from(const Eigen::VectorXd& from) {
  levers_ = model_.levers;
  if (!levers_.allFinite()) hull_levers(model_.robot, model_.hulls, from, q_, levers_);
  const Held& held = workspace_.scene().held();
  if (held.count() > 0) {
    hull_levers(model_.robot, held.balls(), from, q_, held_levers_);
    levers_ = levers_.cwiseMax(held_levers_);
  }
  return levers_.dot((q_ - from).cwiseAbs());
}

double Step::room(const Result& verdict) const {
  return std::min(verdict.clearance - model_.options.clearance,
                  0.5 * (verdict.self_distance - model_.options.self_clearance));
}

bool Step::is_clear_on_the_way(const StepRequest& step) {
  // Conservative advancement: nothing can be met before hulls have moved by their clearance. Where
  // there is none, the way may lead out or along, but no deeper.
  const double way = way_from(*step.from);
  double at = 0.0, floor = 0.0;
  while (true) {
    if (deadline_->passed()) return false;
    at_ = *step.from + at * (q_ - *step.from);
    workspace_.judge(step.goals, at_, probe_, step.look);
    const double left = room(probe_);
    if (at == 0.0) floor = std::min(0.0, left);
    if (left < floor - model_.options.clearance_tolerance) return false;
    if (at >= 1.0) return true;
    at = std::min(1.0, at + std::max(left - floor, kFinest * model_.long_way) / way);
  }
}

void Step::take(const StepRequest& step, Result& result) {
  const Deadline deadline = workspace_.deadline_in(step.max_time);
  deadline_ = &deadline;
  workspace_.watch(deadline);
  begin_result(result);
  probe_.late_evaluations = 0;
  lower_ = *step.lower;
  upper_ = *step.upper;
  approach(step, step.margin, result);
  if (way_from(*step.from) > model_.long_way && !is_clear_on_the_way(step)) {
    // Something is in between: no farther in this step than needs no looking.
    for (Eigen::Index i = 0; i < q_.size(); ++i) {
      const double most = model_.long_way / (static_cast<double>(q_.size()) * levers_[i]);
      lower_[i] = std::max(lower_[i], (*step.from)[i] - most);
      upper_[i] = std::min(upper_[i], (*step.from)[i] + most);
    }
    q_ = *step.from;
    if (!deadline.struck()) approach(step, model_.long_way, result);
  }
  // Half-way to a posture, with the time up, is no place to be if staying solves.
  const bool struck = deadline.struck(),
             stays = struck && workspace_.least_squares.remembered_holds();
  if (stays) q_ = *step.from;
  workspace_.judge(step.goals, q_, result, step.look);
  if (!result.success && !struck && !deadline.passed()) {
    // Nothing solves: better stay than go deeper into what a goal pulls at.
    Result& moved = workspace_.saved;
    moved = result;
    workspace_.judge(step.goals, *step.from, result, step.look);
    const double floor = std::min(0.0, room(result)) - model_.options.clearance_tolerance;
    if (!result.success && room(moved) >= floor) restore(moved, result);
  }
  result.late_evaluations += probe_.late_evaluations;
  result.status = result.success && !stays ? Status::Solved
                  : struck                 ? Status::TimeLimit
                                           : Status::Exhausted;
  result.time = deadline.elapsed();
  result.intake = workspace_.scene().intake;
}

}  // namespace pdoik::detail
