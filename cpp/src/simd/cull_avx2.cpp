#include <immintrin.h>

#include "simd/cull.hpp"

namespace pdoik::detail {
namespace {

struct Lanes {
  static constexpr int kWidth = 4;
  static __m256d load(const double* p) { return _mm256_loadu_pd(p); }
  static __m256d set(double v) { return _mm256_set1_pd(v); }
  static unsigned less(__m256d a, __m256d b) {
    return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ)));
  }
};

#include "simd/cull_body.inl"

}  // namespace

int cull_avx2(const ObstacleArrays& o, const HullQuery* hulls, int hull_count, NearPair* pairs) {
  return cull_with_lanes(o, hulls, hull_count, pairs);
}

}  // namespace pdoik::detail
