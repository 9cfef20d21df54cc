#pragma once

#include <cmath>
#include <limits>

#include "simd/vec4.hpp"

namespace pdoik::detail {

/// Four capsules of one link, side by side: each from a to a + v, in the frame of the link's body.
/// Padding has a radius of minus infinity.
struct CapsuleBlock {
  Vec4 ax{}, ay{}, az{}, vx{}, vy{}, vz{};
  Vec4 inverse{};  ///< 1 / |v|^2, 0 for a ball
  Vec4 radius = broadcast(-std::numeric_limits<double>::infinity());
  int source[4] = {-1, -1, -1, -1};  ///< places in the occupancy
};

/// How deep a point lies in the deepest of some capsules, negative by its distance outside.
struct Depth {
  double depth = -std::numeric_limits<double>::infinity();
  int block = 0, lane = 0;
};

/// @param o  The point, in the body's frame.
PDOIK_INLINE Depth depth_in(const CapsuleBlock* blocks, int count, const Vec4& o) {
  const Vec4 x = broadcast(o[0]), y = broadcast(o[1]), z = broadcast(o[2]);
  Depth deepest;
  for (int k = 0; k < count; ++k) {
    const CapsuleBlock& block = blocks[k];
    const Vec4 rx = x - block.ax, ry = y - block.ay, rz = z - block.az;
    const Vec4 along = (rx * block.vx + ry * block.vy + rz * block.vz) * block.inverse;
    Vec4 t;
    for (int i = 0; i < 4; ++i) t[i] = along[i] < 0.0 ? 0.0 : along[i] > 1.0 ? 1.0 : along[i];
    const Vec4 gx = rx - t * block.vx, gy = ry - t * block.vy, gz = rz - t * block.vz;
    const Vec4 square = gx * gx + gy * gy + gz * gz;
    for (int i = 0; i < 4; ++i) {
      // A root only where it is deeper: of a block's four few are.
      const double within = block.radius[i] - deepest.depth;
      if (within > 0.0 && square[i] < within * within)
        deepest = {block.radius[i] - std::sqrt(square[i]), k, i};
    }
  }
  return deepest;
}

/// Where on its segment a capsule is nearest to a point, in the body's frame.
PDOIK_INLINE Vec4 nearest_on(const CapsuleBlock& block, int lane, const Vec4& o) {
  const Vec4 a{block.ax[lane], block.ay[lane], block.az[lane], 0.0},
      v{block.vx[lane], block.vy[lane], block.vz[lane], 0.0};
  const double along = dot3(o - a, v) * block.inverse[lane];
  return a + broadcast(along < 0.0 ? 0.0 : along > 1.0 ? 1.0 : along) * v;
}

}  // namespace pdoik::detail
