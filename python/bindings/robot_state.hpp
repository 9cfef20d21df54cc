#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/typing.h>

#include "pdoik/robot.hpp"

namespace pdoik::python {

using RobotState = pybind11::typing::Tuple<pybind11::object, pybind11::ellipsis>;

/// A robot as tuples of plain Python, which go to other processes, and the robot that they make.
RobotState state_of(const Robot& robot);
Robot robot_from(const RobotState& state);

}  // namespace pdoik::python
