#include <immintrin.h>

#include "simd/lanes.hpp"

namespace pdoik::detail {
namespace {

constexpr int kWidth = 4;
typedef double Row __attribute__((vector_size(32)));
typedef long long Mask __attribute__((vector_size(32)));

inline Row root(const Row& v) { return Row(_mm256_sqrt_pd(__m256d(v))); }
inline unsigned bits(const Mask& m) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_castsi256_pd(__m256i(m))));
}

#include "simd/lanes_body.inl"

}  // namespace

unsigned lane_tick_avx2(const LaneProblem& problem) { return tick(problem); }

}  // namespace pdoik::detail
