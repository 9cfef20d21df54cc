#pragma once

#include <limits>

#include "detail/solid.hpp"

namespace pdoik::detail {

/// Where a solid on a moving body comes nearest to one that stands still.
struct ConvexDistance {
  double distance;  ///< negative by how far it would have to move to come clear [m]
  Vec4 point;       ///< of the moving solid, or within it by its rounding
  Vec4 gradient;    ///< how the distance changes as its body moves that point
};

/// The signed distance of a convex solid and another, or the nearest piece of that: by the method
/// of Gilbert, Johnson and Keerthi where they are apart, by expanding a polytope within their
/// difference (van den Bergen, "Proximity Queries and Penetration Depth Computation on 3D Game
/// Objects", 2001) where they are not. Exact to 1e-9 m of what has flat faces; inside each other to
/// 1e-6 m of what is round. Of a field see convex_field_distance. Allocates nothing.
/// @param moving  In the frame of its body. No half-space.
/// @param T_base_body  Where that is.
/// @param still  In the base frame.
/// @param than  Where they are no nearer than this, any number not below it may come back.
ConvexDistance convex_distance(const Solid& moving, const Frame& T_base_body, const Solid& still,
                               double than = std::numeric_limits<double>::infinity());

}  // namespace pdoik::detail
