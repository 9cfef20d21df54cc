#pragma once

#include "shapes/field_data.hpp"
#include "shapes/solid_distance.hpp"

namespace pdoik::detail {

/// Distances of what is placed in a field's own frame, where cell (i, j, k) begins at i, j, k
/// edges [m].

/// Of a point, with the exact gradient of the interpolation, which is no unit vector.
SolidDistance field_distance(const FieldData& field, const Vec4& p);

/// The least of a segment's points middle + t half, -1 <= t <= 1: exact to a micrometre within the
/// box of the cells' middles; outside of it, of several minima within one cell it may be one that
/// is not the least.
/// @param than  Where nothing is nearer than this, any number not below it may come back.
SegmentSolidDistance field_distance(const FieldData& field, const Vec4& middle, const Vec4& half,
                                    double than);

}  // namespace pdoik::detail
