#pragma once

#include <array>
#include <vector>

#include "common/large_vector.hpp"
#include "pdoik/distance_field.hpp"

namespace pdoik::detail {

/// Give each cell of a grid a distance where some are truncated or not known: the most that others
/// let it have, min over known cells of their value plus how far they are, found by handing on from
/// cell to cell which one that is (Danielsson, "Euclidean distance mapping", 1980). It is too large
/// by a fraction of a cell where known values are exact.
/// @param values  Not finite where not known.
/// @param truncation  Of values of this size and more only that is known [m]; infinite for none.
void spread_distances(LargeVector<float>& values, const std::array<int, 3>& counts, double cell,
                      double truncation, DistanceField::Unknown unknown);

}  // namespace pdoik::detail
