#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include "arrays.hpp"
#include "bind.hpp"
#include "mesh_arrays.hpp"
#include "names.hpp"
#include "pdoik/shape.hpp"

namespace pdoik::detail {

template <>
inline constexpr std::array enumerator_names<Shape::Kind>{
    std::pair{Shape::Kind::Sphere, "sphere"},
    std::pair{Shape::Kind::Box, "box"},
    std::pair{Shape::Kind::Cylinder, "cylinder"},
    std::pair{Shape::Kind::Capsule, "capsule"},
    std::pair{Shape::Kind::HalfSpace, "half_space"},
    std::pair{Shape::Kind::ConvexMesh, "convex_mesh"},
    std::pair{Shape::Kind::Mesh, "mesh"},
    std::pair{Shape::Kind::Boxes, "boxes"},
    std::pair{Shape::Kind::DistanceField, "distance_field"}};
template <>
inline constexpr std::array enumerator_names<DistanceField::Unknown>{
    std::pair{DistanceField::Unknown::Free, "free"},
    std::pair{DistanceField::Unknown::Occupied, "occupied"}};

}  // namespace pdoik::detail

namespace pdoik::python {
namespace {

using KindName = py::typing::Literal<"'sphere'", "'box'", "'cylinder'", "'capsule'", "'half_space'",
                                     "'convex_mesh'", "'mesh'", "'boxes'", "'distance_field'">;
using UnknownName = py::typing::Literal<"'free'", "'occupied'">;
using Values = py::array_t<float, py::array::c_style | py::array::forcecast>;
using Triangles = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

Eigen::Isometry3d pose(const std::optional<ArrayLike>& T) {
  return T ? to_isometry(*T, "T_base_shape") : Eigen::Isometry3d::Identity();
}

Shape checked(Shape shape) {
  check_shape(shape);
  return shape;
}

Shape mesh(const std::string& name, const ArrayLike& vertices, const ArrayLike& triangles,
           const std::optional<ArrayLike>& T_base_shape) {
  Shape shape = checked(
      Shape::mesh(name, pose(T_base_shape), to_vertices(vertices), to_triangles(triangles)));
  if (const int open = open_edges(shape); open > 0) {
    warn_of_obstacles(
        py::str("mesh '{}' is not closed: {} of its edges have a triangle on one side only. Its "
                "surface is kept off, and what lies behind it is free: close it, with "
                "trimesh.repair.fill_holes for instance, if it stands for a solid")
            .format(name, open)
            .cast<std::string>());
  }
  return shape;
}

Shape boxes(const std::string& name, const ArrayLike& low, const ArrayLike& high,
            const std::optional<ArrayLike>& T_base_shape) {
  const std::vector<Eigen::Vector3d> lows = to_vertices(low), highs = to_vertices(high);
  if (lows.size() != highs.size())
    throw std::invalid_argument("low and high are of different lengths");
  std::vector<Eigen::AlignedBox3d> all;
  for (std::size_t k = 0; k < lows.size(); ++k) all.emplace_back(lows[k], highs[k]);
  return checked(Shape::boxes(name, pose(T_base_shape), all));
}

Shape grid(const std::string& name, const ArrayLike& taken, double edge,
           const std::optional<ArrayLike>& T_base_shape) {
  const auto array = py::array::ensure(taken.value);
  if (!array || array.ndim() != 3 || array.dtype().kind() != 'b')
    throw std::invalid_argument(
        "taken is no array of bool of shape (I, J, K): of probabilities or distances compare them "
        "first, as in occupancy > 0.5");
  const auto cells = array.cast<py::array_t<bool, py::array::c_style>>();
  std::array<int, 3> counts;
  for (std::size_t i = 0; i < 3; ++i)
    counts[i] = static_cast<int>(cells.shape(static_cast<py::ssize_t>(i)));
  std::vector<std::uint8_t> bytes(cells.data(), cells.data() + cells.size());
  return checked(Shape::grid(name, pose(T_base_shape), bytes, counts, edge));
}

DistanceField field_of(const Values& values, double cell, const DistanceField::Options& options) {
  std::array<int, 3> counts;
  for (std::size_t i = 0; i < 3; ++i) {
    const py::ssize_t count = values.shape(static_cast<py::ssize_t>(i));
    counts[i] = static_cast<int>(std::min<py::ssize_t>(count, std::numeric_limits<int>::max()));
  }
  const std::span<const float> all(values.data(), static_cast<std::size_t>(values.size()));
  const py::gil_scoped_release release;
  return {all, counts, cell, options};
}

Shape distance_field(const std::string& name, const ArrayLike& values, double cell,
                     const std::optional<ArrayLike>& T_base_shape,
                     const std::optional<double>& truncation, const UnknownName& unknown) {
  const auto array = py::array::ensure(values.value);
  if (!array || array.dtype().kind() != 'f' || array.ndim() != 3)
    throw std::invalid_argument(
        py::str("values has shape {} and dtype {}, expected signed distances in metres, floats of "
                "shape (X, Y, Z); of cells that are taken or not make a Shape.grid")
            .format(array ? py::object(array.attr("shape")) : py::none(),
                    array ? py::object(array.dtype()) : py::none())
            .cast<std::string>());
  DistanceField::Options options;
  options.unknown = from_name<DistanceField::Unknown>(unknown.cast<std::string>(), "unknown");
  if (truncation) {
    if (!(*truncation > 0.0))
      throw std::invalid_argument("truncation is " + std::to_string(*truncation) +
                                  ", expected a positive length [m]");
    options.truncation = *truncation;
  }
  const Eigen::Isometry3d T = pose(T_base_shape);
  try {
    return checked(Shape::distance_field(name, T, field_of(Values(array), cell, options)));
  } catch (const std::invalid_argument& error) {
    const std::string what = error.what();
    throw std::invalid_argument(what.starts_with("shape '") ? what
                                                            : "shape '" + name + "': " + what);
  }
}

/// Of a distance field, where they are kept; none of others.
py::array_t<float> values_of(const Shape& shape) {
  if (!shape.field) return py::array_t<float>(std::array<py::ssize_t, 3>{0, 0, 0});
  auto* const kept = new DistanceField(*shape.field);
  const py::capsule owner(kept, [](void* field) { delete static_cast<DistanceField*>(field); });
  const std::array<int, 3>& counts = kept->counts();
  py::array_t<float> values(std::array<py::ssize_t, 3>{counts[0], counts[1], counts[2]},
                            kept->values().data(), owner);
  values.attr("setflags")(false);
  return values;
}

Shape convex_mesh(const std::string& name, const ArrayLike& vertices,
                  const std::optional<ArrayLike>& T_base_shape,
                  const std::optional<std::vector<std::array<int, 3>>>& triangles) {
  const Eigen::Isometry3d T = pose(T_base_shape);
  if (triangles) return checked(Shape::convex_mesh(name, T, to_vertices(vertices), *triangles));
  const auto hull = py::module_::import("pdoik._convex")
                        .attr("hull")(to_float64(vertices, "vertices"), name)
                        .cast<py::tuple>();
  return checked(Shape::convex_mesh(name, T, to_vertices(ArrayLike{hull[0]}),
                                    hull[1].cast<std::vector<std::array<int, 3>>>()));
}

Vertices vertices_of(const Shape& shape) {
  Vertices rows(static_cast<Eigen::Index>(shape.vertices.size()), 3);
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    rows.row(i) = shape.vertices[static_cast<std::size_t>(i)].transpose();
  return rows;
}

Triangles triangles_of(const Shape& shape) {
  Triangles rows(static_cast<Eigen::Index>(shape.triangles.size()), 3);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    for (int k = 0; k < 3; ++k) rows(i, k) = shape.triangles[static_cast<std::size_t>(i)][k];
  }
  return rows;
}

std::vector<double> size_of(const Shape& shape) {
  switch (shape.kind) {
    case Shape::Kind::Sphere:
      return {shape.size[0]};
    case Shape::Kind::Box:
      return {shape.size[0], shape.size[1], shape.size[2]};
    case Shape::Kind::Cylinder:
    case Shape::Kind::Capsule:
      return {shape.size[0], shape.size[1]};
    default:
      break;
  }
  return {};
}

const char* const kFieldDoc =
    R"(What signed distances on a grid are at most 0 in: nvblox, voxblox, Open3D, distance transforms.

The robot keeps off by the values along its hulls' axes, interpolated between the cells' middles. That
is exact beside what is flat, and off by 0.87 cells at most: at edges, and in gaps of a cell. Distances
that were truncated or not known follow from the others, to a cell more. Outside of the grid nothing is
in the way. A field is made ready once and shared by all scenes and threads: some 0.1 s for 200^3 cells,
1 s where distances have to be found.

Args:
    name: What results call it.
    values: Signed distances, positive outside of what is solid, floats of shape (X, Y, Z) [m]. Value
        (i, j, k) is that of the middle of its cell, which goes from cell (i, j, k) to
        cell (i + 1, j + 1, k + 1) in the shape's frame, as in `grid`. Not known is what is NaN or
        infinite, and one number that is farther from all others than the grid is wide, such as 1000.
    cell: The edge of a cell [m].
    T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame itself.
    truncation: Values of this size and more say "at least so far" [m]; math.inf if none does. None to
        tell from the values: the largest, if a tenth of the known ones are that.
    unknown: What cells hold whose distance is not known: "free" for nothing, "occupied" for something.

Raises:
    ValueError: Names the shape and what is wrong with it: no array of floats (X, Y, Z) with two cells
        along each axis, none that is known, a cell that is not positive, or values that cannot be
        distances in metres, since they change faster or slower than cells lie apart.)";

