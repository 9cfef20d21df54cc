#pragma once

#include "scene.hpp"

namespace pdoik::python {

/// Whether a robot's user has been told that obstacles are far off.
using ToldOfUnits = bool;

/// Tell, once, of points so far from what the robot reaches that they are in millimetres, most
/// likely: a robot among them would find itself alone.
void warn_of_units(const ObstaclesIn& obstacles, const Robot& robot, ToldOfUnits& told);

}  // namespace pdoik::python
