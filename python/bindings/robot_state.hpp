#pragma once

#include <pybind11/pybind11.h>

#include "pdoik/robot.hpp"

namespace pdoik::python {

/// A robot as tuples of plain Python, which go to other processes, and the robot that they make.
pybind11::tuple state_of(const Robot& robot);
Robot robot_from(const pybind11::tuple& state);

}  // namespace pdoik::python