using AnyTuple = py::typing::Tuple<py::object, py::ellipsis>;

AnyTuple shape_state(const Shape& shape) {
  return py::make_tuple(shape.name, static_cast<int>(shape.kind),
                        Matrix4(shape.T_base_shape.matrix()), shape.size, vertices_of(shape),
                        triangles_of(shape), values_of(shape),
                        shape.field ? shape.field->cell() : 0.0);
}

Shape of_state(const AnyTuple& state) {
  Shape shape;
  shape.name = state[0].cast<std::string>();
  shape.kind = static_cast<Shape::Kind>(state[1].cast<int>());
  shape.T_base_shape.matrix() = state[2].cast<Matrix4>();
  shape.size = state[3].cast<Eigen::Vector3d>();
  const auto vertices = state[4].cast<Vertices>();
  for (Eigen::Index i = 0; i < vertices.rows(); ++i)
    shape.vertices.emplace_back(vertices.row(i).transpose());
  const auto triangles = state[5].cast<Triangles>();
  for (Eigen::Index i = 0; i < triangles.rows(); ++i)
    shape.triangles.push_back({triangles(i, 0), triangles(i, 1), triangles(i, 2)});
  if (shape.kind != Shape::Kind::DistanceField) return shape;
  const auto values = state[6].cast<Values>();
  if (values.ndim() != 3) throw std::invalid_argument("values is no array of shape (X, Y, Z)");
  // They are known everywhere already.
  DistanceField::Options known;
  known.truncation = std::numeric_limits<double>::infinity();
  shape.field = field_of(values, state[7].cast<double>(), known);
  return shape;
}

}  // namespace

