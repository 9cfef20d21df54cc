#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "pdoik/shape.hpp"

namespace pdoik::testing {

using MeshTriangles = std::vector<std::array<int, 3>>;

/// A ring about the z axis: of what is within `thick` of a circle of `radius` [m],
/// counter-clockwise seen from outside.
inline Shape torus(std::string name, const Eigen::Isometry3d& T, double radius, double thick,
                   int around, int across) {
  std::vector<Eigen::Vector3d> vertices;
  MeshTriangles triangles;
  const auto number = [&](int i, int j) { return i % around * across + j % across; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2.0 * M_PI * i / around, b = 2.0 * M_PI * j / across;
      const double out = radius + thick * std::cos(b);
      vertices.emplace_back(out * std::cos(a), out * std::sin(a), thick * std::sin(b));
      const int here = number(i, j), on = number(i + 1, j), up = number(i, j + 1),
                both = number(i + 1, j + 1);
      triangles.push_back({here, on, both});
      triangles.push_back({here, both, up});
    }
  }
  return Shape::mesh(std::move(name), T, std::move(vertices), std::move(triangles));
}

/// A box about its frame's origin as a mesh, each face cut into squares.
inline Shape box_mesh(std::string name, const Eigen::Isometry3d& T, const Eigen::Vector3d& size,
                      int cuts) {
  std::vector<Eigen::Vector3d> vertices;
  MeshTriangles triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3, first = static_cast<int>(vertices.size());
      for (int i = 0; i <= cuts; ++i) {
        for (int j = 0; j <= cuts; ++j) {
          Eigen::Vector3d at;
          at[axis] = 0.5 * side * size[axis];
          at[u] = (static_cast<double>(i) / cuts - 0.5) * size[u];
          at[v] = (static_cast<double>(j) / cuts - 0.5) * size[v];
          vertices.push_back(at);
        }
      }
      for (int i = 0; i < cuts; ++i) {
        for (int j = 0; j < cuts; ++j) {
          const int here = first + i * (cuts + 1) + j, on = here + cuts + 1;
          if (side > 0.0) {
            triangles.push_back({here, on, on + 1});
            triangles.push_back({here, on + 1, here + 1});
          } else {
            triangles.push_back({here, on + 1, on});
            triangles.push_back({here, here + 1, on + 1});
          }
        }
      }
    }
  }
  return Shape::mesh(std::move(name), T, std::move(vertices), std::move(triangles));
}

/// The nearest point of a triangle (Ericson, "Real-Time Collision Detection", 5.1.5).
inline Eigen::Vector3d nearest_of_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                           const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  if (d3 >= 0.0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return b + (d4 - d3) / (d4 - d3 + d5 - d6) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

/// How far a point is from a mesh's surface.
inline double surface_distance(const Shape& mesh, const Eigen::Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [i, j, k] : mesh.triangles) {
    const auto at = [&](int n) -> Eigen::Vector3d {
      return mesh.T_base_shape * mesh.vertices[static_cast<std::size_t>(n)];
    };
    least = std::min(least, (p - nearest_of_triangle(p, at(i), at(j), at(k))).norm());
  }
  return least;
}

}  // namespace pdoik::testing
