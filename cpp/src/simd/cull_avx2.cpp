#include <immintrin.h>

#include "simd/cull.hpp"

namespace pdoik::detail {
namespace {

struct Lanes {
  static constexpr int kWidth = 8;
  static __m256 load(const float* p) { return _mm256_loadu_ps(p); }
  static __m256 set(float v) { return _mm256_set1_ps(v); }
  static __m256 max(__m256 a, __m256 b) { return _mm256_max_ps(a, b); }
  static __m256 root(__m256 v) { return _mm256_sqrt_ps(v); }
  static unsigned less(__m256 a, __m256 b) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)));
  }
};

#include "simd/cull_body.inl"

}  // namespace

int cull_avx2(const ObstacleArrays& o, const HullQuery* hulls, int hull_count, NearPair* pairs,
              int capacity, CullCursor& at) {
  return cull_with_lanes(o, hulls, hull_count, pairs, capacity, at);
}

void bound_distances_avx2(const ObstacleArrays& o, int first, const HullQuery& hull,
                          float* bounds) {
  bound_distances_with_lanes(o, first, hull, bounds);
}

void capsule_gaps_avx2(const ObstacleArrays& o, int first, const CapsuleQuery* capsules, int count,
                       float* gaps) {
  capsule_gaps_with_lanes(o, first, capsules, count, gaps);
}

}  // namespace pdoik::detail
