#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <tuple>
#include <variant>

#include "arrays.hpp"
#include "bind.hpp"
#include "mesh_arrays.hpp"
#include "paths.hpp"
#include "pdoik/occupancy.hpp"

namespace pdoik::python {
namespace {

using AnyTuple = py::typing::Tuple<py::object, py::ellipsis>;
using Point = std::tuple<double, double, double>;
using SphereIn = std::tuple<std::string, ArrayLike, double>;
using SphereOut = std::tuple<std::string, Point, double>;
using SpheroidIn = std::tuple<std::string, ArrayLike, std::string, ArrayLike, double>;
using SpheroidOut = std::tuple<std::string, Point, std::string, Point, double>;

Point to_point(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

using ShortCapsuleIn = std::tuple<std::string, ArrayLike, ArrayLike, double>;
using LongCapsuleIn = std::tuple<std::string, ArrayLike, ArrayLike, double, double>;
using CapsuleIn = std::variant<LongCapsuleIn, ShortCapsuleIn>;
using CapsuleOut = std::tuple<std::string, Point, Point, double, double>;

using PieceIn = std::tuple<std::string, ArrayLike, ArrayLike, double>;
using PointsOut = py::typing::Tuple<Point, py::ellipsis>;
using Triple = std::tuple<int, int, int>;
using TriplesOut = py::typing::Tuple<Triple, py::ellipsis>;
using PieceOut = std::tuple<std::string, PointsOut, TriplesOut, double>;

Capsule to_capsule(const std::string& link, const ArrayLike& a, const ArrayLike& b, double radius,
                   double overhang = 0.0) {
  return {link, to_vector3(a, "capsules: xyz_a"), to_vector3(b, "capsules: xyz_b"), radius,
          overhang};
}

Occupancy make_occupancy(const std::vector<SphereIn>& spheres,
                         const std::vector<SpheroidIn>& spheroids,
                         const std::vector<CapsuleIn>& capsules,
                         const std::vector<PieceIn>& pieces) {
  Occupancy result;
  for (const auto& [link, center, radius] : spheres) {
    result.spheres.push_back({link, to_vector3(center, "spheres: xyz"), radius});
  }
  for (const auto& [link_a, focus_a, link_b, focus_b, semi_major] : spheroids) {
    result.spheroids.push_back({link_a, to_vector3(focus_a, "spheroids: xyz_a"), link_b,
                                to_vector3(focus_b, "spheroids: xyz_b"), semi_major});
  }
  for (const CapsuleIn& capsule : capsules) {
    const auto to = [](const auto&... parts) { return to_capsule(parts...); };
    result.capsules.push_back(
        std::visit([&](const auto& parts) { return std::apply(to, parts); }, capsule));
  }
  for (const auto& [link, vertices, triangles, tolerance] : pieces)
    result.pieces.push_back({link, to_vertices(vertices), to_triangles(triangles), tolerance});
  return result;
}

std::vector<SphereOut> spheres_of(const Occupancy& occupancy) {
  std::vector<SphereOut> result;
  for (const Sphere& s : occupancy.spheres)
    result.emplace_back(s.link, to_point(s.center), s.radius);
  return result;
}

std::vector<SpheroidOut> spheroids_of(const Occupancy& occupancy) {
  std::vector<SpheroidOut> result;
  for (const Spheroid& s : occupancy.spheroids) {
    result.emplace_back(s.link_a, to_point(s.focus_a), s.link_b, to_point(s.focus_b), s.semi_major);
  }
  return result;
}

std::vector<CapsuleOut> capsules_of(const Occupancy& occupancy) {
  std::vector<CapsuleOut> result;
  for (const Capsule& c : occupancy.capsules)
    result.emplace_back(c.link, to_point(c.a), to_point(c.b), c.radius, c.overhang);
  return result;
}

std::vector<PieceOut> pieces_of(const Occupancy& occupancy) {
  std::vector<PieceOut> result;
  for (const ConvexPiece& piece : occupancy.pieces) {
    py::tuple vertices(piece.vertices.size()), triangles(piece.triangles.size());
    for (std::size_t k = 0; k < piece.vertices.size(); ++k)
      vertices[k] = to_point(piece.vertices[k]);
    for (std::size_t k = 0; k < piece.triangles.size(); ++k) {
      const auto& [a, b, c] = piece.triangles[k];
      triangles[k] = Triple(a, b, c);
    }
    result.emplace_back(piece.link, vertices, triangles, piece.tolerance);
  }
  return result;
}

AnyTuple occupancy_state(const Occupancy& occupancy) {
  return py::make_tuple(
      py::tuple(py::cast(spheres_of(occupancy))), py::tuple(py::cast(spheroids_of(occupancy))),
      py::tuple(py::cast(capsules_of(occupancy))), py::tuple(py::cast(pieces_of(occupancy))));
}

}  // namespace

void bind_occupancy(py::module_& module) {
  py::class_<Occupancy>(
      module, "Occupancy",
      R"(What a robot fills: hulls fixed to its links that obstacle points must stay out of.

A sphere keeps obstacle points at least its radius from its centre (Eq. joint_coll_avoid). A spheroid keeps
the half sum of an obstacle point's distances to its two foci at or above its semi-major axis
(Eq. link_coll_avoid); its foci may sit on different links.

A capsule is what lies within its radius of a segment, on one link. A link that has any fills these, and its
spheres and spheroids only say where to look (and are what method "paper" and inner "lbfgs" know): few wide
hulls for speed, many tight ones for the verdict. Hulls are numbered spheres first, then spheroids, then
capsules.

Pieces are convex parts of a link itself, which hold it together to their tolerance: where the link's capsules
touch something, they say whether it does (see Options.exact_contact). They are no hulls, and have no numbers.
An occupancy does not change.)")
      .def(py::init(&make_occupancy), py::kw_only(), py::arg("spheres") = py::tuple(),
           py::arg("spheroids") = py::tuple(), py::arg("capsules") = py::tuple(),
           py::arg("pieces") = py::tuple(),
           R"(Args:
    spheres: Tuples (link, xyz, radius): centre in the link's frame and radius [m].
    spheroids: Tuples (link_a, xyz_a, link_b, xyz_b, semi_major): each focus in its link's frame and
        semi-major axis [m].
    capsules: Tuples (link, xyz_a, xyz_b, radius) or (link, xyz_a, xyz_b, radius, overhang): the segment's
        ends in the link's frame and radius [m]; and how far its surface stands beyond the link itself at
        most, 0 where nobody knows [m].
    pieces: Tuples (link, vertices, triangles, tolerance) of links that have capsules: vertices (N, 3) in
        the link's frame [m], triangles (T, 3) of a closed and convex surface, counter-clockwise from
        outside; by how much the link's pieces stand beyond it at most [m].

Raises:
    ValueError: A point has not three finite coordinates, or an array another shape. The rest is checked when a robot takes it.)")
      .def_static(
          "load", [](const PathOrText& path_or_text) { return load_occupancy(path_or_text.value); },
          py::arg("path_or_text"), R"(Read an occupancy file.

Args:
    path_or_text: A file's path, or YAML text (recognised by a line break or ": ").

Raises:
    LoadError: Names the file, the entry and what is wrong with it.)")
      .def(
          "save",
          [](const Occupancy& self, const PathOrText& path) {
            py::module_::import("pdoik._files").attr("write_whole")(path.value, to_yaml(self));
          },
          py::arg("path"),
          "Write the YAML file that `load` reads back exactly. Replaces a file only when all is "
          "written.")
      .def("to_yaml", &to_yaml, "The text that `load` reads back exactly.")
      .def_property_readonly("spheres", &spheres_of,
                             "Tuples (link, xyz, radius), lengths in metres.")
      .def_property_readonly(
          "spheroids", &spheroids_of,
          "Tuples (link_a, xyz_a, link_b, xyz_b, semi_major), lengths in metres.")
      .def_property_readonly("capsules", &capsules_of,
                             "Tuples (link, xyz_a, xyz_b, radius, overhang), lengths in metres.")
      .def_property_readonly("pieces", &pieces_of,
                             "Tuples (link, vertices, triangles, tolerance), lengths in metres.")
      .def("__len__", &Occupancy::size)
      .def(
          "__eq__",
          [](const Occupancy& self, const py::object& other) {
            return py::isinstance<Occupancy>(other) &&
                   occupancy_state(self).equal(occupancy_state(other.cast<const Occupancy&>()));
          },
          py::arg("other"))
      .def("__hash__", [](const Occupancy& self) { return py::hash(occupancy_state(self)); })
      .def("__repr__",
           [](const Occupancy& self) {
             return py::str("<Occupancy of {} spheres, {} spheroids, {} capsules and {} pieces>")
                 .format(self.spheres.size(), self.spheroids.size(), self.capsules.size(),
                         self.pieces.size());
           })
      .def(py::pickle(&occupancy_state, [](const AnyTuple& state) {
        return make_occupancy(
            state[0].cast<std::vector<SphereIn>>(), state[1].cast<std::vector<SpheroidIn>>(),
            state.size() > 2 ? state[2].cast<std::vector<CapsuleIn>>() : std::vector<CapsuleIn>(),
            state.size() > 3 ? state[3].cast<std::vector<PieceIn>>() : std::vector<PieceIn>());
      }));
}

}  // namespace pdoik::python
