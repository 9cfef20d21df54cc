#include "pdoik/shape.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "common/check_input.hpp"
#include "shapes/cell_grid.hpp"

namespace pdoik {
namespace {

/// A mesh may be this far from convex, as a share of its extent.
constexpr double kFlatEnough = 1e-4;

[[noreturn]] void refuse(const Shape& shape, const std::string& what) {
  throw std::invalid_argument("shape '" + shape.name + "': " + what);
}

void check_length(const Shape& shape, const char* name, double length) {
  if (length > 0.0 && length <= detail::kLargestNumber) return;
  refuse(shape, std::string(name) + " is " + std::to_string(length) +
                    ", expected a positive length of at most 1e6 m");
}

void check_vertices(const Shape& shape) {
  for (const Eigen::Vector3d& vertex : shape.vertices) {
    if (!vertex.allFinite() || vertex.cwiseAbs().maxCoeff() > detail::kLargestNumber)
      refuse(shape, "a vertex is not finite or beyond 1e6 m");
  }
}

/// @param least  Vertices and triangles that there have to be.
void check_indices(const Shape& shape, std::size_t least) {
  const auto count = static_cast<int>(shape.vertices.size());
  if (shape.vertices.size() < std::max<std::size_t>(least, 3) || shape.triangles.size() < least)
    refuse(shape, "a mesh of " + std::to_string(count) + " vertices and " +
                      std::to_string(shape.triangles.size()) + " triangles, expected " +
                      std::to_string(least) + " at least");
  check_vertices(shape);
  for (const auto& triangle : shape.triangles) {
    for (const int k : triangle) {
      if (k < 0 || k >= count)
        refuse(shape,
               "a triangle names vertex " + std::to_string(k) + " of " + std::to_string(count));
    }
  }
}

/// Each edge is there once in each direction.
void check_closed(const Shape& shape) {
  std::map<std::pair<int, int>, int> edges;
  for (const auto& t : shape.triangles) {
    for (int i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end())
      refuse(shape, "the mesh has a hole, or triangles that turn different ways, at vertices " +
                        std::to_string(edge.first) + " and " + std::to_string(edge.second));
  }
}

void check_area(const Shape& shape) {
  for (const auto& [i, j, k] : shape.triangles) {
    const auto at = [&](int n) { return shape.vertices[static_cast<std::size_t>(n)]; };
    const Eigen::Vector3d ab = at(j) - at(i), ac = at(k) - at(i);
    if (ab.cross(ac).norm() > 1e-6 * std::max(ab.squaredNorm(), ac.squaredNorm())) return;
  }
  refuse(shape, "no triangle of the mesh has an area");
}

void check_boxes(const Shape& shape) {
  if (shape.vertices.empty() || shape.vertices.size() % 2 != 0)
    refuse(shape, std::to_string(shape.vertices.size()) +
                      " corners, expected a lowest and a highest one of each box");
  check_vertices(shape);
  for (std::size_t k = 0; k < shape.vertices.size(); k += 2) {
    if (!(shape.vertices[k].array() < shape.vertices[k + 1].array()).all())
      refuse(shape, "box " + std::to_string(k / 2) + " has no room inside");
  }
}

void check_convex(const Shape& shape) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : shape.vertices) box.extend(vertex);
  const double extent = box.diagonal().norm(), slack = kFlatEnough * extent;
  double volume = 0.0;
  for (const auto& [i, j, k] : shape.triangles) {
    const auto at = [&](int n) { return shape.vertices[static_cast<std::size_t>(n)]; };
    const Eigen::Vector3d a = at(i), across = (at(j) - a).cross(at(k) - a);
    volume += across.dot(a - box.center()) / 6.0;
    if (!(across.norm() > 1e-12 * extent * extent)) continue;  // of no area
    const Eigen::Vector3d normal = across.normalized();
    for (const Eigen::Vector3d& vertex : shape.vertices) {
      const double above = normal.dot(vertex - a);
      if (above > slack)
        refuse(shape, "the mesh is not convex (or its triangles turn clockwise): a vertex lies " +
                          std::to_string(above) + " m outside of a face");
    }
  }
  if (!(volume > 1e-9 * extent * extent * extent)) refuse(shape, "the mesh is flat");
}

}  // namespace

