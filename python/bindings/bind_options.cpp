#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <map>
#include <tuple>
#include <type_traits>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "names.hpp"
#include "pdoik/option_fields.hpp"

namespace pdoik::python {
namespace {

using ContactPoints = std::map<std::string, std::vector<Eigen::Vector3d>>;

/// An option as an attribute; enums are words, poses 4x4 arrays, contacts a dict by link.
template <class Struct, class Value>
void def_option(py::class_<Struct>& target, const detail::Field<Struct, Value>& field) {
  const auto member = field.member;
  if constexpr (std::is_enum_v<Value>) {
    target.def_property(
        field.name, [member](const Struct& self) { return to_name(self.*member); },
        [member, name = field.name](Struct& self, const std::string& text) {
          self.*member = from_name<Value>(text, name);
        });
  } else if constexpr (std::is_same_v<Value, Eigen::Isometry3d>) {
    target.def_property(
        field.name, [member](const Struct& self) -> Matrix4 { return (self.*member).matrix(); },
        [member](Struct& self, const Matrix4& T) { (self.*member).matrix() = T; });
  } else if constexpr (std::is_same_v<Value, std::vector<Contact>>) {
    target.def_property(
        field.name,
        [member](const Struct& self) {
          ContactPoints points;
          for (const Contact& each : self.*member) points[each.link] = each.points;
          return points;
        },
        [member](Struct& self, const ContactPoints& points) {
          (self.*member).clear();
          for (const auto& [link, of_link] : points) (self.*member).push_back({link, of_link});
        });
  } else {
    target.def_readwrite(field.name, member);
  }
}

template <class Struct>
py::class_<Struct> bind_struct(py::module_& module, const char* name) {
  py::class_<Struct> target(module, name, "The C++ struct, which pdoik.Options fills.");
  target.def(py::init<>());
  std::apply([&](const auto&... field) { (def_option(target, field), ...); },
             detail::option_fields<Struct>);
  return target;
}

}  // namespace

void bind_options(py::module_& module) {
  bind_struct<LbfgsOptions>(module, "LbfgsOptions");
  bind_struct<AugmentedLagrangianOptions>(module, "AugmentedLagrangianOptions");
  bind_struct<LevenbergMarquardtOptions>(module, "LevenbergMarquardtOptions");
  bind_struct<BalanceOptions>(module, "BalanceOptions");
  bind_struct<TouchOptions>(module, "TouchOptions");
  bind_struct<Options>(module, "Options")
      .def("keeps_off_itself", &Options::keeps_off_itself, py::arg("robot"));
}

}  // namespace pdoik::python
