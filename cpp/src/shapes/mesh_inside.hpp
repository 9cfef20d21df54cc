#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "shapes/triangle.hpp"

namespace pdoik::detail {

/// Boxes inside a closed surface, by its winding number: all cells of a grid, kCellsInside along
/// the longest side, whose balls the surface does not meet. Of what lies deeper inside than the
/// diagonal of a cell some is in a box.
/// @param box  That holds the triangles.
std::vector<Eigen::AlignedBox3d> boxes_inside(std::span<const Triangle> triangles,
                                              const Eigen::AlignedBox3d& box);

constexpr int kCellsInside = 72;

}  // namespace pdoik::detail
