#pragma once

#include <Eigen/Core>

#include "pdoik/solver.hpp"

namespace pdoik {

/// Points, one row each, x y z [m].
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// One point, the mean, for each cell of a grid anchored at the origin that holds any (PCL's
/// VoxelGrid).
///
/// PCL computes in float32: a point within about 6e-8 times its coordinate of a cell's wall may
/// fall into the neighbouring cell, and the mean of n points is off by at most about n 6e-8 times
/// the largest coordinate (n small, as in a cell: micrometres per metre).
/// @param points  (N, 3). Rows with NaN or infinity, as depth cameras give, are left out. May be
/// empty.
/// @param leaf  Edge of the cubic cells [m].
/// @throws std::invalid_argument if leaf is not positive and finite, if the shape is wrong, or if
/// the grid
///     would have more cells than PCL's 32-bit index holds (PCL returns such a cloud unfiltered).
Points voxel_downsample(const Obstacles& points, double leaf);

}  // namespace pdoik
