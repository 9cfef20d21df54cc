#include "track/gate.hpp"

#include <algorithm>
#include <cmath>

#include "hulls/travel.hpp"
#include "obstacles/placed_travel.hpp"

namespace pdoik::detail {
namespace {

constexpr double kLookShare = 0.4;  ///< share of the time that a way may take
constexpr double kBetter = 1e-6;    ///< relative decrease from which something is better
/// The same for going as far as a step may: a robot at full speed for a second, at 1 kHz, has to
/// make good a hundredth of what it falls short of, or it rests.
constexpr double kWorthMoving = 1e-5;
constexpr double kFarOff = 50.0;  ///< ways of a step: of what is farther off as much is asked
constexpr double kDistanceRounding = 1e-12;  ///< of a distance [m]

}  // namespace

Gate::Gate(Workspace& workspace)
    : workspace_(workspace),
      model_(workspace.model()),
      at_start_(model_.robot),
      hulls_at_start_(model_.hulls, model_.hulls.moving),
      finest_(finest_piece(model_.narrowest)),
      displacement_bounds_(model_.displacement_bounds) {
  asked_.reserve(kMostGoals);
  for (Eigen::VectorXd* each : {&incumbent_.q, &candidate_.q, &probe_.q, &aim_, &trial_, &next_,
                                &rest_, &at_, &way_, &all_bounds_})
    each->setZero(model_.robot.dof());
}

void Gate::judge(const Eigen::VectorXd& q, Result& result) {
  workspace_.judge(step_->goals, q, result, step_->look);
}

Gate::Room Gate::room(const Result& verdict) {
  return {verdict.room, verdict.self_room, -verdict.balance_violation, stance_at(verdict.q)};
}

double Gate::stance_at(const Eigen::VectorXd& q) {
  if (!stands_) return 0.0;
  workspace_.least_squares.place(q);
  double off = 0.0;
  for (GoalTerm& goal : asked_) {
    if (!goal.stands()) continue;
    goal.place(workspace_.problem.rollout);
    off = std::max(
        {off, goal.position_distance(), model_.options.rotation_weight * goal.rotation_distance()});
  }
  return -off;
}

bool Gate::is_deeper(const Room& room, double stance) {
  if (floor_.obstacles - room.obstacles > kDistanceRounding ||
      floor_.self - room.self > kDistanceRounding ||
      floor_.balance - room.balance > kDistanceRounding)
    return true;
  return gives_way_ = stance - room.stance > kDistanceRounding;
}

Gate::Worth Gate::worth_at(const Eigen::VectorXd& q) {
  workspace_.least_squares.place(q);
  const Options& options = model_.options;
  const double w2 = options.rotation_weight * options.rotation_weight;
  PosturePull pull;
  pull.set(step_->posture, step_->weights);
  Worth worth{0.0, pull.value(q), true};
  for (GoalTerm& goal : asked_) {
    goal.place(workspace_.problem.rollout);
    const double p = goal.position_distance(), r = goal.rotation_distance();
    worth.shortfall += 0.5 * goal.weight() * (p * p + w2 * r * r);
    worth.reached &= goal.allows(p * p, r * r);
  }
  return worth;
}

const Eigen::VectorXd& Gate::levers_to(const Eigen::VectorXd& q) {
  const Eigen::VectorXd& from = *step_->from;
  if (!model_.displacement_bounds.allFinite())
    hull_displacement_bounds(model_.robot, model_.hulls, from, q, displacement_bounds_);
  const Attachments& attached = workspace_.scene().attachments();
  if (attached.count() == 0) return displacement_bounds_;
  hull_displacement_bounds(model_.robot, attached.balls(), from, q, all_bounds_);
  all_bounds_ = all_bounds_.cwiseMax(displacement_bounds_);
  return all_bounds_;
}

double Gate::way_to(const Eigen::VectorXd& q) {
  return levers_to(q).dot((q - *step_->from).cwiseAbs());
}

double Gate::tight_way_to(const Eigen::VectorXd& q) {
  if (!is_placed_) {
    workspace_.least_squares.place(*step_->from);
    at_start_ = workspace_.problem.rollout;
    hulls_at_start_.place(at_start_);
    is_placed_ = true;
  }
  way_ = (q - *step_->from).cwiseAbs();
  double farthest = 0.0;
  for (const Hull& hull : model_.hulls.moving)
    farthest = std::max(farthest, travel_from(at_start_, hulls_at_start_, hull, way_));
  if (const Attachments& attached = workspace_.scene().attachments(); attached.count() > 0) {
    hull_displacement_bounds(model_.robot, attached.balls(), *step_->from, q, all_bounds_);
    farthest = std::max(farthest, all_bounds_.dot(way_));
  }
  return farthest;
}

void Gate::open(const StepRequest& step) {
  step_ = &step;
  is_placed_ = false;
  probe_.late_evaluations = incumbent_.late_evaluations = candidate_.late_evaluations = 0;
  asked_.clear();
  stands_ = false;
  for (const Goal& goal : step.goals) {
    if (goal.type == GoalType::CenterOfMass) continue;  // which is kept as balance is
    asked_.emplace_back(model_.robot, model_.options, goal);
    stands_ |= goal.stands;
  }
  judge(*step.from, incumbent_);
  held_ = room_ = room(incumbent_);
  floor_ = {std::min(0.0, held_.obstacles), std::min(0.0, held_.self), std::min(0.0, held_.balance),
            std::min(-kGraze, held_.stance)};
  // What stands is off by twice as much on its way, since joints that go straight bend it.
  stance_between_ = std::min(-2.0 * kGraze, floor_.stance);
  aim_ = *step.from;
  took_ = false;
  if (step.braking->moves()) {
    step.braking->gentlest(*step.from, trial_);
    step.braking->place(*step.from, trial_, next_, rest_);
    judge(next_, candidate_);
    const Room there = room(candidate_);
    if (!is_deeper(there, floor_.stance) && is_clear_to_end(there)) {
      std::swap(incumbent_, candidate_);
      aim_ = trial_;
      room_ = there;
    }
  }
  worth_ = worth_at(aim_);
}

bool Gate::is_better(const Worth& worth, const Eigen::VectorXd& q) const {
  if (worth.reached != worth_.reached) return worth.reached;
  const double share = kBetter + kWorthMoving * share_of_box(q);
  if (worth.reached) return worth.pull < (1.0 - share) * worth_.pull;
  // What is far off may be out of reach, and most of what is left with it.
  const double far = kFarOff * step_->advance * std::sqrt(2.0 * worth_.shortfall);
  return worth.shortfall < worth_.shortfall - share * std::min(worth_.shortfall, far);
}

double Gate::share_of_box(const Eigen::VectorXd& q) const {
  double most = 0.0;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double way = q[i] - (*step_->from)[i];
    const double room =
        way > 0.0 ? (*step_->upper)[i] - (*step_->from)[i] : (*step_->from)[i] - (*step_->lower)[i];
    if (way != 0.0 && room > 0.0) most = std::max(most, std::abs(way) / room);
  }
  return most;
}

