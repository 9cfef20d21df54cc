#include "simd/cull.hpp"

namespace pdoik::detail {
namespace {

struct Lanes {
  static constexpr int kWidth = 1;
  static float load(const float* p) { return *p; }
  static float set(float v) { return v; }
  static float max(float a, float b) { return a > b ? a : b; }
  static float root(float v) { return __builtin_sqrtf(v); }
  static unsigned less(float a, float b) { return a < b ? 1U : 0U; }
};

#include "simd/cull_body.inl"

}  // namespace

int cull_baseline(const ObstacleArrays& o, const HullQuery* hulls, int hull_count, NearPair* pairs,
                  int capacity, CullCursor& at) {
  return cull_with_lanes(o, hulls, hull_count, pairs, capacity, at);
}

void bound_distances_baseline(const ObstacleArrays& o, int first, const HullQuery& hull,
                              float* bounds) {
  bound_distances_with_lanes(o, first, hull, bounds);
}

void capsule_gaps_baseline(const ObstacleArrays& o, int first, const CapsuleQuery* capsules,
                           int count, float* gaps) {
  capsule_gaps_with_lanes(o, first, capsules, count, gaps);
}

}  // namespace pdoik::detail