void check_shape(const Shape& shape) {
  if (shape.name.empty()) throw std::invalid_argument("a shape has no name");
  detail::check_target(shape.T_base_shape, "shape '" + shape.name + "': T_base_shape");
  switch (shape.kind) {
    case Shape::Kind::Sphere:
      check_length(shape, "radius", shape.size[0]);
      break;
    case Shape::Kind::Box:
      for (int i = 0; i < 3; ++i) check_length(shape, "an edge of its size", shape.size[i]);
      break;
    case Shape::Kind::Cylinder:
    case Shape::Kind::Capsule:
      check_length(shape, "radius", shape.size[0]);
      check_length(shape, "length", shape.size[1]);
      break;
    case Shape::Kind::HalfSpace:
      break;
    case Shape::Kind::ConvexMesh:
      check_indices(shape, 4);
      check_closed(shape);
      check_convex(shape);
      break;
    case Shape::Kind::Mesh:
      check_indices(shape, 1);
      check_area(shape);
      break;
    case Shape::Kind::Boxes:
      check_boxes(shape);
      break;
    case Shape::Kind::DistanceField:
      if (!shape.field) refuse(shape, "a distance field without its values");
      break;
  }
}

Shape Shape::sphere(std::string name, const Eigen::Vector3d& center, double radius) {
  Shape shape{std::move(name), Kind::Sphere};
  shape.T_base_shape.translation() = center;
  shape.size[0] = radius;
  return shape;
}

Shape Shape::box(std::string name, const Eigen::Isometry3d& T_base_shape,
                 const Eigen::Vector3d& size) {
  return {std::move(name), Kind::Box, T_base_shape, size};
}

Shape Shape::cylinder(std::string name, const Eigen::Isometry3d& T_base_shape, double radius,
                      double length) {
  return {std::move(name), Kind::Cylinder, T_base_shape, {radius, length, 0.0}};
}

Shape Shape::capsule(std::string name, const Eigen::Isometry3d& T_base_shape, double radius,
                     double length) {
  return {std::move(name), Kind::Capsule, T_base_shape, {radius, length, 0.0}};
}

Shape Shape::half_space(std::string name, const Eigen::Vector3d& normal,
                        const Eigen::Vector3d& point) {
  Shape shape{std::move(name), Kind::HalfSpace};
  if (!(normal.norm() > 1e-9) || !normal.allFinite()) refuse(shape, "its normal is no direction");
  shape.T_base_shape.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal).toRotationMatrix();
  shape.T_base_shape.translation() = point;
  return shape;
}

Shape Shape::convex_mesh(std::string name, const Eigen::Isometry3d& T_base_shape,
                         std::vector<Eigen::Vector3d> vertices,
                         std::vector<std::array<int, 3>> triangles) {
  return {std::move(name),         Kind::ConvexMesh,    T_base_shape,
          Eigen::Vector3d::Zero(), std::move(vertices), std::move(triangles)};
}

Shape Shape::mesh(std::string name, const Eigen::Isometry3d& T_base_shape,
                  std::vector<Eigen::Vector3d> vertices,
                  std::vector<std::array<int, 3>> triangles) {
  Shape shape =
      convex_mesh(std::move(name), T_base_shape, std::move(vertices), std::move(triangles));
  shape.kind = Kind::Mesh;
  return shape;
}

Shape Shape::boxes(std::string name, const Eigen::Isometry3d& T_base_shape,
                   std::span<const Eigen::AlignedBox3d> boxes) {
  Shape shape{std::move(name), Kind::Boxes, T_base_shape};
  for (const Eigen::AlignedBox3d& box : boxes) {
    shape.vertices.push_back(box.min());
    shape.vertices.push_back(box.max());
  }
  return shape;
}

Shape Shape::grid(std::string name, const Eigen::Isometry3d& T_base_shape,
                  std::span<const std::uint8_t> taken, const std::array<int, 3>& counts,
                  double edge) {
  Shape shape{std::move(name), Kind::Boxes, T_base_shape};
  check_length(shape, "edge", edge);
  std::size_t cells = 1;
  for (const int count : counts) {
    if (count < 0) refuse(shape, std::to_string(count) + " cells along an axis");
    cells *= static_cast<std::size_t>(count);
  }
  if (cells != taken.size())
    refuse(shape, std::to_string(taken.size()) + " cells, expected " + std::to_string(cells));
  detail::CellGrid grid(counts);
  for (std::size_t k = 0; k < cells; ++k) grid.taken[k] = taken[k] != 0;
  for (const detail::CellBox& box : grid.take_boxes()) {
    shape.vertices.push_back(edge * box.low.cast<double>());
    shape.vertices.push_back(edge * box.high.cast<double>());
  }
  if (shape.vertices.empty()) refuse(shape, "no cell of the grid is taken");
  return shape;
}

Shape Shape::distance_field(std::string name, const Eigen::Isometry3d& T_base_shape,
                            pdoik::DistanceField field) {
  Shape shape{std::move(name), Kind::DistanceField, T_base_shape};
  shape.field = std::move(field);
  return shape;
}

}  // namespace pdoik
