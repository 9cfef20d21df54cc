#include "simd/cull.hpp"

namespace pdoik::detail {
namespace {

struct Lanes {
  static constexpr int kWidth = 1;
  static double load(const double* p) { return *p; }
  static double set(double v) { return v; }
  static unsigned less(double a, double b) { return a < b ? 1U : 0U; }
};

#include "simd/cull_body.inl"

}  // namespace

int cull_baseline(const ObstacleArrays& o, const HullQuery* hulls, int hull_count, NearPair* pairs) {
  return cull_with_lanes(o, hulls, hull_count, pairs);
}

}  // namespace pdoik::detail
