#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/large_vector.hpp"
#include "simd/vec4.hpp"

namespace pdoik::detail {

/// Puts points in the order of the cells that they lie in, in linear time: cells of a cube where
/// most of them are, along a Z-curve; what lies outside counts to the cells at its border. By a
/// radix sort of the cells' numbers.
class CellOrder {
 public:
  void reserve(std::size_t count);

  /// Where most of these points are follows from a sample of them: Vec4 point(int row).
  template <class PointAt>
  void begin(int count, PointAt&& point) {
    constexpr int kSample = 128;
    std::array<std::array<double, kSample>, 3> sample;
    const int taken = std::min(count, kSample);
    for (int k = 0; k < taken; ++k) {
      const Vec4 p = point(static_cast<int>(static_cast<std::int64_t>(k) * count / taken));
      for (std::size_t axis = 0; axis < 3; ++axis)
        sample[axis][static_cast<std::size_t>(k)] = p[static_cast<int>(axis)];
    }
    begin(count, {std::span(sample[0]).first(static_cast<std::size_t>(taken)),
                  std::span(sample[1]).first(static_cast<std::size_t>(taken)),
                  std::span(sample[2]).first(static_cast<std::size_t>(taken))});
  }
  void add(const Vec4& point) {
    const auto cell = [&](int axis) {
      // In this order of arguments what is no number counts to the first cell.
      return static_cast<std::int32_t>(
          std::min(last_, std::max(0.0, (point[axis] - centre_[axis]) * scale_ + half_)));
    };
    const std::uint32_t key = spread(cell(0)) | spread(cell(1)) << 1U | spread(cell(2)) << 2U;
    entries_[count_] = {key, static_cast<int>(count_)};
    ++count_;
    ++low_digits_[key & digit_mask_];
    ++high_digits_[key >> digit_bits_];
  }
  struct Entry {
    std::uint32_t cell;
    int row;
  };
  /// The points by the order in which they were added. Valid until the next begin.
  std::span<const Entry> sorted();

  const Eigen::Vector3d& centre() const { return centre_; }

 private:
  void begin(int count, std::array<std::span<double>, 3> sample);
  /// The binary digits of v, at most eight, with two zeros between each.
  static std::uint32_t spread(std::int32_t v) { return kSpread[static_cast<std::size_t>(v)]; }
  static constexpr std::array<std::uint32_t, 256> kSpread = [] {
    std::array<std::uint32_t, 256> spread{};
    for (std::uint32_t v = 0; v < 256; ++v)
      for (std::uint32_t bit = 0; bit < 8; ++bit) spread[v] |= (v >> bit & 1U) << (3U * bit);
    return spread;
  }();

  LargeVector<Entry> entries_, halfway_;
  std::vector<int> low_digits_, high_digits_;  ///< how often each comes, then where it goes next
  std::uint32_t digit_bits_ = 0, digit_mask_ = 0;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double scale_ = 1.0, half_ = 16.0, last_ = 31.0;  ///< of a side's cells
  std::size_t count_ = 0;
};

}  // namespace pdoik::detail
