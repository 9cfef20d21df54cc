#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "common/large_vector.hpp"
#include "pdoik/distance_field.hpp"
#include "simd/vec4.hpp"

namespace pdoik::detail {

/// What a block of a field's cells is like, between kBrick + 1 values along each axis: close to a
/// value that changes evenly.
struct Brick {
  float least;     ///< of its values [m]
  float middle;    ///< at the middle of a whole brick, evenly changing [m]
  float slope[3];  ///< of that, per cell [m]
  float off;       ///< no value is farther from it than this [m]
};

/// What DistanceField shares. Places are in cells, value (i, j, k) at i, j, k.
class FieldData {
 public:
  static constexpr int kBrick = 8;

  /// @param values  Finite.
  FieldData(LargeVector<float> values, const std::array<int, 3>& counts, double cell);

  const std::array<int, 3>& counts() const { return counts_; }
  double cell() const { return cell_; }
  std::span<const float> values() const { return values_; }
  double steepest() const { return steepest_; }
  /// How deep the deepest value is, at least 0 [m].
  double deepest() const { return deepest_; }

  /// The last place along an axis.
  double last(int axis) const { return counts_[static_cast<std::size_t>(axis)] - 1.0; }

  const float* at(int i, int j, int k) const {
    return values_.data() +
           (static_cast<std::size_t>(i) * static_cast<std::size_t>(counts_[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(counts_[2]) +
           static_cast<std::size_t>(k);
  }
  /// From one value to the next along x and y.
  std::ptrdiff_t stride_x() const { return static_cast<std::ptrdiff_t>(counts_[1]) * counts_[2]; }
  std::ptrdiff_t stride_y() const { return counts_[2]; }

  /// Of the cell from (i, j, k) on.
  const Brick& brick_of(int i, int j, int k) const {
    return bricks_[(static_cast<std::size_t>(i / kBrick) *
                        static_cast<std::size_t>(brick_counts_[1]) +
                    static_cast<std::size_t>(j / kBrick)) *
                       static_cast<std::size_t>(brick_counts_[2]) +
                   static_cast<std::size_t>(k / kBrick)];
  }
  /// What a brick's values are about, at a place.
  static double evenly(const Brick& brick, const std::array<int, 3>& first, const Vec4& place) {
    constexpr double kHalf = 0.5 * kBrick;
    double sum = static_cast<double>(brick.middle);
    for (int a = 0; a < 3; ++a)
      sum += static_cast<double>(brick.slope[a]) *
             (place[a] - first[static_cast<std::size_t>(a)] - kHalf);
    return sum;
  }

 private:
  Brick measured(const std::array<int, 3>& first) const;

  LargeVector<float> values_;
  std::array<int, 3> counts_, brick_counts_;
  double cell_, steepest_ = 1.0, deepest_ = 0.0;
  std::vector<Brick> bricks_;
};

}  // namespace pdoik::detail
