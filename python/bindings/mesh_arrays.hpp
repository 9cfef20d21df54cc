#pragma once

#include <array>
#include <vector>

#include "arrays.hpp"

namespace pdoik::python {

/// @throws std::invalid_argument  Another shape than (N, 3).
std::vector<Eigen::Vector3d> to_vertices(const ArrayLike& values);

/// Places in vertices; -1 for what is no int.
/// @throws std::invalid_argument  No whole numbers, or another shape than (T, 3).
std::vector<std::array<int, 3>> to_triangles(const ArrayLike& values);

}  // namespace pdoik::python
