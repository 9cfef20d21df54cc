#include "detail/collision.hpp"

#include <algorithm>
#include <cmath>

#include "detail/reach.hpp"
#include "detail/spheroid_distance.hpp"

namespace pdoik::detail {
namespace {

/// Move a point that lies on its joint's axis to the body before it, as far as that goes.
AttachedPoint settle(const Robot& robot, int body, Eigen::Vector3d local) {
  while (body > 0) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(body)];
    if (joint.prismatic || local.head<2>().norm() > 1e-12) break;
    local = joint.T_parent_joint * local;
    body = joint.parent;
  }
  return {body, to_vec4(local)};
}

int add_point(std::vector<AttachedPoint>& points, const AttachedPoint& point) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec4 gap = points[k].local - point.local;
    if (points[k].body == point.body && dot3(gap, gap) < 1e-24) return static_cast<int>(k);
  }
  points.push_back(point);
  return static_cast<int>(points.size()) - 1;
}

}  // namespace

HullModel::HullModel(const Robot& robot, bool heed_fixed) {
  const auto attach = [&](const std::string& link, const Eigen::Vector3d& xyz) {
    const int index = robot.link_index(link);
    return add_point(points,
                     settle(robot, robot.body_of_link(index), robot.T_body_link(index) * xyz));
  };
  int source = 0;
  const auto add = [&](int a, int b, double semi_major) {
    const bool is_fixed = points[static_cast<std::size_t>(a)].body == 0 &&
                          points[static_cast<std::size_t>(b)].body == 0;
    (is_fixed ? fixed : moving).push_back({a, b, semi_major, source++});
  };
  for (const Sphere& sphere : robot.occupancy().spheres) {
    const int at = attach(sphere.link, sphere.center);
    add(at, at, sphere.radius);
  }
  for (const Spheroid& s : robot.occupancy().spheroids) {
    const int a = attach(s.link_a, s.focus_a), b = attach(s.link_b, s.focus_b);
    add(a, b, s.semi_major);
  }

  if (!heed_fixed) fixed.clear();

  double farthest = 0.0;
  int root = -1;
  for (const Hull& hull : moving) {
    for (const int k : {hull.a, hull.b}) {
      const AttachedPoint& point = points[static_cast<std::size_t>(k)];
      if (point.body == 0) continue;
      const Reach r = reach_of(robot, point.body, std::sqrt(dot3(point.local, point.local)));
      if (root >= 0 && r.root != root) return;  // several branches at the base: no common centre
      root = r.root;
      farthest = std::max(farthest, r.distance + 2.0 * hull.semi_major);
    }
  }
  if (root < 0) return;
  reach_centre = Reach{root}.centre(robot);
  reach = farthest * (1.0 + 1e-9);
  const Vec4 centre = to_vec4(reach_centre);
  for (const Hull& hull : fixed) {
    const Vec4 from = points[static_cast<std::size_t>(hull.a)].local - centre;
    fixed_reach = std::max(fixed_reach, std::sqrt(dot3(from, from)) + 2.0 * hull.semi_major);
  }
}

namespace {

/// Half the sum of a point's distances to the foci, less the semi-major axis. It changes no faster
/// than the point moves: outside it is a lower bound of the distance, of a sphere the distance.
double half_sum_gap(const Hull& hull, const Vec4& a, const Vec4& b, const Vec4& o) {
  const Vec4 to_a = o - a;
  const double distance = std::sqrt(dot3(to_a, to_a));
  if (hull.is_sphere()) return distance - hull.semi_major;
  const Vec4 to_b = o - b;
  return 0.5 * (distance + std::sqrt(dot3(to_b, to_b))) - hull.semi_major;
}

/// A lower bound of a point's distance to a hull, and the distance where that is a sphere. Of a
/// spheroid it is the distance to the capsule that holds it (see Capsule), which is closer than the
/// half sum, or the half sum inside and where the foci are too far apart for a spheroid.
double distance_bound(const Hull& hull, const Vec4& a, const Vec4& b, const Vec4& o) {
  if (hull.is_sphere()) return half_sum_gap(hull, a, b, o);
  const Vec4 half = broadcast(0.5) * (b - a);
  const double h2 = dot3(half, half), A = hull.semi_major, minor2 = A * A - h2;
  if (!(minor2 > 0.0)) return half_sum_gap(hull, a, b, o);
  const double minor = std::sqrt(minor2);
  const Vec4 axis = broadcast(std::sqrt(h2) / (A + minor)) * half;  // half the capsule's segment
  const Vec4 from = o - broadcast(0.5) * (a + b);
  const double length2 = dot3(axis, axis);
  const double t = length2 > 0.0 ? std::clamp(dot3(from, axis) / length2, -1.0, 1.0) : 0.0;
  const Vec4 gap = from - broadcast(t) * axis;
  const double bound = std::sqrt(dot3(gap, gap)) - minor;
  return bound > 0.0 ? bound : half_sum_gap(hull, a, b, o);
}

/// Distance from a ball to a hull's surface, or any number above `than` where that is larger.
double hull_distance(const Hull& hull, const Vec4& a, const Vec4& b, const Vec4& o, double than) {
  const double radius = o[3];
  const double bound = distance_bound(hull, a, b, o);
  if (hull.is_sphere()) return bound - radius;
  const Vec4 half = broadcast(0.5) * (b - a);
  const bool hollow =
      !(hull.semi_major * hull.semi_major > dot3(half, half));  // foci too far apart: empty
  if (hollow || (bound > 0.0 && bound - radius >= than)) return bound - radius;
  return spheroid_distance(to_vector3(o), to_vector3(a), to_vector3(b), hull.semi_major).distance -
         radius;
}

}  // namespace

