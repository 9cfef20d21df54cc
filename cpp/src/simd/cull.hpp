#pragma once

#include <cstdint>

namespace pdoik::detail {

/// Points or blocks of points that the coarse test looks at together; every list is padded to a
/// multiple of it.
constexpr int kLanes = 16;

/// Boxes by coordinate, each around kLanes things and with the largest radius among them. Padding
/// boxes lie far away.
struct BoxArrays {
  const float* low[3];
  const float* high[3];
  const float* radius;
  int padded_count;
};

/// Obstacle points by coordinate, relative to some origin near the robot, padded with points far
/// away that touch nothing; so are places that hold no point. Single precision: the coarse test
/// decides nothing by itself. Where there are boxes, block b is around the points from kLanes b on,
/// group g around the blocks from kLanes g on, district d around the groups from kLanes d on.
struct ObstacleArrays {
  const float* x;
  const float* y;
  const float* z;
  const float* radius;
  int padded_count;
  BoxArrays blocks, groups,
      districts;  ///< none (padded_count 0) of a cloud that is small or in no order
};

/// A prolate spheroid for the coarse test, relative to the same origin: half = (focus_b - focus_a)
/// / 2, zero for a sphere. All numbers are finite.
struct HullQuery {
  float centre[3];
  float half[3];
  float semi_major;
};

struct NearPair {
  std::int32_t hull;
  std::int32_t obstacle;
};

/// Where a coarse test goes on.
struct CullCursor {
  int hull = 0, point = 0;
};

/// Every (hull, obstacle) whose point lies inside the hull grown by the point's radius: with A =
/// semi_major + radius, d = o - centre and h = half,
///     (|d|^2 - A^2 + |h|^2) A^2 < (d.h)^2,    |d| < A,    |h| < A,
/// which needs no square root. Pairs are ordered by hull, then by point. Rounding moves the border
/// by a little: callers grow the hulls by `coarse_slack` and test again in double.
/// @param pairs  Room for `capacity` of them, at least kLanes.
/// @param at  Where to begin. If there are more pairs than fit, it is left where to go on: at the
/// end its hull is hull_count.
/// @returns  The number of pairs written.
using CullFunction = int (*)(const ObstacleArrays&, const HullQuery* hulls, int hull_count,
                             NearPair* pairs, int capacity, CullCursor& at);

int cull_baseline(const ObstacleArrays&, const HullQuery*, int, NearPair*, int, CullCursor&);
int cull_avx2(const ObstacleArrays&, const HullQuery*, int, NearPair*, int, CullCursor&);
int cull_avx512(const ObstacleArrays&, const HullQuery*, int, NearPair*, int, CullCursor&);

/// At most the distances of kLanes points, from `first` on, less their radii, from a spheroid's
/// surface; negative inside. By planes that touch it near where it is nearest, in single precision.
/// @param hull  With |half| < semi_major.
/// @param bounds  kLanes of them [m].
using BoundFunction = void (*)(const ObstacleArrays&, int first, const HullQuery& hull,
                               float* bounds);

void bound_distances_baseline(const ObstacleArrays&, int, const HullQuery&, float*);
void bound_distances_avx2(const ObstacleArrays&, int, const HullQuery&, float*);
void bound_distances_avx512(const ObstacleArrays&, int, const HullQuery&, float*);

/// A capsule for the same, relative to the same origin: from a to a + v. All numbers are finite.
struct CapsuleQuery {
  float a[3], v[3];
  float inverse;  ///< 1 / |v|^2, 0 for a ball
  float radius;
};

/// The distances of kLanes points, from `first` on, less their radii, from the nearest of some
/// capsules, in single precision.
/// @param gaps  kLanes of them [m].
using GapFunction = void (*)(const ObstacleArrays&, int first, const CapsuleQuery* capsules,
                             int count, float* gaps);

void capsule_gaps_baseline(const ObstacleArrays&, int, const CapsuleQuery*, int, float*);
void capsule_gaps_avx2(const ObstacleArrays&, int, const CapsuleQuery*, int, float*);
void capsule_gaps_avx512(const ObstacleArrays&, int, const CapsuleQuery*, int, float*);

/// What is coarse, of one instruction set.
struct CoarseKernels {
  CullFunction cull;
  BoundFunction bound_distances;
  GapFunction capsule_gaps;
};

CoarseKernels baseline_coarse();
/// The widest that this processor runs and that the environment variable PDOIK_SIMD ("avx512",
/// "avx2" or "baseline") allows, chosen when first asked for. The variable lowers the level of this
/// and of the others, never raises it; any other value counts as none.
CoarseKernels best_coarse();
/// The level chosen: "avx512", "avx2" or "baseline".
const char* simd_name();

}  // namespace pdoik::detail
