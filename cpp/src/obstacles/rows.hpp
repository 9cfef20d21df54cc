#pragma once

#include "simd/vec4.hpp"

namespace pdoik::detail {

/// Rows x y z [radius] of an array as ObstacleSet takes them in, numbered by row.
template <class Rows>
struct RowsOf {
  const Rows& points;
  bool has_radius;

  Vec4 operator()(int row) const {
    const auto* const at = points.data() + row * points.outerStride();
    return Vec4{static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2]),
                has_radius ? static_cast<double>(at[3]) : 0.0};
  }
  int id(int row) const { return row; }
  void prefetch(int row) const {
    const auto* const at = points.data() + row * points.outerStride();
    __builtin_prefetch(at);
    __builtin_prefetch(at + 2);  // which may lie in another line of the cache
  }
};

}  // namespace pdoik::detail
