#pragma once

#include <vector>

#include "pdoik/point_cloud.hpp"

namespace pdoik::detail {

/// For each point of a cloud the row of the kept one that stands for it: the nearest of those in
/// its own cell and the 26 around it; -1 for rows with NaN or infinity.
/// @throws std::invalid_argument as covering_radii.
std::vector<Eigen::Index> nearest_kept(const Obstacles& points, const Points& kept, double leaf);

}  // namespace pdoik::detail
