#pragma once

#include "shapes/convex_distance.hpp"

namespace pdoik::detail {

/// The least value of a field at the points of a convex solid that moves in it, less the solid's
/// rounding, and how that changes. Of a ball and a capsule it is that of a segment. Of others it is
/// found by descent from the solid's corners, and from every cell of the field in it that has a
/// corner of less: it is the value of one of the solid's points, and more than the least at most by
/// what values change by from a cell's middle to its corner, where the least is one of a cell that
/// the solid's surface cuts. Allocates nothing.
/// @param moving, T_base_body  As of convex_distance.
/// @param field  A solid that is a field.
/// @param than  Where nothing is nearer than this, any number not below it may come back.
ConvexDistance convex_field_distance(const Solid& moving, const Frame& T_base_body,
                                     const Solid& field, double than);

}  // namespace pdoik::detail
