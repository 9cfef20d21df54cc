#include <pybind11/stl.h>

#include <cmath>
#include <tuple>
#include <utility>
#include <variant>

#include "bind.hpp"
#include "scene.hpp"

namespace pdoik::python {
namespace {

using ContactOfAnyDepth = std::tuple<std::string, std::string>;
using ContactToDepth = std::tuple<std::string, std::string, double>;
using Contact = std::variant<ContactOfAnyDepth, ContactToDepth>;

std::optional<ThinnedCloud> to_cloud(const std::optional<ObstaclesLike>& cloud) {
  if (!cloud) return std::nullopt;
  if (py::isinstance<ThinnedCloud>(cloud->value)) return cloud->value.cast<ThinnedCloud>();
  const PointsView points = PointsView::float64(ArrayLike{cloud->value}, "cloud");
  return ThinnedCloud{Cloud(points.in_double()), std::nullopt};
}

SceneObject make_scene(const std::vector<Shape>& shapes, const std::optional<ObstaclesLike>& cloud,
                       const std::vector<Contact>& allowed) {
  std::vector<AllowedContact> contacts;
  const auto to_contact = [](const auto&... parts) { return AllowedContact{parts...}; };
  for (const Contact& contact : allowed) {
    contacts.push_back(
        std::visit([&](const auto& parts) { return std::apply(to_contact, parts); }, contact));
  }
  return {Shapes(shapes, std::move(contacts)), to_cloud(cloud)};
}

std::vector<Shape> shapes_of(const SceneObject& scene) {
  const auto shapes = scene.shapes.shapes();
  return {shapes.begin(), shapes.end()};
}

std::vector<Contact> allowed_of(const SceneObject& scene) {
  std::vector<Contact> contacts;
  for (const AllowedContact& each : scene.shapes.allowed()) {
    if (std::isinf(each.depth))
      contacts.emplace_back(ContactOfAnyDepth{each.link, each.shape});
    else
      contacts.emplace_back(ContactToDepth{each.link, each.shape, each.depth});
  }
  return contacts;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneObject>(module, "Scene",
                          R"(Solids and points that are obstacles together, for `obstacles=`.

It does not change, but its cloud may. Any number of solvers may share it.)")
      .def(py::init(&make_scene), py::arg("shapes") = py::tuple(), py::kw_only(),
           py::arg("cloud") = py::none(), py::arg("allowed") = py::tuple(),
           R"(Put shapes and points together.

Args:
    shapes: Of different names.
    cloud: A Cloud, which is shared and not copied; or points as Cloud takes them.
    allowed: What may touch, (link, shape) by name or (link, shape, depth): the table that the base stands
        on, what the hand is to hold. Of the link all hulls; to any depth or to this one [m], from where
        their distance then counts.

Raises:
    ValueError: Two shapes have one name, or contact is allowed with a shape that is not there. A link that the
        robot does not have comes out when a solver takes the scene.)")
      .def_property_readonly("shapes", &shapes_of, "The solids, in the order they were given.")
      .def_property_readonly(
          "cloud", [](const SceneObject& self) { return self.cloud; },
          "The points, which share what they are; None if there are none.")
      .def_property_readonly(
          "allowed", &allowed_of,
          "(link, shape) of what may touch, or (link, shape, depth) where a depth was given [m].")
      .def("__repr__", [](const SceneObject& self) {
        return py::str("<Scene of {} shapes and {} points>")
            .format(self.shapes.shapes().size(), self.cloud ? self.cloud->cloud.size() : 0);
      });
}

}  // namespace pdoik::python
