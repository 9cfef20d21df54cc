#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "detail/collision_state.hpp"
#include "detail/constraint_family.hpp"
#include "detail/shape_clearance.hpp"

namespace pdoik::detail {

/// Hulls off shapes, each pair of a hull and a shape by what of the hull is deepest: one group per
/// hull.
class ShapeConstraints : public ByPulls {
 public:
  /// The model outlives it.
  ShapeConstraints(const Robot& robot, const HullModel& model)
      : capsules_(robot, model, model.moving) {}

  void let_touch(const Touching* touching) { capsules_.let_touch(touching); }
  /// The clock that is looked at while shapes are looked at; null for none.
  void watch(const Deadline* deadline) { deadline_ = deadline; }
  /// Whether it struck before `find` had looked at all.
  bool was_cut() const { return was_cut_; }
  void use_none() { pairs_ = nullptr; }
  /// The shapes of what follows, which outlive it; hulls keep `margin` off them [m].
  void use(const ShapePairs& pairs, double margin) {
    pairs_ = pairs.count() > 0 ? &pairs : nullptr;
    margin_ = margin;
  }
  /// Room for so many shapes: called at set-up. Of more than kMost about one hull some are left to
  /// the judge.
  void reserve(int shapes) {
    most_ = static_cast<std::size_t>(capsules_.count()) *
            static_cast<std::size_t>(std::min(shapes, kMost));
    near_.reserve(most_);
  }

  std::size_t most() const { return near_.capacity(); }

  bool wants_points() const { return pairs_ != nullptr; }
  int groups() const { return capsules_.count(); }
  void place(const CollisionState& hulls) { capsules_.place(hulls.positions(), hulls.frames()); }
  /// Whether any hull touches a shape of these where the hulls are, or the clock has struck.
  bool any_touches(const ShapePairs& pairs, double margin, const CollisionState& hulls) {
    if (pairs.count() == 0) return false;
    place(hulls);
    return any_nearer(capsules_, pairs, margin, deadline_);
  }

  /// Of one hull and one shape, if less than `than`, where the hulls were placed.
  ShapeClearance clearance(const ShapePairs& pairs, int hull, int shape, double than) {
    return hull_clearance(capsules_, hull, pairs, shape, than);
  }

  template <class Reach>
  void find(const Rollout&, Reach&& reach) {
    near_.clear();
    was_cut_ = false;
    if (pairs_ == nullptr) return;
    int turn = 0;
    for (int k = 0; k < capsules_.count(); ++k) {
      const double within = margin_ + reach(k);
      const auto first = static_cast<std::ptrdiff_t>(near_.size());
      shapes_near(capsules_, k, *pairs_, within, [&](int shape) {
        was_cut_ = passed_in(turn++, deadline_);
        if (was_cut_) return kNoMore;
        add_if_near(k, shape, within);
        return within;
      });
      if (was_cut_) return;
      std::ranges::sort(near_.begin() + first, near_.end(), {}, &Near::shape);  // by keys
    }
  }
  int count() const { return static_cast<int>(near_.size()); }
  ConstraintKey key(int k) const { return constraint_key(at(k).hull, at(k).shape); }

  struct Near {
    int hull, shape;
    double c;
    Pulls pulls;
  };
  const Near& at(int k) const { return near_[static_cast<std::size_t>(k)]; }

 private:
  static constexpr int kMost = 64;

  void add_if_near(int hull, int shape, double within) {
    const ShapeClearance found = hull_clearance(capsules_, hull, *pairs_, shape, within);
    if (found.shape < 0 || near_.size() >= most_) return;
    Near& near = near_.emplace_back();
    near.hull = hull;
    near.shape = shape;
    near.c = margin_ - found.distance;
    capsules_.pull(hull, *found.capsule, found.t, -found.gradient, near.pulls);
  }

  HullCapsules capsules_;
  const ShapePairs* pairs_ = nullptr;
  const Deadline* deadline_ = nullptr;
  double margin_ = 0.0;
  bool was_cut_ = false;
  std::size_t most_ = std::numeric_limits<std::size_t>::max();
  std::vector<Near> near_;
};

}  // namespace pdoik::detail
