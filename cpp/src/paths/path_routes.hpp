#pragma once

#include <vector>

#include "paths/path_layers.hpp"

namespace pdoik::detail {

/// Whether a route may jump, from one motion to another.
enum class Jumps { None, Allowed };

/// The best route from the first layer to the last along what is not known to be bad, or nothing.
/// With jumps: one that has the fewest of them, each between two nodes of one layer, or to the next
/// layer where there is no other way; if the last layers have no nodes, as far as there are any.
/// @param from  The node of the first layer that it begins at; less than 0 for any.
PathLayers::Route best_route(const PathLayers& layers, Jumps jumps, int from = -1);

/// What the best route without jumps costs from each node of the first layer; infinite where there
/// is none. Of a closed path it may end anywhere.
std::vector<double> costs_of_beginnings(const PathLayers& layers);

/// The first layer that no route from the first gets to; the number of layers if all are.
int cut(const PathLayers& layers);

}  // namespace pdoik::detail
