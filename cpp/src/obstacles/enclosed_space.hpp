#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "pdoik/solver.hpp"

namespace pdoik::detail {

/// What a cloud's points enclose, by cells: those that hold a point are its surface, those that can
/// be reached from around the cloud through faces of cells without points are open, and the rest is
/// enclosed; fewer than eight cells together are gaps between points that scatter, and count as
/// surface. A surface lets nothing through if each of its points is nearer than half an edge to a
/// point of the cloud.
class EnclosedSpace {
 public:
  /// Empty is what is not known yet, during construction.
  enum class Kind : std::uint8_t { Empty, Enclosed, Open, Surface };

  /// @param points  (N, 3) [m]; rows with NaN or infinity are left out.
  /// @param edge  Of the cells [m], made larger for clouds so wide that there would be more than
  /// 2^26.
  EnclosedSpace(const Obstacles& points, double edge);

  double edge() const { return edge_; }
  Kind at(const Eigen::Vector3d& point) const;
  /// The first cell that holds no point on the way from `start` along a unit vector, within
  /// three edges; Surface if there is none.
  Kind beyond_surface(const Eigen::Vector3d& start, const Eigen::Vector3d& direction) const;

 private:
  using Cell = Eigen::Array<std::int64_t, 3, 1>;
  /// Turns a cell and all of its kind that are connected with it into another kind.
  /// @returns How many there are.
  std::int64_t flood(const Cell& start, Kind to);
  void close_gaps();
  Kind& kind(const Cell& cell) { return cells_[static_cast<std::size_t>(index(cell))]; }
  std::int64_t index(const Cell& cell) const {
    return (cell.x() * counts_.y() + cell.y()) * counts_.z() + cell.z();
  }

  double edge_;
  Eigen::Array3d low_ = Eigen::Array3d::Zero();
  Cell counts_ = Cell::Zero();
  std::vector<Kind> cells_;
};

}  // namespace pdoik::detail
