#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/frame.hpp"
#include "shapes/segment_distance.hpp"
#include "shapes/solid_distance.hpp"

namespace pdoik::detail {

/// A triangle made ready for distances.
struct Triangle {
  Triangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& one, const Eigen::Vector3d& other)
      : a(to_vec4(corner)), ab(to_vec4(one - corner)), ac(to_vec4(other - corner)) {
    const Eigen::Vector3d across = (one - corner).cross(other - corner);
    normal = to_vec4(across.normalized());
    offset = dot3(normal, a);
    ab2 = dot3(ab, ab);
    abac = dot3(ab, ac);
    ac2 = dot3(ac, ac);
    determinant = across.squaredNorm();
    centre = a + broadcast(1.0 / 3.0) * (ab + ac);
    for (const Vec4& at : {a, a + ab, a + ac}) {
      const Vec4 from = at - centre;
      radius = std::max(radius, std::sqrt(dot3(from, from)));
    }
  }

  /// Whether the foot of a point on its plane lies in it.
  bool is_below(const Vec4& p) const {
    const Vec4 ap = p - a;
    const double d1 = dot3(ap, ab), d2 = dot3(ap, ac);
    const double u = ac2 * d1 - abac * d2, v = ab2 * d2 - abac * d1;
    return u >= 0.0 && v >= 0.0 && u + v <= determinant;
  }
  double above(const Vec4& p) const { return dot3(normal, p) - offset; }

  Vec4 a, ab, ac;  ///< a corner and two edges
  Vec4 normal;     ///< out of the solid, of length 1
  double offset;   ///< normal . a
  double ab2, abac, ac2, determinant;
  Vec4 centre;  ///< of a ball that holds it
  double radius = 0.0;
};

/// Where a segment comes nearest to a triangle. Of one that goes through it, minus the way that its
/// shorter side has to come back.
/// @param than  Where nothing is nearer than this, any number not below it may come back.
inline SegmentSolidDistance distance_to(const Triangle& triangle, const Vec4& middle,
                                        const Vec4& half, double than) {
  const Vec4 ends[] = {middle - half, middle + half};
  const double above[] = {triangle.above(ends[0]), triangle.above(ends[1])};
  const bool goes_through = (above[0] < 0.0) != (above[1] < 0.0);
  const int nearer = std::abs(above[0]) <= std::abs(above[1]) ? 0 : 1;
  const double side = above[1 - nearer] < 0.0 ? -1.0 : 1.0;  // that the longer part is on
  const Vec4 up = broadcast(side) * triangle.normal;
  if (goes_through) {
    const double share = above[0] / (above[0] - above[1]);
    if (triangle.is_below(ends[0] + broadcast(2.0 * share) * half))
      return {-std::abs(above[nearer]), ends[nearer], up, side};
  } else if (std::abs(above[nearer]) >= than) {
    return {std::abs(above[nearer]), ends[nearer], up, side};
  }
  SegmentSolidDistance nearest{std::numeric_limits<double>::infinity(), middle, up, side};
  if (!goes_through) {
    for (int end = 0; end < 2; ++end) {
      if (std::abs(above[end]) < nearest.distance && triangle.is_below(ends[end]))
        nearest = {std::abs(above[end]), ends[end], up, side};
    }
  }
  const auto try_edge = [&](const Vec4& from, const Vec4& edge) {
    const Vec4 half_edge = broadcast(0.5) * edge;
    const SegmentDistance found = segment_distance(middle, half, from + half_edge, half_edge);
    if (!(found.distance < nearest.distance)) return;
    const Vec4 gradient = found.distance > 1e-12 ? broadcast(1.0 / found.distance) * found.gap : up;
    nearest = {found.distance, middle + broadcast(found.t1) * half, gradient,
               dot3(gradient, triangle.normal)};
  };
  try_edge(triangle.a, triangle.ab);
  try_edge(triangle.a, triangle.ac);
  try_edge(triangle.a + triangle.ab, triangle.ac - triangle.ab);
  return nearest;
}

}  // namespace pdoik::detail
