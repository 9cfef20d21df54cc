#pragma once

#include "obstacles/collision_state.hpp"
#include "obstacles/constraint.hpp"
#include "problem/constraint_family.hpp"

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
    hulls_.find_near(
        obstacles_, [&](std::size_t hull) { return reach(static_cast<int>(hull)); },
        [&](const Hull& hull) {
          return form_ == Form::Distance || (form_ == Form::HalfSum && hull.has_capsules());
        });
  }
  int count() const { return hulls_.near_count(); }
  ConstraintKey key(int k) const {
    return constraint_key(hulls_.near(k).hull, hulls_.near(k).obstacle);
  }

  /// Not less than how deep the two are in each other, and soon known where many of a hull are
  /// asked for one after the other.
  double most(int k) {
    const NearPair& pair = hulls_.near(k);
    const Hull& hull = hulls_.hull(pair);
    const Vec4 o = obstacles_.of(hull.source, pair.obstacle);
    // Of what may lie inside, distances are no bound.
    if (o[3] < 0.0 && !hull.has_capsules()) return distance_constraint(hulls_, hull, o).c;
    const int block = pair.obstacle / kLanes;
    if (k == 0 || pair.hull != bounded_.hull || block != bounded_.block) {
      const bool alone = k + 1 >= count() || hulls_.near(k + 1).hull != pair.hull ||
                         hulls_.near(k + 1).obstacle / kLanes != block;
      bounded_ = {pair.hull, block};
      bounded_.is_known =
          !alone && hulls_.bound_distances(static_cast<std::size_t>(pair.hull), obstacles_,
                                           block * kLanes, bounded_.distances);
    }
    if (bounded_.is_known) {
      return obstacles_.margin_of(hull.source) -
             static_cast<double>(bounded_.distances[pair.obstacle % kLanes]);
    }
    if (hull.has_capsules()) return capsule_violation(hulls_, hull, o);
    return o[3] - half_sum_gap(hull, hulls_.position(hull.a), hulls_.position(hull.b), o);
  }
  /// By the hull's foci, or if it counts by its capsules by dc_da of a point a of their body.
  struct At : Constraint {
    const Hull* hull;
    bool by_capsules = false;
    Vec4 a{};
  };
  PDOIK_INLINE At at(int k) const {  // so that nobody computes the derivatives who asks for c alone
    const NearPair& pair = hulls_.near(k);
    const Hull& hull = hulls_.hull(pair);
    const Vec4 o = obstacles_.of(hull.source, pair.obstacle);
    if (form_ == Form::Paper) return {paper_constraint(hulls_, hull, o), &hull};
    if (hull.has_capsules()) {
      const CapsuleConstraint found = capsule_constraint(hulls_, hull, o);
      return {{found.c, found.dc_dp, Vec4{}}, &hull, true, found.p};
    }
    if (form_ == Form::HalfSum && o[3] >= 0.0) return {half_sum_constraint(hulls_, hull, o), &hull};
    return {distance_constraint(hulls_, hull, o), &hull};
  }
  void add_row(const At& at, const Rollout& rollout, double* row) const {
    for_each_point(at, [&](int body, const Vec4& point, const Vec4& direction) {
      rollout.add_row(body, direction, cross3(point, direction), row);
    });
  }
  void add_wrenches(const At& at, double slope, Rollout& rollout) const {
    for_each_point(at, [&](int body, const Vec4& point, const Vec4& direction) {
      rollout.add_force(body, point, broadcast(slope) * direction);
    });
  }

 private:
  template <class Visit>
  void for_each_point(const At& at, Visit&& visit) const {
    if (at.by_capsules) {
      visit(at.hull->body, at.a, at.dc_da);
      return;
    }
    visit(hulls_.body_of_point(at.hull->a), hulls_.position(at.hull->a), at.dc_da);
    if (!at.hull->is_sphere())
      visit(hulls_.body_of_point(at.hull->b), hulls_.position(at.hull->b), at.dc_db);
  }

  /// Obstacles whose distances from a hull are bounded.
  struct Bounded {
    int hull = -1, block = -1;
    bool is_known = false;
    float distances[kLanes] = {};
  };

  CollisionState& hulls_;
  Bounded bounded_;
  ObstacleSet none_;
  ObstacleView obstacles_{none_};
  Form form_ = Form::Distance;
};

}  // namespace pdoik::detail
