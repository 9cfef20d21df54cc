#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace pdoik::detail {

/// Roberts' additive recurrence in d dimensions, x_k = frac(offset + k alpha) with alpha_i =
/// phi^-(i+1) and phi the positive root of x^(d+1) = x + 1. The offset comes from the seed
/// (splitmix64). Any term can be asked for alone, so restarts give the same starts in whatever
/// order they run.
class LowDiscrepancy {
 public:
  LowDiscrepancy(Eigen::Index dimensions, std::uint64_t seed)
      : alpha_(dimensions), offset_(dimensions) {
    double phi = 2.0;
    for (int i = 0; i < 64; ++i)
      phi = std::pow(1.0 + phi, 1.0 / (static_cast<double>(dimensions) + 1.0));
    double power = 1.0;
    for (Eigen::Index i = 0; i < dimensions; ++i) {
      power /= phi;
      alpha_[i] = power;
      offset_[i] = static_cast<double>(splitmix(seed) >> 11) * 0x1.0p-53;
    }
  }

  /// Coordinate i of term k, in [0, 1).
  double operator()(std::int64_t k, Eigen::Index i) const {
    const double x = offset_[i] + static_cast<double>(k) * alpha_[i];
    return x - std::floor(x);
  }

 private:
  static std::uint64_t splitmix(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }

  Eigen::VectorXd alpha_, offset_;
};

}  // namespace pdoik::detail
