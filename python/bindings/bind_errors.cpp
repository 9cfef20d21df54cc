#include <pybind11/gil_safe_call_once.h>

#include <exception>

#include "bind.hpp"
#include "errors.hpp"
#include "pdoik/errors.hpp"

namespace pdoik::python {
namespace {

struct ErrorTypes {
  py::object load_error, robot_warning, obstacle_warning, goal_warning;
};

/// The classes of pdoik/errors.py, looked up once.
const ErrorTypes& error_types() {
  PYBIND11_CONSTINIT static py::gil_safe_call_once_and_store<ErrorTypes> storage;
  return storage
      .call_once_and_store_result([] {
        const py::module_ errors = py::module_::import("pdoik.errors");
        return ErrorTypes{errors.attr("LoadError"), errors.attr("RobotWarning"),
                          errors.attr("ObstacleWarning"), errors.attr("GoalWarning")};
      })
      .get_stored();
}

void warn_by(const py::object& category, const std::string& message) {
  const py::object text = to_str(message).attr("encode")("utf-8");
  if (PyErr_WarnEx(category.ptr(), PyBytes_AsString(text.ptr()), 1) != 0)
    throw py::error_already_set();
}

void translate(std::exception_ptr pointer) {
  try {
    if (pointer) std::rethrow_exception(pointer);
  } catch (const LoadError& error) {
    PyErr_SetObject(error_types().load_error.ptr(), to_str(error.what()).ptr());
  } catch (const std::invalid_argument& error) {
    PyErr_SetObject(PyExc_ValueError, to_str(error.what()).ptr());
  }
}

}  // namespace

py::str to_str(const std::string& text) {
  const auto size = static_cast<Py_ssize_t>(text.size());
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), size, "backslashreplace"));
}

void warn(const std::string& message) { warn_by(error_types().robot_warning, message); }

void warn_of_obstacles(const std::string& message) {
  warn_by(error_types().obstacle_warning, message);
}

void warn_of_goal(const std::string& message) { warn_by(error_types().goal_warning, message); }

void bind_errors(py::module_&) {
  error_types();
  py::register_exception_translator(translate);
}

}  // namespace pdoik::python
