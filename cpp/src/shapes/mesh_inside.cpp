#include "shapes/mesh_inside.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shapes/cell_grid.hpp"

namespace pdoik::detail {
namespace {

using Eigen::Vector3d;

/// The grid begins this much of a cell below the surface, so that no vertex of a tidy mesh lies
/// where cells have their middles.
constexpr double kShift = 0.6180339887;

class Filling {
 public:
  explicit Filling(const Eigen::AlignedBox3d& box)
      : edge_(box.sizes().maxCoeff() / kCellsInside),
        low_(box.min() - Vector3d::Constant(kShift * edge_)),
        grid_(counts_of(box, edge_)),
        crossings_(static_cast<std::size_t>(grid_.counts[0]) *
                   static_cast<std::size_t>(grid_.counts[1])) {}

  /// Note where columns of cells' middles go through a triangle, upwards or downwards.
  void cross(const Triangle& triangle) {
    const Vec4 &a = triangle.a, &ab = triangle.ab, &ac = triangle.ac;
    const double area = ab[0] * ac[1] - ab[1] * ac[0];
    if (area == 0.0) return;
    const auto [first, last] = cells_of(triangle, 0.0);
    for (int i = first[0]; i <= last[0]; ++i) {
      for (int j = first[1]; j <= last[1]; ++j) {
        const Vector3d middle = middle_of(i, j, 0);
        const double x = middle.x() - a[0], y = middle.y() - a[1];
        const double u = (x * ac[1] - y * ac[0]) / area, v = (ab[0] * y - ab[1] * x) / area;
        if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
        column(i, j).push_back({a[2] + u * ab[2] + v * ac[2], area > 0.0 ? -1 : 1});
      }
    }
  }

  /// Take the cells whose middles the surface goes around.
  void fill() {
    for (int i = 0; i < grid_.counts[0]; ++i) {
      for (int j = 0; j < grid_.counts[1]; ++j) {
        std::vector<Crossing>& through = column(i, j);
        std::ranges::sort(through, {}, &Crossing::height);
        int turns = 0, k = 0;
        for (const Crossing& crossing : through) turns += crossing.turn;
        if (turns != 0) continue;  // it has met an edge, and one side of it only
        for (const Crossing& crossing : through) {
          for (; k < grid_.counts[2] && middle_of(i, j, k).z() < crossing.height; ++k)
            grid_.taken[grid_.at(i, j, k)] = turns != 0;
          turns += crossing.turn;
        }
      }
    }
  }

  /// Free the cells whose balls meet a triangle.
  void clear(const Triangle& triangle) {
    const double reach = 0.5 * std::sqrt(3.0) * edge_;
    const auto [first, last] = cells_of(triangle, reach);
    int up = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (std::abs(triangle.normal[axis]) > std::abs(triangle.normal[up])) up = axis;
    const int one = (up + 1) % 3, other = (up + 2) % 3;
    const double slope = triangle.normal[up], thick = reach / std::abs(slope);
    Eigen::Vector3i cell = first;
    for (cell[one] = first[one]; cell[one] <= last[one]; ++cell[one]) {
      for (cell[other] = first[other]; cell[other] <= last[other]; ++cell[other]) {
        cell[up] = 0;
        const Vector3d foot = middle_of(cell[0], cell[1], cell[2]);
        const double height = -triangle.above(to_vec4(foot)) / slope;  // of the plane above it
        const int from = static_cast<int>(std::floor((height - thick) / edge_)),
                  to = static_cast<int>(std::ceil((height + thick) / edge_));
        for (cell[up] = std::max(first[up], from); cell[up] <= std::min(last[up], to); ++cell[up]) {
          std::uint8_t& taken = grid_.taken[grid_.at(cell[0], cell[1], cell[2])];
          if (taken == 0) continue;
          const Vec4 middle = to_vec4(middle_of(cell[0], cell[1], cell[2]));
          if (distance_to(triangle, middle, Vec4{}, reach).distance < reach) taken = 0;
        }
      }
    }
  }

  std::vector<Eigen::AlignedBox3d> boxes() {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const CellBox& box : grid_.take_boxes())
      boxes.emplace_back(low_ + edge_ * box.low.cast<double>(),
                         low_ + edge_ * box.high.cast<double>());
    return boxes;
  }

 private:
  struct Crossing {
    double height;
    int turn;
  };

  static std::array<int, 3> counts_of(const Eigen::AlignedBox3d& box, double edge) {
    std::array<int, 3> counts;
    for (int i = 0; i < 3; ++i)
      counts[static_cast<std::size_t>(i)] = static_cast<int>(box.sizes()[i] / edge + kShift) + 1;
    return counts;
  }
  Vector3d middle_of(int i, int j, int k) const {
    return low_ + edge_ * (Vector3d(i, j, k) + Vector3d::Constant(0.5));
  }
  std::vector<Crossing>& column(int i, int j) {
    return crossings_[static_cast<std::size_t>(i) * static_cast<std::size_t>(grid_.counts[1]) +
                      static_cast<std::size_t>(j)];
  }
  /// The first and the last cells that may have their middles within a reach of a triangle.
  std::pair<Eigen::Vector3i, Eigen::Vector3i> cells_of(const Triangle& t, double reach) const {
    Eigen::Vector3i first, last;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [least, most] = std::minmax({0.0, t.ab[axis], t.ac[axis]});
      const double low = (t.a[axis] + least - reach - low_[axis]) / edge_ - 0.5,
                   high = (t.a[axis] + most + reach - low_[axis]) / edge_ - 0.5;
      first[axis] = std::max(0, static_cast<int>(std::floor(low)));
      last[axis] = std::min(grid_.counts[static_cast<std::size_t>(axis)] - 1,
                            static_cast<int>(std::ceil(high)));
    }
    return {first, last};
  }

  double edge_;
  Vector3d low_;
  CellGrid grid_;
  std::vector<std::vector<Crossing>> crossings_;
};

}  // namespace

std::vector<Eigen::AlignedBox3d> boxes_inside(std::span<const Triangle> triangles,
                                              const Eigen::AlignedBox3d& box) {
  Filling filling(box);
  for (const Triangle& triangle : triangles) filling.cross(triangle);
  filling.fill();
  for (const Triangle& triangle : triangles) filling.clear(triangle);
  return filling.boxes();
}

}  // namespace pdoik::detail
