#pragma once

#include <limits>
#include <vector>

#include "obstacles/collision_state.hpp"

namespace pdoik::detail {

/// The least distance from an obstacle (less its radius) to a hull, and which.
struct Clearance {
  double distance = std::numeric_limits<double>::infinity();
  int source = -1;    ///< the hull's place in the occupancy
  int obstacle = -1;  ///< the obstacle's original row
};

/// Exact Euclidean clearance of the state's hulls where it is placed, if below `than`, among the
/// pairs that are within g of each other, at least. Changes the state's near pairs.
Clearance least_clearance_within(CollisionState& state, const ObstacleView& obstacles, double g,
                                 Clearance than = {});

/// The same of one of the state's hulls, if below `than`.
Clearance least_clearance_of(CollisionState& state, std::size_t hull, const ObstacleView& obstacles,
                             double than);

/// Whether an obstacle is nearer than this to one of the state's hulls.
bool any_nearer(CollisionState& state, std::size_t hull, const ObstacleView& obstacles,
                double than);

/// Add to `places` those of the obstacles that are within a distance of the state's hulls, some
/// more than once. Changes the state's near pairs.
void find_within(CollisionState& state, const ObstacleView& obstacles, double distance,
                 std::vector<int>& places);

/// The same among all, by growing the hulls until obstacles come to lie in them: points nearer than
/// g to a hull lie in it when it is grown by g, so once the least is below g it is found.
Clearance least_clearance(CollisionState& state, const ObstacleView& obstacles,
                          Clearance than = {});

}  // namespace pdoik::detail