namespace {

/// The squared distance of an obstacle from a hull's centre.
double from_centre(const CollisionState& state, const Hull& hull, const Vec4& o) {
  const Vec4 from = o - broadcast(0.5) * (state.position(hull.a) + state.position(hull.b));
  return dot3(from, from);
}

/// Coordinates are a million metres at most, and so are joints' positions.
constexpr double kBeyondAll = 1e9;

/// The distance between the first hull and the nearest of some points, which bounds how far hulls
/// need to grow, if it is below `least`.
Clearance sampled_clearance(const CollisionState& state, const ObstacleSet& obstacles,
                            Clearance least) {
  constexpr int kEvery = 256;
  if (obstacles.count() < 4 * kEvery) return least;
  const Hull& hull = state.hulls().front();
  int nearest = 0;
  double lowest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < obstacles.count(); j += kEvery) {
    const double square = from_centre(state, hull, obstacles[j]);
    if (square >= lowest) continue;
    lowest = square;
    nearest = j;
  }
  const double distance =
      hull_distance(hull, state.position(hull.a), state.position(hull.b), obstacles[nearest],
                    std::numeric_limits<double>::infinity());
  if (distance >= least.distance) return least;
  return {distance, hull.source, obstacles.original_index(nearest)};
}

}  // namespace

Clearance least_clearance_by_growing(CollisionState& state, const ObstacleSet& obstacles,
                                     Clearance least) {
  if (state.hulls().empty() || obstacles.count() == 0) return least;
  for (double g = 0.05;; g *= 2.0) {
    least = least_clearance_within(state, obstacles, g, least);
    if (least.distance <= g || g > kBeyondAll) return least;
    if (g == 0.05) least = sampled_clearance(state, obstacles, least);
  }
}

Clearance least_clearance_within(CollisionState& state, const ObstacleSet& obstacles, double g,
                                 Clearance least) {
  const auto try_pair = [&](const NearPair& pair) {
    const Hull& hull = state.hull(pair);
    const Vec4& o = obstacles[pair.obstacle];
    // The ball around a hull says of most pairs that they are not the nearest, without a root.
    const double reach = least.distance + hull.semi_major + o[3];
    if (reach > 0.0 && from_centre(state, hull, o) >= reach * reach) return;
    const double distance =
        hull_distance(hull, state.position(hull.a), state.position(hull.b), o, least.distance);
    if (distance < least.distance)
      least = {distance, hull.source, obstacles.original_index(pair.obstacle)};
  };
  // What is farther than the least so far need not be found: hulls grow by no more than that.
  const auto grow = [&](std::size_t) { return std::min(g, std::max(least.distance, 0.0)); };
  state.visit_near(obstacles, grow, [&](const NearPair* begin, const NearPair* end) {
    // The pair nearest in proportion first: most of the others need no exact distance then.
    const NearPair* first = begin;
    double lowest = std::numeric_limits<double>::infinity();
    for (const NearPair* pair = begin; pair != end; ++pair) {
      const Hull& hull = state.hull(*pair);
      const Vec4& o = obstacles[pair->obstacle];
      const double size = hull.semi_major + std::max(o[3], 0.0);
      const double ratio = from_centre(state, hull, o) / (size * size);
      if (ratio >= lowest) continue;
      lowest = ratio;
      first = pair;
    }
    try_pair(*first);
    for (const NearPair* pair = begin; pair != end; ++pair) try_pair(*pair);
    return true;
  });
  return least;
}

}  // namespace pdoik::detail