void bind_shape(py::module_& module) {
  const char* const kPose =
      "    T_base_shape: Its frame in the base frame, shape (4, 4); None for the base frame "
      "itself.\n";
  const auto doc = [&](const std::string& first, const std::string& arguments, bool has_pose) {
    return first + "\n\nArgs:\n    name: What results call it.\n" + arguments +
           (has_pose ? kPose : "") +
           "\nRaises:\n    ValueError: Names the shape and what is wrong with it.";
  };
  py::class_<Shape>(
      module, "Shape",
      R"(A solid, or a surface, that the robot has to keep off, beside points. It does not change.)")
      .def_static(
          "sphere",
          [](const std::string& name, const ArrayLike& center, double radius) {
            return checked(Shape::sphere(name, to_vector3(center, "center"), radius));
          },
          py::arg("name"), py::arg("center"), py::arg("radius"),
          doc("A ball.", "    center: In the base frame, shape (3,) [m].\n    radius: [m].\n",
              false)
              .c_str())
      .def_static(
          "box",
          [](const std::string& name, const ArrayLike& size, const std::optional<ArrayLike>& T) {
            return checked(Shape::box(name, pose(T), to_vector3(size, "size")));
          },
          py::arg("name"), py::arg("size"), py::arg("T_base_shape") = py::none(),
          doc("A box along its frame's axes, with the origin in its middle.",
              "    size: The lengths of its edges, shape (3,) [m].\n", true)
              .c_str())
      .def_static(
          "cylinder",
          [](const std::string& name, double radius, double length,
             const std::optional<ArrayLike>& T) {
            return checked(Shape::cylinder(name, pose(T), radius, length));
          },
          py::arg("name"), py::arg("radius"), py::arg("length"),
          py::arg("T_base_shape") = py::none(),
          doc("A cylinder about its frame's z axis, with the origin in its middle.",
              "    radius: [m].\n    length: [m].\n", true)
              .c_str())
      .def_static(
          "capsule",
          [](const std::string& name, double radius, double length,
             const std::optional<ArrayLike>& T) {
            return checked(Shape::capsule(name, pose(T), radius, length));
          },
          py::arg("name"), py::arg("radius"), py::arg("length"),
          py::arg("T_base_shape") = py::none(),
          doc("A cylinder between two half balls, about its frame's z axis.",
              "    radius: [m].\n    length: Without the half balls [m].\n", true)
              .c_str())
      .def_static(
          "half_space",
          [](const std::string& name, const ArrayLike& normal, const ArrayLike& point) {
            return checked(
                Shape::half_space(name, to_vector3(normal, "normal"), to_vector3(point, "point")));
          },
          py::arg("name"), py::arg("normal"), py::arg("point"),
          doc("All behind a plane: a table, a floor, a wall.",
              "    normal: Out of the solid, of any length, shape (3,).\n"
              "    point: On the plane, shape (3,) [m].\n",
              false)
              .c_str())
      .def_static(
          "convex_mesh", &convex_mesh, py::arg("name"), py::arg("vertices"),
          py::arg("T_base_shape") = py::none(), py::arg("triangles") = py::none(),
          doc("A convex solid by its corners.",
              "    vertices: In its frame, shape (N, 3) [m].\n"
              "    triangles: Its surface, closed and convex, each three places in `vertices`,"
              " counter-clockwise\n        seen from outside, shape (T, 3). None for the convex"
              " hull of the vertices.\n",
              true)
              .c_str())
      .def_static(
          "mesh", &mesh, py::arg("name"), py::arg("vertices"), py::arg("triangles"),
          py::arg("T_base_shape") = py::none(),
          (doc("A surface of triangles of any form, such as a part, a bin or a scanned room.\n\n"
               "Where it is closed what is inside counts too, by the winding number: of what has a "
               "radius of a\nfortieth of its longest side everywhere inside, of thinner parts of a "
               "robot where they come near the\nsurface. It is made ready whenever a Scene is "
               "made of it: a second for some 400,000 triangles.",
               "    vertices: In its frame, shape (N, 3) [m]. Those at one place count as one.\n"
               "    triangles: Each three places in `vertices`, shape (T, 3); of a closed mesh all "
               "clockwise or all\n        counter-clockwise seen from outside.\n",
               true) +
           "\n\nWarns:\n    ObstacleWarning: It is not closed: its surface alone is kept off.")
              .c_str())
      .def_static("boxes", &boxes, py::arg("name"), py::arg("low"), py::arg("high"),
                  py::arg("T_base_shape") = py::none(),
                  doc("Several boxes along its frame's axes, under one name.",
                      "    low: The lowest corner of each, shape (N, 3) [m].\n"
                      "    high: The highest, shape (N, 3) [m].\n",
                      true)
                      .c_str())
      .def_static(
          "grid", &grid, py::arg("name"), py::arg("taken"), py::arg("edge"),
          py::arg("T_base_shape") = py::none(),
          doc("The cells of a grid that are taken, put together to few boxes: an occupancy grid, "
              "voxels.",
              "    taken: Bool, shape (I, J, K). Cell (i, j, k) goes from edge (i, j, k) to "
              "edge (i + 1, j + 1, k + 1)\n        in its frame.\n"
              "    edge: Of a cell [m].\n",
              true)
              .c_str())
      .def_static("distance_field", &distance_field, py::arg("name"), py::arg("values"),
                  py::arg("cell"), py::arg("T_base_shape") = py::none(),
                  py::arg("truncation") = py::none(), py::arg("unknown") = "free", kFieldDoc)
      .def_readonly("name", &Shape::name, "What results call it.")
      .def_property_readonly(
          "kind", [](const Shape& self) { return KindName(py::str(to_name(self.kind))); },
          "What it is, by the name of what makes it.")
      .def_property_readonly(
          "T_base_shape", [](const Shape& self) { return Matrix4(self.T_base_shape.matrix()); },
          "Its frame in the base frame, shape (4, 4) [m].")
      .def_property_readonly("size", &size_of,
                             "Edges of a box; radius, and length if it has one [m]. Else empty.")
      .def_property_readonly(
          "vertices", &vertices_of,
          "Of a mesh, shape (N, 3) [m]; of boxes the lowest and the highest corner of each; else "
          "empty.")
      .def_property_readonly("triangles", &triangles_of, "Of a mesh, shape (T, 3); else empty.")
      .def_property_readonly(
          "values", &values_of,
          "Of a distance field, as it uses them, shape (X, Y, Z) [m], read-only; else empty.")
      .def_property_readonly(
          "cell",
          [](const Shape& self) {
            return self.field ? std::optional(self.field->cell()) : std::nullopt;
          },
          "The edge of a distance field's cells [m]; None of others.")
      .def(
          "moved",
          [](const Shape& self, const ArrayLike& T_base_shape) {
            Shape shape = self;
            shape.T_base_shape = to_isometry(T_base_shape, "T_base_shape");
            return checked(std::move(shape));
          },
          py::arg("T_base_shape"), "The same solid with its frame elsewhere, shape (4, 4) [m].")
      .def("__repr__",
           [](const Shape& self) {
             return py::str("<Shape '{}', a {}>").format(self.name, to_name(self.kind));
           })
      .def(py::pickle(&shape_state, &of_state));
}

}  // namespace pdoik::python
