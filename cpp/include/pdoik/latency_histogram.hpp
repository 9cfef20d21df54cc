#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace pdoik {

/// How long something took, over many times: counts in bins that are a twelfth of an octave wide,
/// from 0.1 microseconds up. Fixed memory; adding to it takes nanoseconds.
class LatencyHistogram {
 public:
  /// Count one more.
  void add(double seconds) {
    ++count_;
    max_ = seconds > max_ ? seconds : max_;
    const double bin = seconds > kLeast ? kPerOctave * std::log2(seconds / kLeast) : 0.0;
    const auto k = static_cast<std::size_t>(bin);
    ++bins_[k < kBins ? k : kBins - 1];
  }
  /// As if nothing had been added.
  void clear() { *this = {}; }

  /// How many were added.
  std::uint64_t count() const { return count_; }
  double max() const { return max_; }  ///< [s]; 0 if nothing was added

  /// The time that a share of all took at most, to 6 %: the upper end of its bin, and never above
  /// max() [s].
  /// @param share  0 to 1.
  double quantile(double share) const {
    const double wanted = share * static_cast<double>(count_);
    std::uint64_t below = 0;
    for (std::size_t k = 0; k < kBins; ++k) {
      below += bins_[k];
      if (static_cast<double>(below) >= wanted && below > 0)
        return k + 1 < kBins ? std::fmin(upper_edge(k), max_) : max_;
    }
    return max_;
  }

  static constexpr std::size_t kBins = 320;  ///< up to 10 s
  /// The upper end of a bin [s]; all that is longer falls into the last.
  static double upper_edge(std::size_t bin) {
    return kLeast * std::exp2(static_cast<double>(bin + 1) / kPerOctave);
  }
  /// Counts, bin by bin.
  const std::array<std::uint64_t, kBins>& bins() const { return bins_; }

 private:
  static constexpr double kLeast = 1e-7, kPerOctave = 12.0;
  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  double max_ = 0.0;
};

}  // namespace pdoik
