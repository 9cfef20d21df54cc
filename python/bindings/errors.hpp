#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace pdoik::python {

/// Python's str of text that may hold bytes which are not UTF-8, a file's say.
pybind11::str to_str(const std::string& text);

/// warnings.warn(message, pdoik.RobotWarning), in the name of whoever called.
void warn(const std::string& message);

/// The same with pdoik.GoalWarning.
void warn_of_goal(const std::string& message);

}  // namespace pdoik::python
