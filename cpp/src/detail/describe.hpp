#pragma once

#include <string>

#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// "clearance of panda_link5 (spheroid 12) to obstacle 17", for people.
std::string describe(const WorstConstraint& worst, const Robot& robot);

}  // namespace pdoik::detail
