#pragma once

#include "simd/vec4.hpp"

namespace pdoik::detail {

/// The signed distance of a point from a solid's surface, negative inside, and its derivative.
struct SolidDistance {
  double distance;
  Vec4 gradient;  ///< a unit vector, away from the solid
};

/// Where a segment comes nearest to a solid, or lies deepest in it by the signed distance of its
/// points: exact outside; inside, no less deep than a way out of the solid for each of its points.
struct SegmentSolidDistance {
  double distance;
  Vec4 point;     ///< on the segment
  Vec4 gradient;  ///< how the distance changes as the segment's body moves that point
  /// Of the surface of a closed mesh: the cosine between what is out of the nearest triangle and
  /// the gradient, negative behind it.
  double facing = 1.0;
};

}  // namespace pdoik::detail
