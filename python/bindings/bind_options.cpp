#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "names.hpp"
#include "pdoik/options.hpp"

namespace pdoik::python {
namespace {

/// A member that is an enum in C++ and a str in Python.
template <auto member, class Class>
void def_name(Class& target, const char* name) {
  using Struct = typename Class::type;
  target.def_property(
      name, [](const Struct& self) { return to_name(self.*member); },
      [name](Struct& self, const std::string& text) {
        self.*member = from_name<std::remove_cvref_t<decltype(self.*member)>>(text, name);
      });
}

void bind_lbfgs(py::module_& module) {
  using O = LbfgsOptions;
  py::class_<O>(module, "LbfgsOptions")
      .def(py::init<>())
      .def_readwrite("memory", &O::memory)
      .def_readwrite("max_iterations", &O::max_iterations)
      .def_readwrite("max_line_search", &O::max_line_search)
      .def_readwrite("gradient_tolerance", &O::gradient_tolerance)
      .def_readwrite("relative_decrease", &O::relative_decrease)
      .def_readwrite("first_step", &O::first_step)
      .def_readwrite("max_step", &O::max_step)
      .def_readwrite("armijo", &O::armijo)
      .def_readwrite("curvature", &O::curvature);
}

void bind_augmented_lagrangian(py::module_& module) {
  using O = AugmentedLagrangianOptions;
  py::class_<O> options(module, "AugmentedLagrangianOptions");
  options.def(py::init<>())
      .def_readwrite("rho", &O::rho)
      .def_readwrite("rho_growth", &O::rho_growth)
      .def_readwrite("rho_max", &O::rho_max)
      .def_readwrite("beta", &O::beta)
      .def_readwrite("constraint_tolerance", &O::constraint_tolerance)
      .def_readwrite("max_outer_iterations", &O::max_outer_iterations);
  def_name<&O::form>(options, "form");
}

void bind_levenberg_marquardt(py::module_& module) {
  using O = LevenbergMarquardtOptions;
  py::class_<O>(module, "LevenbergMarquardtOptions")
      .def(py::init<>())
      .def_readwrite("max_iterations", &O::max_iterations)
      .def_readwrite("first_damping", &O::first_damping)
      .def_readwrite("damping_decrease", &O::damping_decrease)
      .def_readwrite("damping_increase", &O::damping_increase)
      .def_readwrite("max_damping", &O::max_damping)
      .def_readwrite("stall_ratio", &O::stall_ratio)
      .def_readwrite("stall_window", &O::stall_window);
}

void bind_balance(py::module_& module) {
  using B = BalanceOptions;
  py::class_<B>(module, "BalanceOptions")
      .def(py::init<>())
      .def_readwrite("com_lower", &B::com_lower)
      .def_readwrite("com_upper", &B::com_upper)
      .def_property(
          "contacts",
          [](const B& self) {
            std::map<std::string, std::vector<Eigen::Vector3d>> contacts;
            for (const Contact& contact : self.contacts) contacts[contact.link] = contact.points;
            return contacts;
          },
          [](B& self, const std::map<std::string, std::vector<Eigen::Vector3d>>& contacts) {
            self.contacts.clear();
            for (const auto& [link, points] : contacts) self.contacts.push_back({link, points});
          })
      .def_readwrite("support_margin", &B::support_margin)
      .def_readwrite("up", &B::up);
}

void bind_touch(py::module_& module) {
  using T = TouchOptions;
  py::class_<T>(module, "TouchOptions")
      .def(py::init<>())
      .def_readwrite("radius", &T::radius)
      .def_readwrite("depth", &T::depth)
      .def_readwrite("links", &T::links);
}

}  // namespace

void bind_options(py::module_& module) {
  bind_lbfgs(module);
  bind_augmented_lagrangian(module);
  bind_levenberg_marquardt(module);
  bind_balance(module);
  bind_touch(module);
  py::class_<Options> options(module, "Options", "The C++ options, which pdoik.Options fills.");
  options.def(py::init<>())
      .def_readwrite("goal_axis", &Options::goal_axis)
      .def_property(
          "T_tip_tool", [](const Options& self) -> Matrix4 { return self.T_tip_tool.matrix(); },
          [](Options& self, const Matrix4& T) { self.T_tip_tool.matrix() = T; })
      .def_readwrite("position_tolerance", &Options::position_tolerance)
      .def_readwrite("rotation_tolerance", &Options::rotation_tolerance)
      .def_readwrite("clearance", &Options::clearance)
      .def_readwrite("clearance_tolerance", &Options::clearance_tolerance)
      .def_readwrite("report_clearance", &Options::report_clearance)
      .def_readwrite("max_time", &Options::max_time)
      .def_readwrite("max_restarts", &Options::max_restarts)
      .def_readwrite("seed", &Options::seed)
      .def_readwrite("base_collision", &Options::base_collision)
      .def_readwrite("exact_contact", &Options::exact_contact)
      .def_readwrite("ignore_obstacles_without_hulls", &Options::ignore_obstacles_without_hulls)
      .def_readwrite("touch", &Options::touch)
      .def_readwrite("balance", &Options::balance)
      .def_readwrite("self_collision", &Options::self_collision)
      .def("keeps_off_itself", &Options::keeps_off_itself, py::arg("robot"))
      .def_readwrite("self_clearance", &Options::self_clearance)
      .def_readwrite("posture_weight", &Options::posture_weight)
      .def_readwrite("joint_weights", &Options::joint_weights)
      .def_readwrite("max_obstacles", &Options::max_obstacles)
      .def_readwrite("rotation_weight", &Options::rotation_weight)
      .def_readwrite("collision_weight", &Options::collision_weight)
      .def_readwrite("start_inset", &Options::start_inset)
      .def_readwrite("point_distance", &Options::point_distance)
      .def_readwrite("lbfgs", &Options::lbfgs)
      .def_readwrite("augmented_lagrangian", &Options::augmented_lagrangian)
      .def_readwrite("levenberg_marquardt", &Options::levenberg_marquardt);
  def_name<&Options::goal>(options, "goal");
  def_name<&Options::priority>(options, "priority");
  def_name<&Options::method>(options, "method");
  def_name<&Options::inner>(options, "inner");
  def_name<&Options::prefer>(options, "prefer");
}

}  // namespace pdoik::python
