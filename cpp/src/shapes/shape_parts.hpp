#pragma once

#include <vector>

#include "shapes/solid.hpp"

namespace pdoik::detail {

/// What a shape is made of: itself if it is convex; the boxes; of a mesh its surface in parts of
/// triangles that lie side by side, and of a closed one boxes inside.
/// @throws std::invalid_argument  As check_shape.
std::vector<Solid> parts_of(const Shape& shape);

}  // namespace pdoik::detail
