#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "obstacles/collision_state.hpp"
#include "obstacles/shape_clearance.hpp"
#include "problem/constraint_family.hpp"

namespace pdoik::detail {

/// Hulls off shapes, each pair of a hull and a part of a shape by what of the hull is deepest: one
/// group per hull.
class ShapeConstraints : public ByPointGradients {
 public:
  /// The model outlives it.
  ShapeConstraints(const Robot& robot, const HullModel& model, double clearance)
      : capsules_(robot, model, model.moving, clearance) {}

  void allow(const AllowedContact* contact) { capsules_.allow(contact); }
  /// The clock that is looked at while shapes are looked at; null for none.
  void watch(const Deadline* deadline) { deadline_ = deadline; }
  /// Whether it struck before `find` had looked at all.
  bool was_cut() const { return was_cut_; }
  void use_none() { pairs_ = nullptr; }
  /// The shapes of what follows, which outlive it; hulls keep `margin` off them [m].
  void use(const ShapePairs& pairs, double margin) {
    pairs_ = pairs.parts() > 0 ? &pairs : nullptr;
    margin_ = margin;
  }
  /// Room for so many parts of shapes: called at set-up. Of more than kMost about one hull some are
  /// left to the judge.
  void reserve(int parts) {
    most_ = static_cast<std::size_t>(capsules_.count()) *
            static_cast<std::size_t>(std::min(parts, kMost));
    near_.reserve(most_);
  }

  std::size_t most() const { return near_.capacity(); }

  bool wants_points() const { return pairs_ != nullptr; }
  int groups() const { return capsules_.count(); }
  void place(const CollisionState& hulls) { capsules_.place(hulls.positions(), hulls.frames()); }
  /// Whether any hull touches a shape of these where the hulls are, or the clock has struck.
  bool any_touches(const ShapePairs& pairs, double margin, const CollisionState& hulls) {
    if (pairs.parts() == 0) return false;
    place(hulls);
    return any_nearer(capsules_, pairs, margin, deadline_);
  }

  /// Of one hull and a part of a shape, if less than `than`, where the hulls were placed.
  ShapeClearance clearance(const ShapePairs& pairs, int hull, int part, double than) {
    return hull_clearance(capsules_, hull, pairs, part, than);
  }

  /// Visit the parts of shapes that may be nearer than this to a hull, where the hulls were placed:
  /// see shapes_near.
  template <class Visit>
  void near(const ShapePairs& pairs, int hull, double than, Visit&& visit) const {
    shapes_near(capsules_, hull, pairs, than, visit);
  }

  template <class Reach>
  void find(const Rollout&, Reach&& reach) {
    near_.clear();
    was_cut_ = false;
    if (pairs_ == nullptr) return;
    int turn = 0;
    for (int k = 0; k < capsules_.count(); ++k) {
      const double within = margin_ + reach(k);
      const std::size_t first = near_.size();
      shapes_near(capsules_, k, *pairs_, within, [&](int part) {
        was_cut_ = passed_in(turn++, deadline_);
        if (was_cut_) return kNoMore;
        add_if_near(k, part, within, first);
        return within;
      });
      if (was_cut_) return;
      settle(first);
    }
  }
  int count() const { return static_cast<int>(near_.size()); }
  ConstraintKey key(int k) const { return constraint_key(at(k).hull, at(k).found.part); }

  struct Near {
    int hull;
    ShapeClearance found;
    bool on_surface, counts;
    double c;
    PointGradients gradients;
  };
  const Near& at(int k) const { return near_[static_cast<std::size_t>(k)]; }

 private:
  static constexpr int kMost = 64;

  /// @param first  Where those of the hull begin: of more than kMost the nearest stay.
  void add_if_near(int hull, int part, double within, std::size_t first) {
    const ShapeClearance found = hull_clearance(capsules_, hull, *pairs_, part, within);
    if (found.shape < 0) return;
    const bool on_surface = pairs_->part(part).is_surface();
    const auto place = near_.begin() + static_cast<std::ptrdiff_t>(first);
    if (near_.size() - first < static_cast<std::size_t>(kMost) && near_.size() < most_) {
      near_.push_back({hull, found, on_surface, true, 0.0, {}});
    } else if (place != near_.end()) {
      const auto farthest = std::max_element(place, near_.end(), [](const Near& a, const Near& b) {
        return a.found.distance < b.found.distance;
      });
      if (found.distance < farthest->found.distance)
        *farthest = {hull, found, on_surface, true, 0.0, {}};
    }
  }

  /// Say of a hull's what they ask for, in the order of their keys.
  void settle(std::size_t first) {
    const auto of_hull = near_.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::any_of(of_hull, near_.end(), [](const Near& near) { return near.on_surface; })) {
      for (auto one = of_hull; one != near_.end(); ++one) one->counts = counts(*one, first);
      near_.erase(
          std::remove_if(of_hull, near_.end(), [](const Near& near) { return !near.counts; }),
          near_.end());
    }
    for (auto one = of_hull; one != near_.end(); ++one) {
      ShapeClearance& found = one->found;
      if (found.by_piece) {
        one->c = margin_ - found.distance;
        capsules_.add_piece_gradient(one->hull, found.point, -found.gradient, one->gradients);
        continue;
      }
      if (is_behind(*one)) {  // deeper the farther it is from where it would come out
        found.distance -= 2.0 * found.gap;
        found.gradient = -found.gradient;
      }
      one->c = margin_ - found.distance;
      capsules_.add_gradient(one->hull, *found.capsule, found.t, -found.gradient, one->gradients);
    }
    std::sort(of_hull, near_.end(),
              [](const Near& a, const Near& b) { return a.found.part < b.found.part; });
  }

  static bool is_behind(const Near& near) {
    return near.on_surface && near.found.gap >= 0.0 && near.found.facing < 0.0;
  }

  /// Whether a constraint holds of a capsule that goes through the surface of the shape, or is
  /// behind it. Then the rest of the surface, which it would push inwards, says nothing.
  bool counts(const Near& one, std::size_t first) const {
    if (!one.on_surface || one.found.gap < 0.0) return true;
    const Near* nearest = &one;
    for (std::size_t k = first; k < near_.size(); ++k) {
      const Near& other = near_[k];
      if (other.found.shape != one.found.shape || other.found.capsule != one.found.capsule)
        continue;
      if (other.found.gap < 0.0) return false;
      if (!other.on_surface) continue;
      // Of parts that share the nearest edge the one that faces it most says which side it is on.
      const double margin = 1e-9;
      const double nearer = nearest->found.gap - other.found.gap;
      if (nearer > margin ||
          (nearer > -margin && std::abs(other.found.facing) > std::abs(nearest->found.facing)))
        nearest = &other;
    }
    return nearest == &one || nearest->found.facing >= 0.0;
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
