#pragma once

#include <optional>

#include "arrays.hpp"
#include "pdoik/interior_spheres.hpp"

namespace pdoik::python {

/// How points are thinned before they are taken in.
struct Thinning {
  double leaf;
  bool radii = false;
  bool solid = false;
};

inline constexpr const char* kNotSolid = "viewpoint is for solid clouds, and solid is False";

/// No rows for None, one for shape (3,), else (N, 3).
Points to_viewpoints(const std::optional<ArrayLike>& viewpoint);

/// What thinning leaves, (K, 3), or (K, 4) with radii.
RowMatrix thin(const Obstacles& points, const Thinning& thinning,
               const InteriorSphereOptions& sink);

}  // namespace pdoik::python
