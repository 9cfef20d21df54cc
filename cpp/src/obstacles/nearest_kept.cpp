#include "obstacles/nearest_kept.hpp"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace pdoik::detail {
namespace {

using Cell = Eigen::Array<std::int64_t, 3, 1>;

struct CellHash {
  std::size_t operator()(const Cell& cell) const {
    std::uint64_t hash = 0;
    for (const std::int64_t index : cell)
      hash = (hash ^ static_cast<std::uint64_t>(index)) * 0x9E3779B97F4A7C15ull;
    return hash ^ (hash >> 32);
  }
};
struct SameCell {
  bool operator()(const Cell& a, const Cell& b) const { return (a == b).all(); }
};

/// The kept points by their cells.
class Grid {
 public:
  Grid(const Points& kept, double leaf) : kept_(kept), leaf_(leaf) {
    rows_.reserve(static_cast<std::size_t>(kept.rows()));
    for (Eigen::Index k = 0; k < kept.rows(); ++k) {
      if (!kept.row(k).allFinite()) throw std::invalid_argument("kept holds NaN or infinity");
      rows_[cell_of(kept.row(k).transpose())].push_back(k);
    }
  }

  struct Nearest {
    Eigen::Index row = -1;
    double squared = 0.0;
  };

  /// The nearest kept point in the cells around p: first its own, then those that may beat it.
  Nearest nearest(const Eigen::Array3d& p) const {
    Nearest best{-1, 1e300};
    const Cell own = cell_of(p);
    look(own, p, best);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const Cell cell = own + Cell(x, y, z);
          if (!(cell == own).all() && squared_distance(p, cell) < best.squared) look(cell, p, best);
        }
      }
    }
    return best;
  }

 private:
  Cell cell_of(const Eigen::Array3d& p) const { return (p / leaf_).floor().cast<std::int64_t>(); }

  double squared_distance(const Eigen::Array3d& p, const Cell& cell) const {
    const Eigen::Array3d low = cell.cast<double>() * leaf_;
    return (low - p).max(p - low - leaf_).max(0.0).square().sum();
  }

  void look(const Cell& cell, const Eigen::Array3d& p, Nearest& best) const {
    const auto found = rows_.find(cell);
    if (found == rows_.end()) return;
    for (const Eigen::Index row : found->second) {
      const double squared = (kept_.row(row).transpose().array() - p).square().sum();
      if (squared < best.squared) best = {row, squared};
    }
  }

  const Points& kept_;
  double leaf_;
  std::unordered_map<Cell, std::vector<Eigen::Index>, CellHash, SameCell> rows_;
};

}  // namespace

std::vector<Eigen::Index> nearest_kept(const Obstacles& points, const Points& kept, double leaf) {
  if (!(leaf > 0.0 && std::isfinite(leaf)))
    throw std::invalid_argument("leaf is " + std::to_string(leaf) +
                                ", expected a positive finite length [m]");
  std::vector<Eigen::Index> rows(static_cast<std::size_t>(points.rows()), -1);
  if (points.rows() == 0) return rows;
  if (points.cols() != 3)
    throw std::invalid_argument("points has " + std::to_string(points.cols()) +
                                " columns, expected 3");
  const Grid grid(kept, leaf);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Array3d p = points.row(i).transpose();
    if (!p.isFinite().all()) continue;
    const Eigen::Index row = grid.nearest(p).row;
    if (row < 0)
      throw std::invalid_argument("points has no kept point near row " + std::to_string(i));
    rows[static_cast<std::size_t>(i)] = row;
  }
  return rows;
}

}  // namespace pdoik::detail
