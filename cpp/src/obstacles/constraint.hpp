#pragma once

#include <cmath>

#include "common/infinity.hpp"
#include "hulls/spheroid_distance.hpp"
#include "obstacles/collision_state.hpp"

namespace pdoik::detail {

/// One collision constraint c <= 0 and its derivatives with respect to the attached points a and b.
struct Constraint {
  double c = 0.0;
  Vec4 dc_da{}, dc_db{};  ///< dc_db is unused for spheres
};

PDOIK_INLINE Vec4 unit_from(const Vec4& o, const Vec4& u, double& distance) {
  const Vec4 gap = u - o;
  distance = std::sqrt(dot3(gap, gap));
  return distance > 1e-12 ? broadcast(1.0 / distance) * gap : Vec4{};  // the guard of |u - o| = 0
}

/// Eqs. joint_coll_avoid and link_coll_avoid: c = r - |u - o|, or c = 2a - (|u - o| + |u' - o|),
/// and dc/du = -(u - o) / |u - o|. A point's radius R makes them r + R and 2(a + R), which keeps
/// the ball out of the hull because the half sum of distances changes no faster than the point
/// moves.
PDOIK_INLINE Constraint paper_constraint(const CollisionState& state, const Hull& hull,
                                         const Vec4& o) {
  const double radius = o[3];
  Constraint result;
  double distance;
  result.dc_da = -unit_from(o, state.position(hull.a), distance);
  if (hull.is_sphere()) {
    result.c = hull.semi_major + radius - distance;
    return result;
  }
  double other;
  result.dc_db = -unit_from(o, state.position(hull.b), other);
  result.c = 2.0 * (hull.semi_major + radius) - (distance + other);
  return result;
}

/// The same zero set in metres of penetration. A point with a radius r is held off by the confocal
/// spheroid whose axis is longer by r, which is at least r away from the hull everywhere.
PDOIK_INLINE Constraint half_sum_constraint(const CollisionState& state, const Hull& hull,
                                            const Vec4& o) {
  Constraint result = paper_constraint(state, hull, o);
  if (hull.is_sphere()) return result;
  const Vec4 half = broadcast(0.5);
  result.c *= 0.5;
  result.dc_da *= half;
  result.dc_db *= half;
  return result;
}

/// Half the sum of a point's distances to the foci, less the semi-major axis. It changes no faster
/// than the point moves: outside it is a lower bound of the distance, of a sphere the distance.
inline double half_sum_gap(const Hull& hull, const Vec4& a, const Vec4& b, const Vec4& o) {
  const Vec4 to_a = o - a;
  const double distance = std::sqrt(dot3(to_a, to_a));
  if (hull.is_sphere()) return distance - hull.semi_major;
  const Vec4 to_b = o - b;
  return 0.5 * (distance + std::sqrt(dot3(to_b, to_b))) - hull.semi_major;
}

/// A point off a hull's capsules: c = r + R - |p - o| of the capsule that it is deepest in, by p,
/// the point of its segment that is nearest. Where it is in them and the link's pieces are known, c
/// = R - d of its signed distance d from these, by p = o: as the body carries the place where the
/// point is, that comes deeper or farther.
struct CapsuleConstraint {
  double c = 0.0;
  Vec4 p{};  ///< which moves with the hull's body
  Vec4 dc_dp{};
};

/// At most c.
PDOIK_INLINE double capsule_violation(const CollisionState& state, const Hull& hull,
                                      const Vec4& o) {
  return state.depth_in_capsules(hull, o).depth + o[3];
}

/// c alone.
PDOIK_INLINE double link_violation(const CollisionState& state, const Hull& hull, const Vec4& o) {
  const double c = capsule_violation(state, hull, o);
  if (!(c > 0.0) || !hull.has_pieces()) return c;
  // What is farther from the pieces than the ball reaches is none of them.
  return std::min(c, o[3] - state.distance_to_pieces(hull, o, kInfinity).distance);
}

PDOIK_INLINE CapsuleConstraint capsule_constraint(const CollisionState& state, const Hull& hull,
                                                  const Vec4& o) {
  const Frame& frame = state.frame(hull);
  const Depth deepest = state.depth_in_capsules(hull, o);
  const Vec4 local = to_local(frame, o);
  CapsuleConstraint result;
  result.c = deepest.depth + o[3];
  if (result.c > 0.0 && hull.has_pieces()) {
    const SolidDistance found = state.distance_to_pieces(hull, o, kInfinity);
    if (o[3] - found.distance < result.c) return {o[3] - found.distance, o, found.gradient};
  }
  result.p = transform(frame, nearest_on(state.block(hull, deepest.block), deepest.lane, local));
  double distance;
  result.dc_dp = -unit_from(o, result.p, distance);
  return result;
}

/// The same, but points with a radius are held off by their true Euclidean distance d to the
/// spheroid, negative inside, whose derivative by a focus is that of its nearest surface point x
/// (envelope theorem): dd/df = (f - x) / |f - x| / |grad g(x)|, g the sum of distances to the foci.
/// A negative radius says how deep a point may lie inside.
PDOIK_INLINE Constraint distance_constraint(const CollisionState& state, const Hull& hull,
                                            const Vec4& o) {
  const double radius = o[3];
  Constraint result = half_sum_constraint(state, hull, o);
  if (hull.is_sphere() || radius == 0.0) return result;
  const bool inside = result.c > radius;  // the point itself
  if (inside == (radius > 0.0)) return result;
  const Eigen::Vector3d a = to_vector3(state.position(hull.a)),
                        b = to_vector3(state.position(hull.b));
  const SpheroidDistance nearest = spheroid_distance(to_vector3(o), a, b, hull.semi_major);
  const Eigen::Vector3d from_a = (a - nearest.nearest).normalized(),
                        from_b = (b - nearest.nearest).normalized();
  const double slope = (from_a + from_b).norm();
  if (!(slope > 1e-9)) return result;
  result.c = radius - nearest.distance;
  result.dc_da = to_vec4(-from_a / slope);
  result.dc_db = to_vec4(-from_b / slope);
  return result;
}

}  // namespace pdoik::detail
