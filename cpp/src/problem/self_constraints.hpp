#pragma once

#include <cstdint>
#include <optional>

#include "hulls/self_collision.hpp"
#include "obstacles/collision_state.hpp"
#include "problem/constraint_family.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// The robot's hulls off one another, if that is asked for: each pair a group of its own.
class SelfConstraints : public ByPointGradients {
 public:
  /// The hulls outlive it.
  SelfConstraints(const Model& model, const CollisionState& hulls) : model_(model), hulls_(hulls) {
    use(PairMargins(model.robot));
  }
  /// The margins of its pairs from now on. Allocates.
  void use(const PairMargins& margins) {
    if (model_.options.keeps_off_itself(model_.robot))
      self_.emplace(model_.robot, model_.whole, model_.options.self_clearance, margins);
  }

  bool wants_points() const { return self_.has_value(); }
  int groups() const { return self_ ? self_->pair_count() : 0; }

  template <class Reach>
  void find(const Rollout&, Reach&& reach) {
    if (!self_) return;
    self_->place(hulls_.positions(), hulls_.frames());
    self_->find_near(reach);
  }
  /// Whether any is violated where the hulls are placed.
  bool any_touches() {
    if (!self_) return false;
    self_->place(hulls_.positions(), hulls_.frames());
    return self_->any_touches();
  }
  /// How many pairs of links' pieces have been looked at.
  std::int64_t looks() const { return self_ ? self_->looks() : 0; }
  int count() const { return self_ ? self_->near_count() : 0; }
  ConstraintKey key(int k) const { return constraint_key(at(k).pair, 0); }
  const SelfCollision::Near& at(int k) const { return self_->near(k); }

 private:
  const Model& model_;
  const CollisionState& hulls_;
  std::optional<SelfCollision> self_;
};

}  // namespace pdoik::detail
