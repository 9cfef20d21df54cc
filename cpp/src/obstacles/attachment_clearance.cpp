#include "obstacles/attachment_clearance.hpp"

#include <cmath>

namespace pdoik::detail {

using Kind = WorstConstraint::Kind;

AttachmentClearance::AttachmentClearance(const Robot& robot, const HullModel& hulls,
                                         const Options& options, const Attachments& attached)
    : attachments_(attached),
      clearance_(options.clearance),
      self_clearance_(options.self_clearance),
      balls_(attached.balls(), attached.balls().moving),
      hull_capsules_(robot, hulls, hulls.all(), options.self_clearance),
      frames_(static_cast<std::size_t>(attached.count())) {
  balls_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
}

std::optional<AttachmentNear> AttachmentClearance::nearest_point(int k, const ObstacleView& all,
                                                                 double within) {
  const double margin = attachments_.point_margin(k);
  if (std::isinf(margin)) return std::nullopt;
  const ObstacleView points(all.points, all.margin + margin);
  const Solid& solid = attachments_[k].solid;
  AttachmentNear least;
  least.distance = within;
  SolidDistance nearest{};
  Vec4 at{};
  const auto visit = [&](const NearPair* begin, const NearPair* end) {
    for (const NearPair* pair = begin; pair != end; ++pair) {
      const Vec4 o = points[pair->obstacle];
      const SolidDistance found = solid.distance(to_local(frame(k), o));
      if (!(found.distance - o[3] < least.distance)) continue;
      least.distance = found.distance - o[3];
      least.other = points->id(pair->obstacle);
      nearest = found;
      at = o;
    }
    return true;
  };
  const auto grow = [&](std::size_t) { return least.distance; };
  balls_.visit_near_of(static_cast<std::size_t>(k), points, grow, visit);
  if (least.other < 0) return std::nullopt;
  least.kind = Kind::AttachmentPoint;
  least.attached = k;
  // As the body carries the place where the point is, the point comes deeper or farther.
  least.gradients.add(attachments_[k].body, at, rotate(frame(k), nearest.gradient));
  return least;
}

std::optional<AttachmentNear> AttachmentClearance::nearest_of_part(int k, const ShapePairs& shapes,
                                                                   int part, double within) const {
  const int shape = shapes.owner(part);
  const double wanted = clearance_ + attachments_.shape_margin(k, shape);
  if (std::isinf(wanted)) return std::nullopt;
  const Solid &solid = attachments_[k].solid, &still = shapes.part(part);
  if (still.bound(transform(frame(k), solid.centre()), solid.radius()) - wanted >= within)
    return std::nullopt;
  const ConvexDistance found = convex_distance(solid, frame(k), still);
  if (!(found.distance - wanted < within)) return std::nullopt;
  AttachmentNear near{Kind::AttachmentShape, k, shape, found.distance - wanted, 0, {}};
  near.gradients.add(attachments_[k].body, found.point, -found.gradient);
  return near;
}

std::optional<AttachmentNear> AttachmentClearance::nearest_shape(int k, const ShapePairs& shapes,
                                                                 double within) const {
  std::optional<AttachmentNear> nearest;
  shapes_near(k, shapes, within, [&](int part) {
    const std::optional<AttachmentNear> near = nearest_of_part(k, shapes, part, within);
    if (near) {
      nearest = near;
      within = near->distance;
    }
    return within;
  });
  return nearest;
}

std::optional<AttachmentNear> AttachmentClearance::nearest_of_hull(int k, int hull, double within) {
  const double wanted = self_clearance_ + attachments_.hull_margin(k, hull);
  if (std::isinf(wanted)) return std::nullopt;
  const Solid& solid = attachments_[k].solid;
  const Frame& T = frame(k);
  const double far = within + wanted;
  const Vec4 apart = transform(T, solid.centre()) - hull_capsules_.around(hull).middle;
  // A hull that is hollow, whose middle is not a number, is near nothing.
  if (!(std::sqrt(dot3(apart, apart)) - solid.radius() - hull_capsules_.semi_major(hull) < far))
    return std::nullopt;
  double least = far;
  const PlacedCapsule* nearest = nullptr;
  SegmentSolidDistance where{};
  for (const PlacedCapsule& capsule : hull_capsules_.of(hull)) {
    const Vec4 middle = to_local(T, capsule.middle), half = to_local(T, T.p + capsule.half);
    if (solid.bound(middle, std::sqrt(dot3(half, half)) + capsule.radius) >= least) continue;
    const SegmentSolidDistance found = solid.distance(middle, half, least + capsule.radius);
    if (!(found.distance - capsule.radius < least)) continue;
    least = found.distance - capsule.radius;
    nearest = &capsule;
    where = found;
  }
  if (nearest == nullptr) return std::nullopt;
  AttachmentNear near{Kind::AttachmentHull, k, nearest->source, least - wanted, 0, {}};
  const double own = wanted - self_clearance_;
  if (const auto pieces = hull_capsules_.pieces_at(hull, least - own); !pieces.empty()) {
    // In the frame of the hull's body, which then stands still.
    const Frame& its = hull_capsules_.frame(hull);
    const Frame relative = to_local(its, T);
    ConvexDistance exact{far, {}, {}};
    bool is_any = false;
    for (const int each : pieces) {
      const Solid& piece = hull_capsules_.piece(each);
      if (piece.bound(transform(relative, solid.centre()), solid.radius()) >= exact.distance)
        continue;
      const ConvexDistance found = convex_distance(solid, relative, piece, exact.distance);
      if (!(found.distance < exact.distance)) continue;
      exact = found;
      is_any = true;
    }
    if (!is_any) return std::nullopt;
    if (exact.distance > least) {
      near.distance = exact.distance - wanted;
      const Vec4 point = transform(its, exact.point), away = rotate(its, exact.gradient);
      near.gradients.add(attachments_[k].body, point, -away);
      hull_capsules_.add_piece_gradient(hull, point, away, near.gradients);
      return near;
    }
  }
  const Vec4 point = transform(T, where.point), gradient = rotate(T, where.gradient);
  const double half2 = dot3(nearest->half, nearest->half);
  const double t = half2 > 0.0 ? dot3(point - nearest->middle, nearest->half) / half2 : 0.0;
  near.gradients.add(attachments_[k].body, point, gradient);
  hull_capsules_.add_gradient(hull, *nearest, t, -gradient, near.gradients);
  return near;
}

std::optional<AttachmentNear> AttachmentClearance::nearest_of_attached(int k, int other,
                                                                       double within) const {
  const double wanted = self_clearance_ + attachments_.attached_margin(k, other);
  if (std::isinf(wanted)) return std::nullopt;
  const Solid &solid = attachments_[k].solid, &still = attachments_[other].solid;
  const Frame &own = frame(k), &its = frame(other);
  const Vec4 apart = transform(own, solid.centre()) - transform(its, still.centre());
  const double far = std::sqrt(dot3(apart, apart)) - solid.radius() - still.radius();
  if (!(far - wanted < within)) return std::nullopt;
  // In the frame of the other's body, which then stands still.
  const Frame relative = to_local(its, own);
  const ConvexDistance found = convex_distance(solid, relative, still);
  if (!(found.distance - wanted < within)) return std::nullopt;
  AttachmentNear near{Kind::AttachmentAttachment, k, other, found.distance - wanted, 0, {}};
  const Vec4 point = transform(its, found.point), gradient = rotate(its, found.gradient);
  near.gradients.add(attachments_[k].body, point, -gradient);
  near.gradients.add(attachments_[other].body, point, gradient);
  return near;
}

}  // namespace pdoik::detail
