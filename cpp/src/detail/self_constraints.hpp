#pragma once

#include <optional>

#include "detail/collision_state.hpp"
#include "detail/constraint_family.hpp"
#include "detail/model.hpp"
#include "detail/self_collision.hpp"

namespace pdoik::detail {

/// The robot's hulls off one another, if that is asked for: each pair a group of its own.
class SelfConstraints {
 public:
  /// The hulls outlive it.
  SelfConstraints(const Model& model, const CollisionState& hulls) : hulls_(hulls) {
    if (model.options.self_collision)
      self_.emplace(model.robot, HullModel(model.robot), model.options.self_clearance);
  }

  bool wants_points() const { return self_.has_value(); }
  int groups() const { return self_ ? self_->pair_count() : 0; }

  template <class Reach>
  void find(const Rollout&, Reach&& reach) {
    if (!self_) return;
    self_->place(hulls_.positions());
    self_->find_near(reach);
  }
  int count() const { return self_ ? self_->near_count() : 0; }
  ConstraintKey key(int k) const { return constraint_key(at(k).pair, 0); }
  const SelfCollision::Near& at(int k) const { return self_->near(k); }

  void add_row(const SelfCollision::Near& at, const Rollout& rollout, double* row) const {
    for_each_point(at, [&](int point, const Vec4& direction) {
      rollout.add_row(hulls_.body_of_point(point), direction,
                      cross3(hulls_.position(point), direction), row);
    });
  }
  void add_wrenches(const SelfCollision::Near& at, double slope, Rollout& rollout) const {
    for_each_point(at, [&](int point, const Vec4& direction) {
      rollout.add_force(hulls_.body_of_point(point), hulls_.position(point),
                        broadcast(slope) * direction);
    });
  }

 private:
  template <class Visit>
  static void for_each_point(const SelfCollision::Near& at, Visit&& visit) {
    for (int k = 0; k < 4; ++k)
      if (at.point[k] >= 0) visit(at.point[k], at.dc_dpoint[k]);
  }

  const CollisionState& hulls_;
  std::optional<SelfCollision> self_;
};

}  // namespace pdoik::detail
