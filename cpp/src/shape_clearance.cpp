#include "detail/shape_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

ShapeClearance hull_clearance(HullCapsules& hulls, int k, const ShapePairs& pairs, int part,
                              double than) {
  ShapeClearance least;
  least.distance = than;
  const Solid& solid = pairs.part(part);
  const int shape = pairs.owner(part);
  const double margin = pairs.margin(hulls.source(k), shape);
  if (std::isinf(margin)) return least;
  const Touching* const touching = hulls.touching();
  const PlacedCapsule& around = hulls.around(k);
  // Nothing of a hull that is hollow, whose middle is not a number, is near anything.
  if (!(solid.bound(around.middle, hulls.semi_major(k)) < than + margin) ||
      !(solid.bound(around.middle, around.half, around.radius + hulls.excess(k)) < than + margin))
    return least;
  for (const PlacedCapsule& capsule : hulls.of(k)) {
    const double length = std::sqrt(dot3(capsule.half, capsule.half));
    const double counts = capsule.radius + margin;  // of it
    if (!(solid.bound(capsule.middle, length + counts) < least.distance) ||
        !(solid.bound(capsule.middle, capsule.half, counts) < least.distance))
      continue;
    const SegmentSolidDistance found =
        solid.distance(capsule.middle, capsule.half, least.distance + counts);
    const double distance = found.distance - counts;
    if (!(distance < least.distance)) continue;
    if (touching != nullptr && touching->wanted() &&
        touching->lets(capsule.source, found.point - broadcast(found.distance) * found.gradient) &&
        found.distance - capsule.radius >= -touching->depth())
      continue;
    const double t =
        length > 0.0 ? dot3(found.point - capsule.middle, capsule.half) / (length * length) : 0.0;
    least = {distance, capsule.source, shape,          part,        &capsule,
             t,        found.gradient, found.distance, found.facing};
  }
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
