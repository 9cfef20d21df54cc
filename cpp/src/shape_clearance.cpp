#include "detail/shape_clearance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdoik::detail {

ShapePairs::ShapePairs(std::shared_ptr<const ShapeSet> set, const Robot& robot)
    : set_(std::move(set)) {
  if (set_->allowed.empty()) return;
  const Occupancy& occupancy = robot.occupancy();
  const auto shapes = static_cast<std::size_t>(count());
  allowed_.assign(occupancy.size() * shapes, 0.0);
  for (const AllowedContact& contact : set_->allowed) {
    robot.link_index(contact.link);
    std::size_t shape = 0;
    while (set_->shapes[shape].name != contact.shape) ++shape;
    std::size_t source = 0;
    const auto allow = [&](bool is_on_link) {
      double& depth = allowed_[source * shapes + shape];
      if (is_on_link) depth = std::max(depth, contact.depth);
      ++source;
    };
    for (const Sphere& s : occupancy.spheres) allow(s.link == contact.link);
    for (const Spheroid& s : occupancy.spheroids)
      allow(s.link_a == contact.link || s.link_b == contact.link);
    for (const Capsule& c : occupancy.capsules) allow(c.link == contact.link);
  }
}

ShapeClearance hull_clearance(HullCapsules& hulls, int k, const ShapePairs& pairs, int part,
                              double than) {
  ShapeClearance least;
  least.distance = than;
  const Solid& solid = pairs.part(part);
  const int shape = pairs.owner(part);
  const Touching* const touching = hulls.touching();
  const PlacedCapsule& around = hulls.around(k);
  // Nothing of a hull that is hollow, whose middle is not a number, is near anything.
  if (!(solid.bound(around.middle, hulls.semi_major(k)) < than) ||
      !(solid.bound(around.middle, around.half, around.radius + hulls.excess(k)) < than))
    return least;
  for (const PlacedCapsule& capsule : hulls.of(k)) {
    const double allowed = pairs.allowed(capsule.source, shape);
    if (std::isinf(allowed)) continue;
    const double length = std::sqrt(dot3(capsule.half, capsule.half));
    const double counts = capsule.radius - allowed;  // of it
    if (!(solid.bound(capsule.middle, length + std::max(counts, 0.0)) < least.distance) ||
        !(solid.bound(capsule.middle, capsule.half, counts) < least.distance))
      continue;
    const SegmentSolidDistance found =
        solid.distance(capsule.middle, capsule.half, least.distance + counts);
    const double distance = found.distance - counts;
    if (!(distance < least.distance)) continue;
    if (touching != nullptr && touching->wanted() &&
        touching->lets(capsule.source, found.point - broadcast(found.distance) * found.gradient) &&
        distance >= -touching->depth())
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
