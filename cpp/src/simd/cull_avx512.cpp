#include <immintrin.h>

#include "simd/cull.hpp"

namespace pdoik::detail {
namespace {

struct Lanes {
  static constexpr int kWidth = 16;
  static __m512 load(const float* p) { return _mm512_loadu_ps(p); }
  static __m512 set(float v) { return _mm512_set1_ps(v); }
  // Masked, with all lanes: GCC 12 warns of its own header otherwise.
  static __m512 max(__m512 a, __m512 b) { return _mm512_maskz_max_ps(0xFFFF, a, b); }
  static __m512 root(__m512 v) { return _mm512_maskz_sqrt_ps(0xFFFF, v); }
  static unsigned less(__m512 a, __m512 b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
};

#include "simd/cull_body.inl"

}  // namespace

int cull_avx512(const ObstacleArrays& o, const HullQuery* hulls, int hull_count, NearPair* pairs,
                int capacity, CullCursor& at) {
  return cull_with_lanes(o, hulls, hull_count, pairs, capacity, at);
}

void bound_distances_avx512(const ObstacleArrays& o, int first, const HullQuery& hull,
                            float* bounds) {
  bound_distances_with_lanes(o, first, hull, bounds);
}

void capsule_gaps_avx512(const ObstacleArrays& o, int first, const CapsuleQuery* capsules,
                         int count, float* gaps) {
  capsule_gaps_with_lanes(o, first, capsules, count, gaps);
}

}  // namespace pdoik::detail
