#include "obstacles/enclosed_space.hpp"

#include <cmath>

namespace pdoik::detail {

EnclosedSpace::EnclosedSpace(const Obstacles& points, double edge) : edge_(edge) {
  constexpr double kMostCells = 1 << 26;
  Eigen::Array3d low = Eigen::Array3d::Constant(1e300), high = -low;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Array3d p = points.row(i).transpose();
    if (!p.isFinite().all()) continue;
    low = low.min(p);
    high = high.max(p);
  }
  if (!(low <= high).all()) return;
  const auto count_of = [&](double length) {
    return (((high - low) / length).floor() + 4.0).eval();  // open layers on every side
  };
  while (count_of(edge_).prod() > kMostCells) edge_ *= 1.1;
  low_ = low - 1.5 * edge_;  // half a cell off, for rounding must not reach the outermost layer
  counts_ = count_of(edge_).cast<std::int64_t>();
  cells_.assign(static_cast<std::size_t>(counts_.prod()), Kind::Empty);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Array3d p = points.row(i).transpose();
    if (!p.isFinite().all()) continue;
    const Cell cell = ((p - low_) / edge_).floor().cast<std::int64_t>();
    kind(cell) = Kind::Surface;
  }
  flood(Cell::Zero(), Kind::Open);
  close_gaps();
}

std::int64_t EnclosedSpace::flood(const Cell& start, Kind to) {
  const Kind from = kind(start);
  std::vector<Cell> front{start};
  kind(start) = to;
  std::int64_t count = 0;
  while (!front.empty()) {
    const Cell cell = front.back();
    front.pop_back();
    ++count;
    for (int axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        Cell next = cell;
        next[axis] += step;
        if (next[axis] < 0 || next[axis] >= counts_[axis] || kind(next) != from) continue;
        kind(next) = to;
        front.push_back(next);
      }
    }
  }
  return count;
}

void EnclosedSpace::close_gaps() {
  constexpr std::int64_t kFewest = 8;
  Cell cell;
  for (cell.x() = 0; cell.x() < counts_.x(); ++cell.x()) {
    for (cell.y() = 0; cell.y() < counts_.y(); ++cell.y()) {
      for (cell.z() = 0; cell.z() < counts_.z(); ++cell.z()) {
        if (kind(cell) != Kind::Empty) continue;
        if (flood(cell, Kind::Enclosed) < kFewest) flood(cell, Kind::Surface);
      }
    }
  }
}

EnclosedSpace::Kind EnclosedSpace::at(const Eigen::Vector3d& point) const {
  const Eigen::Array3d place = ((point.array() - low_) / edge_).floor();
  if (!(place >= 0.0).all() || !(place < counts_.cast<double>()).all()) return Kind::Open;
  return cells_[static_cast<std::size_t>(index(place.cast<std::int64_t>()))];
}

EnclosedSpace::Kind EnclosedSpace::beyond_surface(const Eigen::Vector3d& start,
                                                  const Eigen::Vector3d& direction) const {
  for (int k = 1; k <= 6; ++k) {
    const Kind kind = at(start + 0.5 * k * edge_ * direction);
    if (kind != Kind::Surface) return kind;
  }
  return Kind::Surface;
}

}  // namespace pdoik::detail
