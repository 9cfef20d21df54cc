#pragma once

#include <cstdint>

namespace pdoik::detail {

/// Obstacle points by coordinate, padded to a multiple of kLanes with points at 1e30 that touch nothing.
struct ObstacleArrays {
  const double* x;
  const double* y;
  const double* z;
  const double* radius;
  int padded_count;
};

/// A prolate spheroid for the coarse test: half = (focus_b - focus_a) / 2, zero for a sphere.
struct HullQuery {
  double centre[3];
  double half[3];
  double semi_major;
};

struct NearPair {
  std::int32_t hull;
  std::int32_t obstacle;
};

constexpr int kLanes = 8;

/// Every (hull, obstacle) whose point lies inside the hull grown by the point's radius: with A = semi_major +
/// radius, d = o - centre and h = half,
///     (|d|^2 - A^2 + |h|^2) A^2 < (d.h)^2,
/// which needs no square root. Returns the number of pairs; `pairs` has room for hull_count * padded_count.
using CullFunction = int (*)(const ObstacleArrays&, const HullQuery* hulls, int hull_count, NearPair* pairs);

int cull_baseline(const ObstacleArrays&, const HullQuery*, int, NearPair*);
int cull_avx2(const ObstacleArrays&, const HullQuery*, int, NearPair*);
int cull_avx512(const ObstacleArrays&, const HullQuery*, int, NearPair*);

/// The widest that this processor runs, chosen once.
CullFunction best_cull();
/// "avx512", "avx2" or "baseline".
const char* simd_name();

}  // namespace pdoik::detail
