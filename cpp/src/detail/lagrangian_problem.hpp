#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "detail/collision.hpp"
#include "detail/constraint.hpp"
#include "detail/goal_term.hpp"
#include "detail/own_constraints.hpp"
#include "detail/rollout.hpp"
#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/joint_limit_map.hpp"

namespace pdoik::detail {

/// Eq. AL over the slack variables omega: what AugmentedLagrangian minimises (Algorithms FWD and
/// Jacobian).
class LagrangianProblem {
 public:
  LagrangianProblem(const JointLimitMap& map, Rollout& rollout, std::vector<GoalTerm>& goals,
                    CollisionState& collision, OwnConstraints& own, const Scene& scene,
                    double point_distance, int dof)
      : map_(map),
        rollout_(rollout),
        goals_(goals),
        collision_(collision),
        own_(own),
        scene_(scene),
        point_distance_(point_distance),
        state_(map.make_state()),
        grow_(collision.hulls().size(), 0.0),
        own_multiplier_(static_cast<std::size_t>(own.slots()), 0.0) {
    dq_.setZero(dof);
    own_fresh_.reserve(own_multiplier_.size());
  }

  /// Multipliers for every pair of hull and obstacle: called at set-up.
  void reserve(int padded_obstacles) {
    const std::size_t pairs = grow_.size() * static_cast<std::size_t>(padded_obstacles);
    if (multiplier_.size() >= pairs) return;
    multiplier_.assign(pairs, 0.0);
    touched_.clear();
    touched_.reserve(pairs);
    fresh_.reserve(pairs);
  }

  double lagrangian(const Eigen::VectorXd& omega, const Penalty& penalty,
                    Eigen::VectorXd& gradient) {
    roll_out(omega);
    rollout_.clear_wrenches();
    double value = 0.0;
    for (const GoalTerm& goal : goals_) {
      Vec4 force, moment;
      value += goal.point_objective(point_distance_, force, moment);
      rollout_.add_wrench(goal.body(), force, moment);
    }
    max_constraint_ = 0.0;
    find_near(penalty);
    for (int k = 0; k < collision_.near_count(); ++k)
      value += add_constraint(collision_.near(k), penalty);
    for (const OwnConstraints::Active& active : own_.active()) {
      max_constraint_ = std::max(max_constraint_, active.c);
      const Penalty::Term term = penalty.term(active.c, own_multiplier(active));
      value += term.value;
      if (term.slope != 0.0) own_.add_wrenches(active, term.slope, collision_, rollout_);
    }
    rollout_.reverse(dq_.data(), static_cast<int>(dq_.size()));
    map_.pull_back(state_, dq_, gradient);
    return value;
  }

  double max_constraint(const Eigen::VectorXd& omega) {
    roll_out(omega);
    collision_.place(rollout_);
    collision_.find_near(scene_.near, [](std::size_t) { return 0.0; });
    if (own_.any()) own_.find(rollout_, collision_, [](int) { return 0.0; });
    max_constraint_ = 0.0;
    for (const OwnConstraints::Active& active : own_.active())
      max_constraint_ = std::max(max_constraint_, active.c);
    for (int k = 0; k < collision_.near_count(); ++k) {
      max_constraint_ = std::max(max_constraint_, constraint(collision_.near(k)).c);
    }
    return max_constraint_;
  }

  void reset_multipliers() {
    for (const std::size_t at : touched_) multiplier_[at] = 0.0;
    touched_.clear();
    std::fill(grow_.begin(), grow_.end(), 0.0);
    std::fill(own_multiplier_.begin(), own_multiplier_.end(), 0.0);
  }

