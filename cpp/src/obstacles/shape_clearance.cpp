#include "obstacles/shape_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapes/convex_distance.hpp"

namespace pdoik::detail {

ShapePairs::ShapePairs(std::shared_ptr<const ShapeSet> set, const Robot& robot,
                       const PairMargins& margins)
    : set_(std::move(set)) {
  if (!margins.speak_of_shapes()) return;
  const int sources = static_cast<int>(robot.occupancy().size());
  for (int source = 0; source < sources; ++source) {
    const auto [one, other] = links_of_source(robot, source);
    for (int shape = 0; shape < count(); ++shape) {
      margins_.push_back(margins.to_shape({one, other}, shape));
      most_margin_ = std::max(most_margin_, margins_.back());
    }
  }
}

namespace {

/// What the link's own pieces say where a capsule touches a part of a shape, if they say anything
/// else: the least of those that may not touch it, or `than`.
void look_at_pieces(const HullCapsules& hulls, int k, const ShapePairs& pairs, double than,
                    ShapeClearance& found) {
  const std::span<const int> pieces = hulls.pieces_at(k, found.distance);
  if (pieces.empty()) return;
  // Behind a surface, or through it, is more than a capsule's overhang.
  const Solid& part = pairs.part(found.part);
  const bool is_through = part.is_surface() && (found.gap < 0.0 || found.facing < 0.0);
  const double margin = pairs.margin(found.source, found.shape);
  const AllowedContact* const allowed = hulls.allowed_contact();
  const Frame& frame = hulls.frame(k);
  ShapeClearance least = found;
  least.distance = than;
  least.shape = -1;
  for (const int each : pieces) {
    const Solid& piece = hulls.piece(each);
    const double within = least.distance + margin;
    if (part.bound(transform(frame, piece.centre()), piece.radius()) >= within) continue;
    const ConvexDistance near = convex_distance(piece, frame, part, within);
    const double distance = near.distance - margin;
    if (!(distance < least.distance)) continue;
    if (allowed != nullptr && allowed->wanted() && near.distance >= -allowed->depth() &&
        allowed->lets(found.source, near.point))
      continue;
    least.distance = distance;
    least.shape = found.shape;
    least.gradient = near.gradient;
    least.point = near.point;
    least.by_piece = true;
  }
  // A hull's capsules may be farther than pieces that reach into another's.
  if (least.distance <= found.distance || (is_through && least.distance < 0.0)) return;
  found = least;
}

}  // namespace

ShapeClearance hull_clearance(HullCapsules& hulls, int k, const ShapePairs& pairs, int part,
                              double than) {
  ShapeClearance least;
  least.distance = than;
  const Solid& solid = pairs.part(part);
  const int shape = pairs.owner(part);
  const double margin = pairs.margin(hulls.source(k), shape);
  if (std::isinf(margin)) return least;
  const AllowedContact* const allowed = hulls.allowed_contact();
  const PlacedCapsule& around = hulls.around(k);
  // Nothing of a hull that is hollow, whose middle is not a number, is near anything.
  if (!(solid.bound(around.middle, hulls.semi_major(k)) < than + margin) ||
      !(solid.bound(around.middle, around.half, around.radius + hulls.excess(k)) < than + margin))
    return least;
  for (const PlacedCapsule& capsule : hulls.of(k)) {
    const double length = std::sqrt(dot3(capsule.half, capsule.half));
    const double counts = capsule.radius + margin;  // of it
    if (!(solid.bound(capsule.middle, length + std::max(counts, 0.0)) < least.distance) ||
        !(solid.bound(capsule.middle, capsule.half, counts) < least.distance))
      continue;
    const SegmentSolidDistance found =
        solid.distance(capsule.middle, capsule.half, least.distance + counts);
    const double distance = found.distance - counts;
    if (!(distance < least.distance)) continue;
    if (allowed != nullptr && allowed->wanted() &&
        allowed->lets(capsule.source, found.point - broadcast(found.distance) * found.gradient) &&
        found.distance - capsule.radius >= -allowed->depth())
      continue;
    const double t =
        length > 0.0 ? dot3(found.point - capsule.middle, capsule.half) / (length * length) : 0.0;
    least = {distance, capsule.source, shape,          part,        &capsule,
             t,        found.gradient, found.distance, found.facing};
  }
  if (least.shape >= 0) look_at_pieces(hulls, k, pairs, than, least);
  return least;
}

ShapeClearance least_clearance(HullCapsules& hulls, const ShapePairs& pairs, double than) {
  ShapeClearance least;
  least.distance = than;
  const auto look = [&](int most) {
    // The last ones, which reach farthest, are nearest to something as a rule.
    for (int k = hulls.count() - 1; k >= 0; --k) {
      int left = most;
      shapes_near(hulls, k, pairs, least.distance, [&](int part) {
        const ShapeClearance found = hull_clearance(hulls, k, pairs, part, least.distance);
        if (found.shape >= 0) least = found;
        return --left == 0 ? kNoMore : least.distance;
      });
    }
  };
  // Of a surface many parts are hardly farther than the nearest. A few near each hull first, so
  // that but for one hull all are passed over.
  constexpr int kFirst = 8;
  if (pairs.has_surfaces()) look(kFirst);
  look(std::numeric_limits<int>::max());
  return least;
}

bool any_nearer(HullCapsules& hulls, const ShapePairs& pairs, double than,
                const Deadline* deadline) {
  int turn = 0;
  bool is_any = false;
  for (int k = 0; k < hulls.count() && !is_any; ++k) {
    shapes_near(hulls, k, pairs, than, [&](int part) {
      is_any =
          passed_in(turn++, deadline) || hull_clearance(hulls, k, pairs, part, than).shape >= 0;
      return is_any ? kNoMore : than;
    });
  }
  return is_any;
}

}  // namespace pdoik::detail
