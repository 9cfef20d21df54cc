#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "detail/collision.hpp"
#include "detail/constraint.hpp"
#include "detail/deadline.hpp"
#include "detail/goal_term.hpp"
#include "detail/own_constraints.hpp"
#include "detail/rollout.hpp"
#include "detail/scene.hpp"
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
        scene_(&scene),
        point_distance_(point_distance),
        state_(map.make_state()),
        grow_(collision.hulls().size(), 0.0),
        own_multiplier_(static_cast<std::size_t>(own.slots()), 0.0) {
    dq_.setZero(dof);
    own_fresh_.reserve(own_multiplier_.size());
  }

  /// Room for the multipliers among this many obstacles: called at set-up by who minimises.
  void reserve(int padded_obstacles) {
    const std::size_t pairs = grow_.size() * static_cast<std::size_t>(padded_obstacles);
    const std::size_t most = std::min(pairs, CollisionState::kMostPairs);
    multipliers_.reserve(most);
    fresh_.reserve(most);
  }
  /// The scene of the evaluations that follow; it outlives them. Forgets the multipliers.
  void use(const Scene& scene) {
    scene_ = &scene;
    reset_multipliers();
  }
  /// Evaluations look at this now and then from now on, and are cut short once it has struck: who
  /// asks for them must not use what they give. It outlives them; null for none.
  void watch(const Deadline* deadline) { deadline_ = deadline; }

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
    Multipliers::const_iterator at = multipliers_.begin();
    for (int k = 0; k < collision_.near_count() && !is_cut(k); ++k) {
      const NearPair& pair = collision_.near(k);
      value += add_constraint(pair, penalty, multiplier(pair, at));
    }
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
    collision_.find_near(scene_->obstacles(), [](std::size_t) { return 0.0; });
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
    multipliers_.clear();
    std::fill(grow_.begin(), grow_.end(), 0.0);
    std::fill(own_multiplier_.begin(), own_multiplier_.end(), 0.0);
  }

  void update_multipliers(const Eigen::VectorXd& omega, const Penalty& penalty) {
    roll_out(omega);
    find_near(penalty);
    own_fresh_.clear();
    for (const OwnConstraints::Active& active : own_.active())
      own_fresh_.push_back(penalty.updated_multiplier(active.c, own_multiplier(active)));
    // Both lists are ordered as near pairs come. The printed update never lowers a multiplier: it
    // keeps those of pairs that are not near. The smooth one has none left of these.
    const bool keep = penalty.form == PenaltyForm::Printed;
    fresh_.clear();
    const auto add = [&](const Multiplier& m) {
      if (m.mu > 0.0 && fresh_.size() < fresh_.capacity()) fresh_.push_back(m);
    };
    Multipliers::const_iterator at = multipliers_.begin();
    for (int k = 0; k < collision_.near_count(); ++k) {
      const NearPair& pair = collision_.near(k);
      for (; at != multipliers_.end() && at->slot < slot(pair); ++at)
        if (keep) add(*at);
      const double mu = multiplier(pair, at);
      if (at != multipliers_.end() && at->slot == slot(pair)) ++at;
      add({slot(pair), penalty.updated_multiplier(constraint(pair).c, mu)});
    }
    for (; keep && at != multipliers_.end(); ++at) add(*at);
    multipliers_.swap(fresh_);
    if (!keep) std::fill(own_multiplier_.begin(), own_multiplier_.end(), 0.0);
    for (std::size_t k = 0; k < own_fresh_.size(); ++k)
      own_multiplier(own_.active()[k]) = own_fresh_[k];
    std::fill(grow_.begin(), grow_.end(), 0.0);
    for (const Multiplier& m : multipliers_) {
      double& grow = grow_[static_cast<std::size_t>(m.slot >> 32U)];
      grow = std::max(grow, m.mu);
    }
  }

  /// At the last evaluation: the largest constraint, at least 0, and the goals' errors.
  double last_max_constraint() const { return max_constraint_; }

 private:
  /// Of a pair of hull and obstacle; all others' are zero.
  struct Multiplier {
    std::uint64_t slot;
    double mu;
  };
  using Multipliers = std::vector<Multiplier>;

  static std::uint64_t slot(const NearPair& pair) {
    return static_cast<std::uint64_t>(pair.hull) << 32U | static_cast<std::uint32_t>(pair.obstacle);
  }
  /// A pair's multiplier, where `at` walks through them as pairs are asked in order.
  double multiplier(const NearPair& pair, Multipliers::const_iterator& at) const {
    while (at != multipliers_.end() && at->slot < slot(pair)) ++at;
    return at != multipliers_.end() && at->slot == slot(pair) ? at->mu : 0.0;
  }
  /// Asked for each near pair.
  bool is_cut(int pair) const { return passed_in(pair, deadline_); }

  void roll_out(const Eigen::VectorXd& omega) {
    map_.forward(omega, state_, rollout_.needs_angles());
    rollout_.forward(state_.cosine.data(), state_.sine.data(), state_.q.data());
    for (GoalTerm& goal : goals_) goal.place(rollout_.frame(goal.body()));
  }

  /// Pairs whose penalty acts. In the smooth form those reach mu / rho beyond contact; grow_ holds
  /// each hull's largest multiplier.
  void find_near(const Penalty& penalty) {
    if (scene_->within_reach() > 0 || own_.any_self()) collision_.place(rollout_);
    collision_.find_near(scene_->obstacles(),
                         [&](std::size_t h) { return penalty.reach(grow_[h]); });
    if (!own_.any()) return;
    own_.find(rollout_, collision_, [&](int slot) {
      return penalty.reach(own_multiplier_[static_cast<std::size_t>(slot)]);
    });
  }

  double& own_multiplier(const OwnConstraints::Active& active) {
    return own_multiplier_[static_cast<std::size_t>(active.slot)];
  }

  Constraint constraint(const NearPair& pair) const {
    return paper_constraint(collision_, collision_.hull(pair), scene_->obstacles()[pair.obstacle]);
  }

  double add_constraint(const NearPair& pair, const Penalty& penalty, double mu) {
    const Constraint at = constraint(pair);
    max_constraint_ = std::max(max_constraint_, at.c);
    const Penalty::Term term = penalty.term(at.c, mu);
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
  const Scene* scene_;
  const Deadline* deadline_ = nullptr;
  double point_distance_;
  JointLimitMap::State state_;
  Eigen::VectorXd dq_;
  std::vector<double> grow_;
  Multipliers multipliers_, fresh_;  ///< by slot
  std::vector<double> own_multiplier_, own_fresh_;
  double max_constraint_ = 0.0;
};

}  // namespace pdoik::detail
