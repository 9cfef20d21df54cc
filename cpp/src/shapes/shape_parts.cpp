#include "shapes/shape_parts.hpp"

#include <algorithm>
#include <span>

#include "shapes/mesh_inside.hpp"

namespace pdoik::detail {
namespace {

/// So many triangles are a part of a surface.
constexpr std::ptrdiff_t kTogether = 8;
/// A triangle's height over its longest edge below which it counts as having no area.
constexpr double kThinnest = 1e-9;

/// Halve triangles by their middles until they are few, along the side where they go farthest.
void add_surface(std::span<Triangle> triangles, bool is_closed, std::vector<Solid>& parts) {
  const auto count = static_cast<std::ptrdiff_t>(triangles.size());
  if (count <= kTogether) {
    parts.emplace_back(std::vector<Triangle>(triangles.begin(), triangles.end()), is_closed);
    return;
  }
  const auto place = [](const Triangle& t, int axis) {
    return 3.0 * t.a[axis] + t.ab[axis] + t.ac[axis];
  };
  int along = 0;
  double widest = -1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto [least, most] = std::ranges::minmax(
        triangles, {}, [&](const Triangle& triangle) { return place(triangle, axis); });
    const double wide = place(most, axis) - place(least, axis);
    if (!(wide > widest)) continue;
    widest = wide;
    along = axis;
  }
  const auto half = static_cast<std::size_t>(count / 2);
  std::ranges::nth_element(triangles, triangles.begin() + count / 2, {},
                           [&](const Triangle& triangle) { return place(triangle, along); });
  add_surface(triangles.first(half), is_closed, parts);
  add_surface(triangles.subspan(half), is_closed, parts);
}

void add_mesh(const Shape& shape, std::vector<Solid>& parts) {
  std::vector<Eigen::Vector3d> vertices;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : shape.vertices) {
    vertices.push_back(shape.T_base_shape * vertex);
    box.extend(vertices.back());
  }
  std::vector<Triangle> triangles;
  triangles.reserve(shape.triangles.size());
  for (const auto& [i, j, k] : shape.triangles) {
    const auto at = [&](int n) { return vertices[static_cast<std::size_t>(n)]; };
    const Eigen::Vector3d ab = at(j) - at(i), ac = at(k) - at(i);
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    // One of no area is nothing but an edge of others.
    if (ab.cross(ac).norm() > kThinnest * longest) triangles.emplace_back(at(i), at(j), at(k));
  }
  const bool is_closed = open_edges(shape) == 0;
  std::vector<Eigen::AlignedBox3d> inside;
  if (is_closed) inside = boxes_inside(triangles, box);
  add_surface(triangles, is_closed, parts);
  for (const Eigen::AlignedBox3d& each : inside) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = each.center();
    parts.emplace_back(Shape::box({}, T, each.sizes()));
  }
}

}  // namespace

std::vector<Solid> parts_of(const Shape& shape) {
  check_shape(shape);
  std::vector<Solid> parts;
  if (shape.kind == Shape::Kind::Mesh) {
    add_mesh(shape, parts);
  } else if (shape.kind == Shape::Kind::Boxes) {
    for (std::size_t k = 0; k < shape.vertices.size(); k += 2) {
      const Eigen::AlignedBox3d box(shape.vertices[k], shape.vertices[k + 1]);
      Eigen::Isometry3d T = shape.T_base_shape;
      T.translate(box.center());
      parts.emplace_back(Shape::box({}, T, box.sizes()));
    }
  } else {
    parts.emplace_back(shape);
  }
  return parts;
}

}  // namespace pdoik::detail
