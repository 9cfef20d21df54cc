// A control loop's step: downhill from the last answer, within bounds, by a deadline.
#include <algorithm>
#include <cmath>

#include "detail/search.hpp"
#include "detail/travel.hpp"

namespace pdoik::detail {
namespace {

/// What goals weigh against constraints when both cannot be had.
constexpr double kYieldingGoals = 1e-4;
/// A step that moves no part of a hull farther than this, nor than half the thinnest hull's width,
/// is not looked at along the way: nothing that is clear of both its ends reaches deep on it [m].
constexpr double kLongWay = 0.02;
/// Hulls are taken for no thinner than this [m].
constexpr double kThin = 2e-4;
/// Places on a longer way that are looked at are no nearer to each other than this share of it.
constexpr double kFinest = 0.1;

}  // namespace

void Search::approach(const Following& step, double margin, Result& result) {
  set_goals(step.goals);
  q_ = *step.from;
  least_squares_.pull_towards(nullptr, nullptr);
  least_squares_.heed_none();
  least_squares_.evaluate(q_);
  // A goal that is farther than a step can bring it is approached by what a step can.
  for (GoalTerm& goal : goals_) goal.come_within(step.advance, step.turn);
  if (scene_->near.count() > 0) least_squares_.heed_those_about(margin, true);
  least_squares_.remember_next();
  if (deadline_.passed()) return;
  if (step.pull_to != nullptr) {
    least_squares_.pull_towards(step.pull_to, step.pull);
    minimise_least_squares(settling_, result);
    least_squares_.pull_towards(nullptr, nullptr);
  }
  minimise_least_squares(patient_, result);
  if (step.pull_to != nullptr && !deadline_.struck() && !least_squares_.holds()) {
    // The posture may have led astray: once more without it, and back if that is no better.
    unsettled_ = q_;
    q_ = *step.from;
    minimise_least_squares(patient_, result);
    if (!least_squares_.holds()) {
      q_ = unsettled_;
      if (!deadline_.passed()) least_squares_.evaluate(q_);
    }
  }
  if (!deadline_.struck() && !least_squares_.holds()) {
    // Not everything can be had: a goal that is far must not push the robot through a constraint.
    least_squares_.scale_goals(kYieldingGoals / std::max(1.0, least_squares_.goal_pull()));
    minimise_least_squares(settling_, result);
    // What pulls at a constraint, however little, is a little beyond it.
    if (!deadline_.struck() && least_squares_.touching()) {
      least_squares_.scale_goals(0.0);
      minimise_least_squares(patient_, result);
    }
    least_squares_.scale_goals(1.0);
  }
}

double Search::long_way(const Robot& robot, const HullModel& hulls) {
  return std::clamp(thinnest_hull(robot, hulls), kThin, kLongWay);
}

double Search::way_from(const Eigen::VectorXd& from) {
  if (!levers_are_constant_) hull_levers(robot_, hulls_, from, q_, levers_);
  return levers_.dot((q_ - from).cwiseAbs());
}

double Search::room(const Result& verdict) const {
  return std::min(verdict.clearance - options_.clearance,
                  0.5 * (verdict.self_distance - options_.self_clearance));
}

bool Search::clear_on_the_way(const Following& step) {
  // Conservative advancement: nothing can be met before hulls have moved by their clearance. Where
  // there is none, the way may lead out or along, but no deeper.
  const double way = way_from(*step.from);
  double at = 0.0, floor = 0.0;
  while (true) {
    if (deadline_.passed()) return false;
    unsettled_ = *step.from + at * (q_ - *step.from);
    judge_answer(step.goals, unsettled_, probe_, step.look);
    const double left = room(probe_);
    if (at == 0.0) floor = std::min(0.0, left);
    if (left < floor - options_.clearance_tolerance) return false;
    if (at >= 1.0) return true;
    at = std::min(1.0, at + std::max(left - floor, kFinest * long_way_) / way);
  }
}

void Search::follow(const Following& step, Result& result) {
  begin(step.max_time, result);
  lower_ = *step.lower;
  upper_ = *step.upper;
  approach(step, step.margin, result);
  if (way_from(*step.from) > long_way_ && !clear_on_the_way(step)) {
    // Something is in between: no farther in this step than needs no looking.
    for (Eigen::Index i = 0; i < q_.size(); ++i) {
      const double most = long_way_ / (static_cast<double>(q_.size()) * levers_[i]);
      lower_[i] = std::max(lower_[i], (*step.from)[i] - most);
      upper_[i] = std::min(upper_[i], (*step.from)[i] + most);
    }
    q_ = *step.from;
    if (!deadline_.struck()) approach(step, long_way_, result);
  }
  // Half-way to a posture, with the time up, is no place to be if staying solves.
  const bool struck = deadline_.struck(), stays = struck && least_squares_.remembered_holds();
  if (stays) q_ = *step.from;
  judge_answer(step.goals, q_, result, step.look);
  if (!result.success && !struck && !deadline_.passed()) {
    // Nothing solves: better stay than go deeper into what a goal pulls at.
    saved_ = result;
    judge_answer(step.goals, *step.from, result, step.look);
    const double floor = std::min(0.0, room(result)) - options_.clearance_tolerance;
    if (!result.success && room(saved_) >= floor) restore(saved_, result);
  }
  result.status = result.success && !stays ? Status::Solved
                  : struck                 ? Status::TimeLimit
                                           : Status::Exhausted;
  end(result);
}

}  // namespace pdoik::detail
