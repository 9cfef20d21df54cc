#include <immintrin.h>

#include "simd/cull.hpp"

namespace pdoik::detail {
namespace {

struct Lanes {
  static constexpr int kWidth = 8;
  static __m512d load(const double* p) { return _mm512_loadu_pd(p); }
  static __m512d set(double v) { return _mm512_set1_pd(v); }
  static unsigned less(__m512d a, __m512d b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
};

#include "simd/cull_body.inl"

}  // namespace

int cull_avx512(const ObstacleArrays& o, const HullQuery* hulls, int hull_count, NearPair* pairs) {
  return cull_with_lanes(o, hulls, hull_count, pairs);
}

}  // namespace pdoik::detail
