#include "shapes/cell_grid.hpp"

namespace pdoik::detail {

CellGrid::CellGrid(const std::array<int, 3>& counts_in)
    : counts(counts_in),
      taken(static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
            static_cast<std::size_t>(counts[2])) {}

std::vector<CellBox> CellGrid::take_boxes() {
  std::vector<CellBox> boxes;
  const auto is_full = [&](const Eigen::Vector3i& low, const Eigen::Vector3i& high) {
    for (int i = low[0]; i < high[0]; ++i) {
      for (int j = low[1]; j < high[1]; ++j) {
        for (int k = low[2]; k < high[2]; ++k) {
          if (taken[at(i, j, k)] == 0) return false;
        }
      }
    }
    return true;
  };
  const auto take_from = [&](const Eigen::Vector3i& low) {
    Eigen::Vector3i high = low + Eigen::Vector3i::Ones();
    for (int axis = 2; axis >= 0; --axis) {
      const auto a = static_cast<std::size_t>(axis);
      while (high[axis] < counts[a]) {
        Eigen::Vector3i first = low, last = high;
        first[axis] = high[axis];
        ++last[axis];
        if (!is_full(first, last)) break;
        ++high[axis];
      }
    }
    for (int i = low[0]; i < high[0]; ++i) {
      for (int j = low[1]; j < high[1]; ++j) {
        for (int k = low[2]; k < high[2]; ++k) taken[at(i, j, k)] = 0;
      }
    }
    boxes.push_back({low, high});
  };
  for (int i = 0; i < counts[0]; ++i) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int k = 0; k < counts[2]; ++k) {
        if (taken[at(i, j, k)] != 0) take_from({i, j, k});
      }
    }
  }
  return boxes;
}

}  // namespace pdoik::detail
