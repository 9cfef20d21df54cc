#pragma once

#include <string>

#include "obstacles/scene.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// "clearance of panda_link5 (spheroid 12) to obstacle 17", or "to table", for people.
std::string describe(const WorstConstraint& worst, const Robot& robot, const Scene& scene);

/// "panda_link5 (spheroid 12)" of a hull by its place in the occupancy.
std::string hull_name(const Occupancy& occupancy, int index);

}  // namespace pdoik::detail
