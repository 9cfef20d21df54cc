#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "common/deadline.hpp"
#include "hulls/hull_capsules.hpp"
#include "hulls/pair_margins.hpp"
#include "shapes/shape_set.hpp"

namespace pdoik::detail {

/// A scene's shapes as one robot's hulls see them: how near each pair may come. Distances count as
/// if all pairs had to keep the options' clearance: those of a pair with another one are given as
/// less by what that is more.
class ShapePairs {
 public:
  ShapePairs() : set_(no_shapes()) {}
  ShapePairs(std::shared_ptr<const ShapeSet> set, const Robot& robot, const PairMargins& margins);

  int count() const { return static_cast<int>(set_->shapes.size()); }
  const Shape& shape(int k) const { return set_->shapes[static_cast<std::size_t>(k)]; }
  /// Shapes are made of parts, all numbered on from shape to shape.
  int parts() const { return static_cast<int>(set_->parts.size()); }
  const Solid& part(int k) const { return set_->parts[static_cast<std::size_t>(k)]; }
  /// Whether any part is one of a surface.
  bool has_surfaces() const { return set_->has_surfaces; }
  /// What distances change by at most as a hull moves, per length: 1 but of fields.
  double steepest() const { return set_->steepest; }
  /// The shape that a part belongs to.
  int owner(int part) const { return set_->owners[static_cast<std::size_t>(part)]; }
  /// By how much farther than the options say a hull has to keep off a shape; minus infinity if
  /// contact does not count [m].
  /// @param source  A hull's or capsule's place in the occupancy.
  double margin(int source, int shape) const {
    return margins_.empty() ? 0.0 : margins_[static_cast<std::size_t>(source * count() + shape)];
  }
  /// The most of any pair, and at least 0: how much farther than others some look [m].
  double most_margin() const { return most_margin_; }
  /// Visit parts: see ShapeTree::near.
  template <class Visit>
  void near(const Vec4& middle, const Vec4& half, double reach, Visit&& visit) const {
    set_->tree.near(middle, half, reach, visit);
  }
  const std::shared_ptr<const ShapeSet>& set() const { return set_; }

 private:
  std::shared_ptr<const ShapeSet> set_;
  std::vector<double> margins_;  ///< by source and shape; empty if none has its own
  double most_margin_ = 0.0;
};

/// The least distance from what a hull is to a shape, as its pair counts.
struct ShapeClearance {
  double distance = std::numeric_limits<double>::infinity();
  int source = -1, shape = -1;  ///< -1: nothing is nearer than was asked
  int part = -1;                ///< of the shape
  const PlacedCapsule* capsule = nullptr;
  double t = 0.0;         ///< where on its segment, -1 to 1
  Vec4 gradient{};        ///< of the distance by that point
  double gap = 0.0;       ///< of its segment, at most by how much that lies within the part [m]
  double facing = 1.0;    ///< see SegmentSolidDistance
  bool by_piece = false;  ///< whether it is that of a piece of the link, by `point` of it
  Vec4 point{};
};

/// The least distance of hull k to a part of a shape, if less than `than`.
ShapeClearance hull_clearance(HullCapsules& hulls, int k, const ShapePairs& pairs, int part,
                              double than);

/// Visit the parts of shapes that may be nearer than this to hull k: see ShapeTree::near, but for
/// @param visit  visit(part) gives what distance is asked from then on, or kNoMore.
template <class Visit>
void shapes_near(const HullCapsules& hulls, int k, const ShapePairs& pairs, double than,
                 Visit&& visit) {
  const PlacedCapsule& around = hulls.around(k);
  const double size = around.radius + hulls.excess(k) + pairs.most_margin();
  // Of a hull that is hollow, whose middle is not a number, nothing is near anything.
  if (!(around.middle[0] == around.middle[0])) return;
  pairs.near(around.middle, around.half, size + than, [&](int part) { return size + visit(part); });
}

/// The least of all hulls to all shapes, if less than `than`.
ShapeClearance least_clearance(HullCapsules& hulls, const ShapePairs& pairs,
                               double than = std::numeric_limits<double>::infinity());

/// Whether any hull is nearer than this to a shape; true as well once the deadline has passed.
bool any_nearer(HullCapsules& hulls, const ShapePairs& pairs, double than,
                const Deadline* deadline);

}  // namespace pdoik::detail
