#pragma once

#include "common/input_error.hpp"
#include "pdoik/cloud.hpp"

namespace pdoik::detail {

/// Finite rows of three or four, none beyond 1e6 m, no radius negative.
/// For Obstacles and ObstaclesF.
template <class Rows>
bool accepts_obstacles(const Rows& points, InputError& error, const char* name = "obstacles");
void check_obstacles(const Obstacles& points);
/// As many points as places can be counted for, at most.
void check_count(Eigen::Index points, const char* name);

}  // namespace pdoik::detail
