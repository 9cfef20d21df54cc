#pragma once

#include <limits>

#include "shapes/solid.hpp"

namespace pdoik::detail {

/// Where a solid on a moving body comes nearest to one that stands still.
struct ConvexDistance {
  double distance;  ///< negative by how far it would have to move to come clear [m]
  Vec4 point;       ///< of the moving solid, or within it by its rounding
  Vec4 gradient;    ///< how the distance changes as its body moves that point
};

/// How deep solids are in each other: to be measured, or not to be known.
enum class HowDeep { Measured, Unknown };

/// The signed distance of a convex solid and another, or the nearest piece of that: by the method
/// of Gilbert, Johnson and Keerthi where they are apart, by expanding a polytope within their
/// difference (van den Bergen, "Proximity Queries and Penetration Depth Computation on 3D Game
/// Objects", 2001) where they are not. Exact to 1e-9 m of what has flat faces; inside each other to
/// 1e-6 m of what is round. Of a field see convex_field_distance. Allocates nothing.
/// @param moving  In the frame of its body. No half-space.
/// @param T_base_body  Where that is.
/// @param still  In the base frame.
/// @param than  Where they are no nearer than this, any number not below it may come back.
/// @param how_deep  Where it need not be known, and `than` is not below 0, solids that are in each
/// other may be called barely so.
ConvexDistance convex_distance(const Solid& moving, const Frame& T_base_body, const Solid& still,
                               double than = std::numeric_limits<double>::infinity(),
                               HowDeep how_deep = HowDeep::Measured);

/// How far two convex solids stand apart along a unit vector from the one that stands still:
/// nothing of them is nearer than that, and none need move farther to come clear. Neither is a
/// half-space, a field or a surface.
double separation(const Solid& moving, const Frame& T_base_body, const Solid& still,
                  const Vec4& along);

}  // namespace pdoik::detail
