#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>

namespace pdoik {

namespace detail {
class FieldData;
class Solid;
}  // namespace detail

/// Signed distances to surfaces on a grid, as nvblox, voxblox, Open3D and distance transforms give
/// them: positive outside of what is solid. Lengths in metres. It does not change, and a copy is
/// another handle of the same numbers.
///
/// Value (i, j, k) is that of the middle of the cell from (i, j, k) to (i + 1, j + 1, k + 1) edges.
/// Between the middles values are interpolated trilinearly. Where the values are exact distances,
/// an interpolated one is off by at most sqrt(3) / 2 cells, at edges and in gaps of a cell; beside
/// what is flat it is exact.
///
/// Outside of the middles' box, at q where that is nearest and d away, a point counts as
/// (value(q)^2 + d^2)^(1/2) from what is solid, no more than it is from anything inside the box; or
/// value(q) + d where q is in something.
class DistanceField {
 public:
  /// What cells hold whose distance is not known.
  enum class Unknown {
    Free,      ///< nothing: they are as far as what is known lets them be
    Occupied,  ///< something solid
  };
  /// How values are to be taken.
  struct Options {
    /// Values of at least this size say no more than that [m]: distances there follow from the
    /// other ones. Infinite if there are none such, negative to tell from the values: the largest,
    /// if a tenth of the cells hold it.
    double truncation = -1.0;
    Unknown unknown = Unknown::Free;  ///< what cells count as whose distance is not known
  };

  /// Take distances in. Large fields take a moment: some 0.1 s for 200^3 cells, and 1 s where
  /// distances that are truncated or unknown have to be found.
  /// @param values  Of cell (i, j, k) at (i counts[1] + j) counts[2] + k [m]. Not known is what is
  /// not finite, and one number that is farther from all others than the grid is wide, such as
  /// 1000.
  /// @param counts  Two cells along each axis at least.
  /// @param cell  A cell's edge [m].
  /// @throws std::invalid_argument  Another number of values, none that is known, a cell that is
  /// not positive; values that cannot be distances, since they change typically twice as fast from
  /// cell to cell as those lie apart, or nowhere half as fast.
  DistanceField(std::span<const float> values, const std::array<int, 3>& counts, double cell,
                const Options& options);
  /// The same with default options.
  DistanceField(std::span<const float> values, const std::array<int, 3>& counts, double cell)
      : DistanceField(values, counts, cell, Options{}) {}

  /// Cells along each axis.
  const std::array<int, 3>& counts() const;
  /// A cell's edge [m].
  double cell() const;
  /// As they are used: of every cell [m].
  std::span<const float> values() const;
  /// What an interpolated value changes by at most as a point moves, per length; at least 1.
  double steepest() const;

 private:
  friend class detail::Solid;
  std::shared_ptr<const detail::FieldData> data_;
};

}  // namespace pdoik
