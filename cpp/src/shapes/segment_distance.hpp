#pragma once

#include <algorithm>
#include <cmath>

#include "simd/vec4.hpp"

namespace pdoik::detail {

/// Where two segments come closest: each given by its middle c and half v, its points c + t v with
/// -1 <= t <= 1; v = 0 is a point.
struct SegmentDistance {
  double distance;
  double t1, t2;  ///< of the nearest points
  Vec4 gap;       ///< from the nearest point of the second segment to that of the first
};

inline double clamp_to_segment(double t) { return std::clamp(t, -1.0, 1.0); }

/// How far a point is from the segment middle + t half, -1 <= t <= 1.
inline double distance_to_segment(const Vec4& point, const Vec4& middle, const Vec4& half) {
  const Vec4 from = point - middle;
  const double square = dot3(half, half);
  const double t = square > 0.0 ? clamp_to_segment(dot3(from, half) / square) : 0.0;
  const Vec4 off = from - broadcast(t) * half;
  return std::sqrt(dot3(off, off));
}

/// t1 of parallel segments: the middle of what lies beside the second one, or the end next to it.
inline double middle_of_overlap(double a, double b, double e, double along1) {
  const double centre = -along1 / a, reach = e / std::abs(b);  // of the second one, in units of t1
  return 0.5 * (clamp_to_segment(centre - reach) + clamp_to_segment(centre + reach));
}

/// Exact for all segments, parallel and degenerate ones included (Ericson, "Real-Time Collision
/// Detection", 5.1.9, with the lines' nearest points from cross products, which lose no digits when
/// the segments are nearly parallel). Of parallel segments it takes the middle of where they lie
/// side by side.
inline SegmentDistance segment_distance(const Vec4& c1, const Vec4& v1, const Vec4& c2,
                                        const Vec4& v2) {
  const Vec4 r = c1 - c2;
  const double a = dot3(v1, v1), b = dot3(v1, v2), e = dot3(v2, v2);
  const double along1 = dot3(v1, r), along2 = dot3(v2, r);
  double t1 = 0.0, t2 = 0.0;
  if (a > 0.0 && e > 0.0) {
    const Vec4 normal = cross3(v1, v2);
    const double square = dot3(normal, normal);
    t1 = square > 0.0 ? clamp_to_segment(-dot3(cross3(r, v2), normal) / square)
                      : middle_of_overlap(a, b, e, along1);
    const double free = (along2 + t1 * b) / e;
    t2 = clamp_to_segment(free);
    if (t2 != free) t1 = clamp_to_segment((t2 * b - along1) / a);
  } else if (a > 0.0) {
    t1 = clamp_to_segment(-along1 / a);
  } else if (e > 0.0) {
    t2 = clamp_to_segment(along2 / e);
  }
  const Vec4 gap = r + broadcast(t1) * v1 - broadcast(t2) * v2;
  return {std::sqrt(dot3(gap, gap)), t1, t2, gap};
}

}  // namespace pdoik::detail
