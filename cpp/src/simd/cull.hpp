#pragma once

#include <cstdint>

namespace pdoik::detail {

/// Obstacle points by coordinate, relative to some origin near the robot, padded to a multiple of
/// kLanes with points far away that touch nothing. Single precision: the coarse test decides
/// nothing by itself.
struct ObstacleArrays {
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  int padded_count;
};

/// A prolate spheroid for the coarse test, relative to the same origin: half = (focus_b - focus_a)
/// / 2, zero for a sphere.
struct HullQuery {
  float centre[3];
  float half[3];
  float semi_major;
};

struct NearPair {
  std::int32_t hull;
  std::int32_t obstacle;
};

constexpr int kLanes = 16;

/// Every (hull, obstacle) whose point lies inside the hull grown by the point's radius: with A =
/// semi_major + radius, d = o - centre and h = half,
///     (|d|^2 - A^2 + |h|^2) A^2 < (d.h)^2,    |d| < A,    |h| < A,
/// which needs no square root. Rounding moves the border by a little: callers grow the hulls by
/// `coarse_slack` and test again in double. Returns the number of pairs; `pairs` has room for
/// hull_count * padded_count.
using CullFunction = int (*)(const ObstacleArrays&, const HullQuery* hulls, int hull_count,
                             NearPair* pairs);

int cull_baseline(const ObstacleArrays&, const HullQuery*, int, NearPair*);
int cull_avx2(const ObstacleArrays&, const HullQuery*, int, NearPair*);
int cull_avx512(const ObstacleArrays&, const HullQuery*, int, NearPair*);

/// The widest that this processor runs, chosen once.
CullFunction best_cull();
/// "avx512", "avx2" or "baseline".
const char* simd_name();

}  // namespace pdoik::detail
