#include <pybind11/stl.h>

#include <tuple>
#include <utility>

#include "bind.hpp"
#include "scene.hpp"

namespace pdoik::python {
namespace {

using Contacts = std::vector<std::pair<std::string, std::string>>;

std::optional<ThinnedCloud> to_cloud(const std::optional<ObstaclesLike>& cloud) {
  if (!cloud) return std::nullopt;
  if (py::isinstance<ThinnedCloud>(cloud->value)) return cloud->value.cast<ThinnedCloud>();
  const PointsView points = PointsView::float64(ArrayLike{cloud->value}, "cloud");
  return ThinnedCloud{Cloud(points.in_double()), std::nullopt};
}

SceneObject make(const std::vector<Shape>& shapes, const std::optional<ObstaclesLike>& cloud,
                 const Contacts& allowed) {
  std::vector<AllowedContact> contacts;
  for (const auto& [link, shape] : allowed) contacts.push_back({link, shape});
  return {Shapes(shapes, std::move(contacts)), to_cloud(cloud)};
}

std::vector<Shape> shapes_of(const SceneObject& scene) {
  const auto shapes = scene.shapes.shapes();
  return {shapes.begin(), shapes.end()};
}

Contacts allowed_of(const SceneObject& scene) {
  Contacts contacts;
  for (const AllowedContact& each : scene.shapes.allowed())
    contacts.emplace_back(each.link, each.shape);
  return contacts;
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<SceneObject>(module, "Scene",
                          R"(Solids and points that are obstacles together, for `obstacles=`.

It does not change, but its cloud may. Any number of solvers may share it.)")
      .def(py::init(&make), py::arg("shapes") = py::tuple(), py::kw_only(),
           py::arg("cloud") = py::none(), py::arg("allowed") = py::tuple(),
           R"(Put shapes and points together.

Args:
    shapes: Of different names.
    cloud: A Cloud, which is shared and not copied; or points as Cloud takes them.
    allowed: Pairs (link, shape) by name that may touch: the table that the base stands on, what the hand is
        to hold. Of the link all hulls.

Raises:
    ValueError: Two shapes have one name, or contact is allowed with a shape that is not there. A link that the
        robot does not have comes out when a solver takes the scene.)")
      .def_property_readonly("shapes", &shapes_of, "The solids, in the order they were given.")
      .def_property_readonly(
          "cloud", [](const SceneObject& self) { return self.cloud; },
          "The points, which share what they are; None if there are none.")
      .def_property_readonly("allowed", &allowed_of, "Pairs (link, shape) that may touch.")
      .def("__repr__", [](const SceneObject& self) {
        return py::str("<Scene of {} shapes and {} points>")
            .format(self.shapes.shapes().size(), self.cloud ? self.cloud->cloud.size() : 0);
      });
}

}  // namespace pdoik::python
