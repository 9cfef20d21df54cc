#pragma once

#include "detail/collision_state.hpp"
#include "detail/constraint.hpp"
#include "detail/constraint_family.hpp"

namespace pdoik::detail {

/// Hulls off obstacles: one group per hull.
class ObstacleConstraints {
 public:
  /// What c is.
  enum class Form {
    Paper,     ///< Eqs. joint_coll_avoid and link_coll_avoid
    HalfSum,   ///< half_sum_constraint
    Distance,  ///< distance_constraint
  };

  /// The hulls outlive it.
  explicit ObstacleConstraints(CollisionState& hulls) : hulls_(hulls) {}

  void use_none() { obstacles_ = none_; }
  /// The obstacles of what follows, which outlive it.
  void use(const ObstacleView& obstacles, Form form) {
    obstacles_ = obstacles;
    form_ = form;
  }

  bool wants_points() const { return obstacles_->count() > 0; }
  int groups() const { return static_cast<int>(hulls_.hulls().size()); }

  template <class Reach>
  void find(const Rollout&, Reach&& reach) {
    hulls_.find_near(obstacles_, [&](std::size_t hull) { return reach(static_cast<int>(hull)); });
  }
  int count() const { return hulls_.near_count(); }
  ConstraintKey key(int k) const {
    return constraint_key(hulls_.near(k).hull, hulls_.near(k).obstacle);
  }

  struct At : Constraint {
    const Hull* hull;
  };
  PDOIK_INLINE At at(int k) const {  // so that nobody computes the derivatives who asks for c alone
    const NearPair& pair = hulls_.near(k);
    const Hull& hull = hulls_.hull(pair);
    const Vec4 o = obstacles_[pair.obstacle];
    if (form_ == Form::Paper) return {paper_constraint(hulls_, hull, o), &hull};
    if (form_ == Form::HalfSum && o[3] >= 0.0) return {half_sum_constraint(hulls_, hull, o), &hull};
    return {distance_constraint(hulls_, hull, o), &hull};
  }
  void add_row(const At& at, const Rollout& rollout, double* row) const {
    for_each_point(at, [&](int point, const Vec4& direction) {
      rollout.add_row(hulls_.body_of_point(point), direction,
                      cross3(hulls_.position(point), direction), row);
    });
  }
  void add_wrenches(const At& at, double slope, Rollout& rollout) const {
    for_each_point(at, [&](int point, const Vec4& direction) {
      rollout.add_force(hulls_.body_of_point(point), hulls_.position(point),
                        broadcast(slope) * direction);
    });
  }

 private:
  template <class Visit>
  static void for_each_point(const At& at, Visit&& visit) {
    visit(at.hull->a, at.dc_da);
    if (!at.hull->is_sphere()) visit(at.hull->b, at.dc_db);
  }

  CollisionState& hulls_;
  ObstacleSet none_;
  ObstacleView obstacles_{none_};
  Form form_ = Form::Distance;
};

}  // namespace pdoik::detail
