#include <pybind11/stl.h>

#include <utility>

#include "bind.hpp"
#include "contacts.hpp"
#include "scene.hpp"

namespace pdoik::python {
namespace {

std::optional<ThinnedCloud> to_cloud(const std::optional<ObstaclesLike>& cloud) {
  if (!cloud) return std::nullopt;
  if (py::isinstance<ThinnedCloud>(cloud->value)) return cloud->value.cast<ThinnedCloud>();
  const PointsView points = PointsView::float64(ArrayLike{cloud->value}, "cloud");
  return ThinnedCloud{Cloud(points.in_double()), std::nullopt};
}

SceneObject make_scene(const std::vector<Shape>& shapes, const std::optional<ObstaclesLike>& cloud,
                       const std::vector<AllowedContact>& allowed,
                       const std::vector<ContactRule>& contacts) {
  std::vector<ContactRule> rules;
  for (const AllowedContact& each : allowed) rules.push_back(to_rule(each));
  rules.insert(rules.end(), contacts.begin(), contacts.end());
  return {Shapes(shapes, std::move(rules)), to_cloud(cloud)};
}

std::vector<Shape> shapes_of(const SceneObject& scene) {
  const auto shapes = scene.shapes.shapes();
  return {shapes.begin(), shapes.end()};
}

std::vector<ContactRule> contacts_of(const SceneObject& scene) {
  const auto contacts = scene.shapes.contacts();
  return {contacts.begin(), contacts.end()};
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneObject>(module, "Scene",
                          R"(Solids and points that are obstacles together, for `obstacles=`.

It does not change, but its cloud may. Any number of solvers may share it.)")
      .def(py::init(&make_scene), py::arg("shapes") = py::tuple(), py::kw_only(),
           py::arg("cloud") = py::none(), py::arg("allowed") = py::tuple(),
           py::arg("contacts") = py::tuple(),
           R"(Put shapes and points together.

Args:
    shapes: Of different names.
    cloud: A Cloud, which is shared and not copied; or points as Cloud takes them.
    allowed: What may touch, (link, shape) by name or (link, shape, depth): the table that the base stands
        on, what the hand is to hold. Each is a ContactRule of these names, to any depth or to this one [m].
    contacts: Rules of contact, which count after `allowed`.

Raises:
    ValueError: Two shapes have one name, or a depth is negative. Names that are neither a link's, nor a shape's, nor
        of what a link carries come out when a solver takes the scene.)")
      .def_property_readonly("shapes", &shapes_of, "The solids, in the order they were given.")
      .def_property_readonly(
          "cloud", [](const SceneObject& self) { return self.cloud; },
          "The points, which share what they are; None if there are none.")
      .def_property_readonly("contacts", &contacts_of,
                             "The rules of contact, those of `allowed` first.")
      .def_property_readonly(
          "allowed", [](const SceneObject& self) { return allowed_by(self.shapes.contacts()); },
          "Of the rules those that allow contact, as (one, other), or as (one, other, depth) where "
          "it is to a depth [m].")
      .def("__repr__", [](const SceneObject& self) {
        return py::str("<Scene of {} shapes and {} points>")
            .format(self.shapes.shapes().size(), self.cloud ? self.cloud->cloud.size() : 0);
      });
}

}  // namespace pdoik::python
