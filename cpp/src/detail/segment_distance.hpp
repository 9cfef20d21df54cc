#pragma once

#include "simd/vec4.hpp"

namespace pdoik::detail {

/// Where two segments come closest: each given by its middle c and half v, its points c + t v with
/// -1 <= t <= 1; v = 0 is a point.
struct SegmentDistance {
  double distance;
  double t1, t2;  ///< of the nearest points
  Vec4 gap;       ///< from the nearest point of the second segment to that of the first
};

/// Exact for all segments, parallel and degenerate ones included (Ericson, "Real-Time Collision
/// Detection", 5.1.9, with the lines' nearest points from cross products, which lose no digits when
/// the segments are nearly parallel). Of parallel segments it takes the middle of where they lie
/// side by side.
SegmentDistance segment_distance(const Vec4& c1, const Vec4& v1, const Vec4& c2, const Vec4& v2);

}  // namespace pdoik::detail
