#pragma once

#include <pybind11/pybind11.h>

namespace pdoik::python {

namespace py = pybind11;

void bind_cloud(py::module_& module);
void bind_shape(py::module_& module);
void bind_contacts(py::module_& module);
void bind_scene(py::module_& module);
void bind_errors(py::module_& module);
void bind_occupancy(py::module_& module);
void bind_robot(py::module_& module);
void bind_options(py::module_& module);
void bind_goal(py::module_& module);
void bind_result(py::module_& module);
void bind_solver(py::module_& module);
void bind_tracker(py::module_& module);
void bind_timing(py::module_& module);
void bind_lagrangian(py::module_& module);
void bind_point_cloud(py::module_& module);
void bind_shrink_wrap(py::module_& module);

/// warnings.warn(message, pdoik.ObstacleWarning), likewise.
void warn_of_obstacles(const std::string& message);

}  // namespace pdoik::python
