#include "simd/lanes.hpp"

namespace pdoik::detail {
namespace {

constexpr int kWidth = 2;
typedef double Row __attribute__((vector_size(16)));
typedef long long Mask __attribute__((vector_size(16)));

inline Row root(const Row& v) { return Row{__builtin_sqrt(v[0]), __builtin_sqrt(v[1])}; }
inline unsigned bits(const Mask& m) { return (m[0] != 0 ? 1U : 0U) | (m[1] != 0 ? 2U : 0U); }

#include "simd/lanes_body.inl"

}  // namespace

unsigned lane_tick_baseline(const LaneProblem& problem) { return tick(problem); }

}  // namespace pdoik::detail
