#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pdoik::detail {

/// Cells from `low` to before `high`.
struct CellBox {
  Eigen::Vector3i low, high;
};

/// Cells of a grid, some of which are taken.
struct CellGrid {
  explicit CellGrid(const std::array<int, 3>& counts_in);

  std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(counts[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(counts[2]) +
           static_cast<std::size_t>(k);
  }
  /// Boxes that hold each taken cell once and no other, each as long as can be along z, then y,
  /// then x. No cell is taken afterwards.
  std::vector<CellBox> take_boxes();

  std::array<int, 3> counts;
  std::vector<std::uint8_t> taken;
};

}  // namespace pdoik::detail
