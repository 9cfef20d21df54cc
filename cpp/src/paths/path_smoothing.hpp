#pragma once

#include <vector>

#include "paths/path_cost.hpp"

namespace pdoik::detail {

/// Which points of a route stay where they are.
struct Kept {
  bool first = false, last = false;
};

/// Shorten a route in what its goals leave free: of each point the directions that leave its goals
/// met, in all of them at once the step of least motion, and back onto the path.
/// @returns Whether it became better.
bool smooth(PathStepper& stepper, const PathCost& cost, std::vector<PathPoint>& route, Kept kept);

}  // namespace pdoik::detail
