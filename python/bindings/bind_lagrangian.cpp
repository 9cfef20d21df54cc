#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <limits>
#include <utility>

#include "arrays.hpp"
#include "bind.hpp"
#include "goals.hpp"
#include "names.hpp"
#include "pdoik/lagrangian.hpp"

namespace pdoik::python {
namespace {

/// An array is one view for the length of a call: scratch memory stays with the object.
struct PythonLagrangian {
  PythonLagrangian(const Robot& robot, const Options& options, const std::string& variables)
      : form(options.augmented_lagrangian.form),
        problem(robot, options, from_name<Lagrangian::Variables>(variables, "variables")) {}

  Penalty penalty(double rho) const {
    if (!(rho > 0.0 && rho < std::numeric_limits<double>::infinity()))
      throw std::invalid_argument("rho is " + std::to_string(rho) + ", expected positive");
    return {form, rho};
  }
  Eigen::VectorXd variables(const ArrayLike& x) const { return to_vector(x, "x", problem.size()); }

  PenaltyForm form;
  Lagrangian problem;
};

std::pair<double, Eigen::VectorXd> value(PythonLagrangian& self, const ArrayLike& x, double rho) {
  std::pair<double, Eigen::VectorXd> result;
  result.first = self.problem.lagrangian(self.variables(x), self.penalty(rho), result.second);
  return result;
}

}  // namespace

void bind_lagrangian(py::module_& module) {
  using P = PythonLagrangian;
  py::class_<P>(module, "Lagrangian")
      .def(py::init<const Robot&, const Options&, const std::string&>(), py::arg("robot"),
           py::arg("options"), py::arg("variables"))
      .def(
          "set_target",
          [](P& self, const ArrayLike& T_base_tip) {
            self.problem.set_target(to_isometry(T_base_tip, "T_base_tip"));
          },
          py::arg("T_base_tip"),
          R"(Take a target, shape (4, 4) [m], and forget the multipliers.

Raises:
    ValueError: It is not rigid to 1e-6.)")
      .def(
          "set_goals",
          [](P& self, const GoalsLike& goals) {
            self.problem.set_goals(to_goals(goals, {self.problem.robot(), self.problem.options()}));
          },
          py::arg("goals"),
          R"(Take goals as Solver.solve does, without slack, and forget the multipliers.

Raises:
    ValueError: As in Solver.solve, or a goal has slack.)")
      .def(
          "set_obstacles",
          [](P& self, const std::optional<ArrayLike>& points) {
            self.problem.set_obstacles(PointsView::float64(points, "points"));
          },
          py::arg("points"),
          R"(Take points x y z, or x y z radius, shape (N, 3) or (N, 4) [m], and forget the multipliers.

Raises:
    ValueError: A shape is wrong, a radius is negative, or something is NaN or infinite.)")
      .def_property_readonly(
          "size", [](const P& self) { return self.problem.size(); }, "The number of variables.")
      .def(
          "variables",
          [](const P& self, const ArrayLike& q) {
            return self.problem.variables(to_vector(q, "q", self.problem.robot().dof()));
          },
          py::arg("q"),
          R"(The variables at q, shape (size,); as slack, q is first moved a little inside its limits.

Args:
    q: Joint positions, shape (n,) [rad] or [m].

Raises:
    ValueError: q has another shape or holds NaN or infinity.)")
      .def(
          "positions",
          [](const P& self, const ArrayLike& x) {
            return self.problem.positions(self.variables(x));
          },
          py::arg("x"), "Joint positions at x, shape (n,) [rad] or [m].")
      .def("__call__", &value, py::arg("x"), py::arg("rho"),
           R"(Eq. AL and its gradient, with the multipliers as they are.

Args:
    x: Variables, shape (size,).
    rho: Penalty weight.

Returns:
    The value [m^2] and the gradient, shape (size,).

Raises:
    ValueError: x has another shape or holds NaN or infinity, or rho is not positive.)")
      .def(
          "max_constraint",
          [](P& self, const ArrayLike& x) {
            return self.problem.max_constraint(self.variables(x));
          },
          py::arg("x"),
          "The largest violation at x, at least 0 [m]; of a spheroid twice the depth, as in the "
          "paper.")
      .def(
          "reset_multipliers", [](P& self) { self.problem.reset_multipliers(); },
          "Set all multipliers to zero.")
      .def(
          "update_multipliers",
          [](P& self, const ArrayLike& x, double rho) {
            self.problem.update_multipliers(self.variables(x), self.penalty(rho));
          },
          py::arg("x"), py::arg("rho"), "Algorithm IK, line 9, at x.")
      .def_property_readonly(
          "last_position_error", [](const P& self) { return self.problem.last_position_error(); },
          "Of the tip where the value was last asked for [m].")
      .def_property_readonly(
          "last_rotation_error", [](const P& self) { return self.problem.last_rotation_error(); },
          "Of the tip, or of its axis, there [rad].")
      .def_property_readonly(
          "last_max_constraint", [](const P& self) { return self.problem.last_max_constraint(); },
          "The largest violation there, at least 0 [m].");
}

}  // namespace pdoik::python
