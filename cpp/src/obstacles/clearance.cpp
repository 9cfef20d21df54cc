#include "obstacles/clearance.hpp"

#include <algorithm>
#include <cmath>

#include "hulls/spheroid_distance.hpp"
#include "obstacles/constraint.hpp"

namespace pdoik::detail {
namespace {

/// A point and a spheroid in the half plane through both its foci and the point.
struct Meridian {
  Meridian(const CollisionState::Around& spheroid, const Vec4& o) : major(spheroid.semi_major) {
    const Vec4 half = spheroid.half, from = o - spheroid.centre;
    const double h2 = dot3(half, half), from2 = dot3(from, from), on_half = dot3(from, half);
    minor2 = major * major - h2;
    along2 = h2 > 0.0 ? on_half * on_half / h2 : 0.0;
    aside2 = std::max(from2 - along2, 0.0);
  }
  /// No spheroid: the foci are too far apart.
  bool is_hollow() const { return !(minor2 > 0.0); }

  /// At most the point's signed distance from the surface: that from a plane which the spheroid
  /// touches, near the point where it is nearest.
  double distance_bound() const {
    const Plane plane = touching_plane();
    if (!(plane.length > 0.0)) return -std::sqrt(minor2);  // the centre itself
    return (std::sqrt(along2) * plane.along + std::sqrt(aside2) * plane.aside - plane.support) /
           plane.length;
  }
  /// How far that plane is from the centre, 0 if there is none.
  double support() const {
    const Plane plane = touching_plane();
    return plane.length > 0.0 ? plane.support / plane.length : 0.0;
  }

 private:
  struct Plane {
    double along, aside, length;  // its normal
    double support;               // of the spheroid, times the length
  };
  Plane touching_plane() const {
    const double along = std::sqrt(along2), aside = std::sqrt(aside2), major2 = major * major;
    const double share =
        std::sqrt(along2 / major2 + aside2 / minor2);  // of the point's way outside
    const double beyond =
        share > 1.0 ? std::sqrt(minor2 * (along2 + aside2)) * (1.0 - 1.0 / share) : 0.0;
    const double n_along = along / (major2 + beyond), n_aside = aside / (minor2 + beyond);
    return {n_along, n_aside, std::sqrt(n_along * n_along + n_aside * n_aside),
            std::sqrt(major2 * n_along * n_along + minor2 * n_aside * n_aside)};
  }

