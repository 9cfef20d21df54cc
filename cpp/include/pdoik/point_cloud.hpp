#pragma once

#include <Eigen/Core>

#include "pdoik/solver.hpp"

namespace pdoik {

/// Points, one row each, x y z [m].
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// One point, the mean, for each cell of a grid anchored at the origin that holds any (PCL's
/// VoxelGrid). In pdoik::io.
///
/// PCL computes in float32: a point within about 6e-8 times its coordinate of a cell's wall may
/// fall into the neighbouring cell, and the mean of n points is off by at most about n 6e-8 times
/// the largest coordinate (n small, as in a cell: micrometres per metre).
/// @param points  (N, 3). Rows with NaN or infinity, as depth cameras give, are left out. May be
/// empty.
/// @param leaf  Edge of the cubic cells [m].
/// @throws std::invalid_argument if leaf is not positive and finite, if the shape is wrong, or if
/// the grid would have more cells than PCL's 32-bit index holds (PCL returns such a cloud
/// unfiltered).
Points voxel_downsample(const Obstacles& points, double leaf);

/// For each kept point the radius of a ball about it, such that the balls hold every point of the
/// cloud that it stands for: so a solver keeps off all of them, not only off those kept.
/// @param points  (N, 3), the cloud before thinning; rows with NaN or infinity are left out.
/// @param kept  (K, 3), such as voxel_downsample's. Each point belongs to the nearest of those in
/// its own cell and the 26 around it.
/// @param leaf  Edge of the cells that find neighbours [m].
/// @returns (K,) [m], 0 where nothing belongs to a kept point.
/// @throws std::invalid_argument as voxel_downsample does, and if some point has no kept one near.
Eigen::VectorXd covering_radii(const Obstacles& points, const Points& kept, double leaf);

}  // namespace pdoik