  void update_multipliers(const Eigen::VectorXd& omega, const Penalty& penalty) {
    roll_out(omega);
    find_near(penalty);
    own_fresh_.clear();
    for (const OwnConstraints::Active& active : own_.active())
      own_fresh_.push_back(penalty.updated_multiplier(active.c, own_multiplier(active)));
    fresh_.clear();
    for (int k = 0; k < collision_.near_count(); ++k) {
      const NearPair& pair = collision_.near(k);
      fresh_.push_back(penalty.updated_multiplier(constraint(pair).c, multiplier_[slot(pair)]));
    }
    if (penalty.form == PenaltyForm::Smooth)
      reset_multipliers();  // the printed update never lowers one
    for (std::size_t k = 0; k < own_fresh_.size(); ++k)
      own_multiplier(own_.active()[k]) = own_fresh_[k];
    for (int k = 0; k < collision_.near_count(); ++k) {
      const double mu = fresh_[static_cast<std::size_t>(k)];
      if (mu <= 0.0) continue;
      const NearPair& pair = collision_.near(k);
      if (multiplier_[slot(pair)] == 0.0) touched_.push_back(slot(pair));
      multiplier_[slot(pair)] = mu;
      double& grow = grow_[static_cast<std::size_t>(pair.hull)];
      grow = std::max(grow, mu);
    }
  }

  /// At the last evaluation: the largest constraint, at least 0, and the goals' errors.
  double last_max_constraint() const { return max_constraint_; }

 private:
  std::size_t slot(const NearPair& pair) const {
    return static_cast<std::size_t>(pair.hull) * static_cast<std::size_t>(scene_.near.padded()) +
           static_cast<std::size_t>(pair.obstacle);
  }

  void roll_out(const Eigen::VectorXd& omega) {
    map_.forward(omega, state_, rollout_.needs_angles());
    rollout_.forward(state_.cosine.data(), state_.sine.data(), state_.q.data());
    for (GoalTerm& goal : goals_) goal.place(rollout_.frame(goal.body()));
  }

  /// Pairs whose penalty acts. In the smooth form those reach mu / rho beyond contact; grow_ holds
  /// each hull's largest multiplier.
  void find_near(const Penalty& penalty) {
    if (scene_.near.count() > 0 || own_.any_self()) collision_.place(rollout_);
    collision_.find_near(scene_.near, [&](std::size_t h) { return penalty.reach(grow_[h]); });
    if (!own_.any()) return;
    own_.find(rollout_, collision_, [&](int slot) {
      return penalty.reach(own_multiplier_[static_cast<std::size_t>(slot)]);
    });
  }

  double& own_multiplier(const OwnConstraints::Active& active) {
    return own_multiplier_[static_cast<std::size_t>(active.slot)];
  }

  Constraint constraint(const NearPair& pair) const {
    return paper_constraint(collision_, collision_.hull(pair), scene_.near[pair.obstacle]);
  }

  double add_constraint(const NearPair& pair, const Penalty& penalty) {
    const Constraint at = constraint(pair);
    max_constraint_ = std::max(max_constraint_, at.c);
    const Penalty::Term term = penalty.term(at.c, multiplier_[slot(pair)]);
    if (term.slope == 0.0) return 0.0;
    const Hull& hull = collision_.hull(pair);
    push(hull.a, at.dc_da, term.slope);
    if (!hull.is_sphere()) push(hull.b, at.dc_db, term.slope);
    return term.value;
  }

  void push(int point, const Vec4& direction, double slope) {
    rollout_.add_force(collision_.body_of_point(point), collision_.position(point),
                       broadcast(slope) * direction);
  }

  const JointLimitMap& map_;
  Rollout& rollout_;
  std::vector<GoalTerm>& goals_;
  CollisionState& collision_;
  OwnConstraints& own_;
  const Scene& scene_;
  double point_distance_;
  JointLimitMap::State state_;
  Eigen::VectorXd dq_;
  std::vector<double> grow_;
  std::vector<double> multiplier_, fresh_;
  std::vector<double> own_multiplier_, own_fresh_;
  std::vector<std::size_t> touched_;
  double max_constraint_ = 0.0;
};

}  // namespace pdoik::detail