  double major, minor2, along2, aside2;
};

/// Distance from a ball to what a hull stands for, or any number not below `than` where that is
/// larger, and whose it is.
struct HullDistance {
  double distance;
  int source;
};

double distance_to_foci(const CollisionState& state, const Hull& hull, const Vec4& o, double than);

HullDistance hull_distance(const CollisionState& state, const Hull& hull, const Vec4& o,
                           double than) {
  if (!hull.has_capsules()) return {distance_to_foci(state, hull, o, than), hull.source};
  const Depth deepest = state.depth_in_capsules(hull, o);
  double distance = -deepest.depth - o[3];
  if (distance < 0.0 && distance < than && hull.has_pieces())
    distance = std::max(distance, state.distance_to_pieces(hull, o, than + o[3]).distance - o[3]);
  return {distance, state.block(hull, deepest.block).source[deepest.lane]};
}

double distance_to_foci(const CollisionState& state, const Hull& hull, const Vec4& o, double than) {
  const Vec4 &a = state.position(hull.a), &b = state.position(hull.b);
  const double radius = o[3];
  if (hull.is_sphere()) return half_sum_gap(hull, a, b, o) - radius;
  const Meridian meridian(state.around(hull), o);
  if (meridian.is_hollow()) return half_sum_gap(hull, a, b, o) - radius;
  if (meridian.distance_bound() - radius >= than) return than;
  return spheroid_distance(to_vector3(o), to_vector3(a), to_vector3(b), hull.semi_major).distance -
         radius;
}

/// The squared distance of an obstacle from a hull's centre.
double from_centre(const CollisionState& state, const Hull& hull, const Vec4& o) {
  const Vec4 from = o - state.centre_of(hull);
  return dot3(from, from);
}

/// Of some pairs, the one whose obstacle is nearest to the hull's centre in proportion to their
/// size.
const NearPair& nearest_in_proportion(const CollisionState& state, const ObstacleView& obstacles,
                                      const NearPair* begin, const NearPair* end) {
  const NearPair* nearest = begin;
  double lowest = std::numeric_limits<double>::infinity();
  for (const NearPair* pair = begin; pair != end; ++pair) {
    const Hull& hull = state.hull(*pair);
    const Vec4 o = obstacles.of(hull.source, pair->obstacle);
    const double size = hull.farthest() + std::max(o[3], 0.0);
    const double ratio = from_centre(state, hull, o) / (size * size);
    if (ratio >= lowest) continue;
    lowest = ratio;
    nearest = pair;
  }
  return *nearest;
}

/// From so many obstacles on it pays to bound the distances of a whole block.
constexpr int kFewAtOnce = 3;

/// Coordinates are a million metres at most, but a joint may slide farther: beyond this nothing is
/// left out.
constexpr double kBeyondAll = 1e9;

}  // namespace

void find_within(CollisionState& state, const ObstacleView& obstacles, double distance,
                 std::vector<int>& places) {
  const auto grow = [distance](std::size_t) { return distance; };
  state.visit_near(obstacles, grow, [&](const NearPair* begin, const NearPair* end) {
    for (const NearPair* pair = begin; pair != end; ++pair) {
      const Hull& hull = state.hull(*pair);
      const double gap = hull_distance(state, hull, obstacles.of(hull.source, pair->obstacle),
                                       std::numeric_limits<double>::infinity())
                             .distance;
      if (gap <= distance) places.push_back(pair->obstacle);
    }
    return true;
  });
}

Clearance least_clearance_of(CollisionState& state, std::size_t h, const ObstacleView& obstacles,
                             double than) {
  Clearance least{than, -1, -1};
  const auto grow = [&](std::size_t) { return least.distance; };
  state.visit_near_of(h, obstacles, grow, [&](const NearPair* begin, const NearPair* end) {
    for (const NearPair* pair = begin; pair != end; ++pair) {
      const Hull& hull = state.hull(*pair);
      const HullDistance found =
          hull_distance(state, hull, obstacles.of(hull.source, pair->obstacle), least.distance);
      if (found.distance < least.distance)
        least = {found.distance, found.source, obstacles->id(pair->obstacle)};
    }
    return true;
  });
  return least;
}

bool any_nearer(CollisionState& state, std::size_t h, const ObstacleView& obstacles, double than) {
  const auto grow = [than](std::size_t) { return than; };
  return !state.visit_near_of(h, obstacles, grow, [&](const NearPair* begin, const NearPair* end) {
    return std::none_of(begin, end, [&](const NearPair& pair) {
      const Hull& hull = state.hull(pair);
      const Vec4 o = obstacles.of(hull.source, pair.obstacle);
      return hull_distance(state, hull, o, than).distance < than;
    });
  });
}

Clearance least_clearance(CollisionState& state, const ObstacleView& obstacles, Clearance least) {
  if (state.hulls().empty() || obstacles->count() == 0) return least;
  if (obstacles->few() == nullptr) state.expect_anywhere();
  if (const ObstacleSet* few = obstacles->few()) {  // whose nearest bounds how far others may be
    least = least_clearance(state, {few, obstacles.margin, obstacles.own}, least);
    return least_clearance_within(state, obstacles, least.distance, least);
  }
  double g = 0.05;
  while (g < kBeyondAll) {
    least = least_clearance_within(state, obstacles, g, least);
    if (least.distance <= g) return least;
    g *= 2.0;
  }
  return least_clearance_within(state, obstacles, std::numeric_limits<double>::infinity(), least);
}

Clearance least_clearance_within(CollisionState& state, const ObstacleView& obstacles, double g,
                                 Clearance least) {
  const auto try_pair = [&](const NearPair& pair) {
    const Hull& hull = state.hull(pair);
    const Vec4 o = obstacles.of(hull.source, pair.obstacle);
    // The ball around a hull says of most pairs that they are not the nearest, without a root.
    const double reach = least.distance + hull.farthest() + o[3];
    if (reach > 0.0 && from_centre(state, hull, o) >= reach * reach) return;
    const HullDistance found = hull_distance(state, hull, o, least.distance);
    if (!(found.distance < least.distance)) return;
    least = {found.distance, found.source, obstacles->id(pair.obstacle)};
    // What is nearer still lies near it.
    state.expect_at(static_cast<std::size_t>(pair.hull), Meridian(state.around(hull), o).support());
  };
  // What is farther than the least so far need not be found: hulls grow by no more than that, or
  // shrink.
  const auto grow = [&](std::size_t) { return std::min(g, least.distance); };
  state.visit_near(obstacles, grow, [&](const NearPair* begin, const NearPair* end) {
    // The pair nearest in proportion first, unless a few have shown how near the others may be:
    // most need no exact distance then.
    if (obstacles->few() == nullptr) try_pair(nearest_in_proportion(state, obstacles, begin, end));
    for (const NearPair* pair = begin; pair != end;) {
      // Many of a block at once: most are known from the nearest without an exact distance.
      const int block = pair->obstacle / kLanes;
      const NearPair* last = pair;
      while (last != end && last->hull == pair->hull && last->obstacle / kLanes == block) ++last;
      float bounds[kLanes];
      const bool bounded =
          last - pair >= kFewAtOnce && state.bound_distances(static_cast<std::size_t>(pair->hull),
                                                             obstacles, block * kLanes, bounds);
      for (; pair != last; ++pair) {
        const double margin = obstacles.margin_of(state.hull(*pair).source);
        if (bounded &&
            static_cast<double>(bounds[pair->obstacle % kLanes]) - margin >= least.distance)
          continue;
        try_pair(*pair);
      }
    }
    return true;
  });
  return least;
}

}  // namespace pdoik::detail