bool Gate::is_clear_by_ends(double length, const Room& one, const Room& other) const {
  // Distances change no faster than hulls move but for those by fields, of two hulls no faster than
  // both: what they are at both ends may be enough.
  const auto is_enough = [&](double here, double there, double floor, double speed) {
    return (here - floor) + (there - floor) >= speed * length;
  };
  return length <= finest_ || (is_enough(one.obstacles, other.obstacles, floor_.obstacles,
                                         workspace_.scene().shapes().steepest()) &&
                               is_enough(one.self, other.self, floor_.self, 2.0));
}

template <class At>
bool Gate::is_clear_between(const At& at, double way, double first, double last, const Room& one,
                            const Room& other) {
  // If they are not, the middle is looked at, and both halves.
  if (is_clear_by_ends((last - first) * way, one, other)) return true;
  if (workspace_.problem.deadline->passed()) return false;
  const double middle = 0.5 * (first + last);
  at(middle);
  judge(at_, probe_);
  const Room there = room(probe_);
  return !is_deeper(there, stance_between_) &&
         is_clear_between(at, way, first, middle, one, there) &&
         is_clear_between(at, way, middle, last, there, other);
}

bool Gate::is_clear_to_end(const Room& end) {
  const Eigen::VectorXd& from = *step_->from;
  if (is_clear_by_ends(way_to(next_), held_, end)) return true;
  return is_clear_between([&](double share) { at_ = from + share * (next_ - from); },
                          tight_way_to(next_), 0.0, 1.0, held_, end);
}

bool Gate::is_clear_to_rest(const Room& end, const Room& rest) {
  Braking& braking = *step_->braking;
  if (!braking.limited()) return true;
  const double way = braking.brake(*step_->from, next_, levers_to(rest_));
  return is_clear_between([&](double share) { braking.between(share, at_); }, way, 0.0, 1.0, end,
                          rest);
}

double Gate::share_in_time(const Eigen::VectorXd& q) {
  const double room =
      std::min(held_.obstacles / workspace_.scene().shapes().steepest(), 0.5 * held_.self);
  const double looked_at = std::max(kLookShare * workspace_.verdicts_left(), 1.0) * finest_;
  const double may = std::max(room, looked_at);
  return way_to(q) <= may ? 1.0 : std::min(1.0, may / tight_way_to(q));
}

bool Gate::consider(const Eigen::VectorXd& q, double share) {
  const Eigen::VectorXd& from = *step_->from;
  missed_ = 0.0;
  gives_way_ = false;
  trial_ = (from + share * (q - from)).cwiseMax(*step_->lower).cwiseMin(*step_->upper);
  const Worth worth = worth_at(trial_);
  if (clear() && !is_better(worth, trial_)) return false;
  step_->braking->place(from, trial_, next_, rest_);
  judge(next_, candidate_);
  const Room end = room(candidate_);
  Room rest = end;
  if (step_->braking->limited()) {
    judge(rest_, probe_);
    rest = room(probe_);
  }
  const double least = std::min(end.least(), rest.least());
  missed_ = least < -kDistanceRounding ? -least : 0.0;
  if (is_deeper(end, floor_.stance) || is_deeper(rest, floor_.stance)) return false;
  // First of all out of what it is in, and not back.
  if (rest.least() <
      std::min(room_.least() + kDistanceRounding, -model_.options.clearance_tolerance))
    return false;
  if (!is_clear_to_end(end) || !is_clear_to_rest(end, rest)) return false;
  std::swap(incumbent_, candidate_);
  aim_ = trial_;
  took_ = true;
  room_ = rest;
  worth_ = worth;
  return true;
}

}  // namespace pdoik::detail
