#pragma once

#include <array>
#include <string>
#include <vector>

#include "pdoik/shape.hpp"
#include "random_robots.hpp"

namespace pdoik::testing {

inline std::vector<std::array<int, 3>> box_triangles() {
  return {{0, 3, 1}, {0, 2, 3}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
          {2, 7, 3}, {2, 6, 7}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
}
inline std::vector<Eigen::Vector3d> box_corners(const Eigen::Vector3d& size) {
  std::vector<Eigen::Vector3d> corners;
  for (int k = 0; k < 8; ++k)
    corners.emplace_back((k & 1 ? 0.5 : -0.5) * size.x(), (k & 2 ? 0.5 : -0.5) * size.y(),
                         (k & 4 ? 0.5 : -0.5) * size.z());
  return corners;
}

inline Shape random_shape(Random& random, int kind, const std::string& name = "thing") {
  const Eigen::Isometry3d T = random.pose(0.5);
  const auto length = [&] { return random.uniform(0.05, 0.5); };
  switch (kind % 6) {
    case 0:
      return Shape::sphere(name, T.translation(), length());
    case 1:
      return Shape::box(name, T, {length(), length(), length()});
    case 2:
      return Shape::cylinder(name, T, length(), length());
    case 3:
      return Shape::capsule(name, T, length(), length());
    case 4:
      return Shape::half_space(name, random.uniform(0.1, 3.0) * random.direction(),
                               random.point(0.5));
    default:
      return Shape::convex_mesh(name, T, box_corners({length(), length(), length()}),
                                box_triangles());
  }
}

/// The nearest point of a solid to one outside of it: the distance is convex, so that projecting a
/// point of the solid step by step towards the point outside ends there.
inline Eigen::Vector3d projected(const Shape& shape, const Eigen::Vector3d& p) {
  const Eigen::Vector3d local = shape.T_base_shape.inverse() * p;
  const Eigen::Vector3d size = shape.size;
  Eigen::Vector3d q = local;
  const auto into_disc = [&](double radius) {
    const double rho = q.head<2>().norm();
    if (rho > radius) q.head<2>() *= radius / rho;
  };
  Eigen::Vector3d half = 0.5 * size;
  switch (shape.kind) {
    case Shape::Kind::Sphere:
      if (q.norm() > size[0]) q *= size[0] / q.norm();
      break;
    case Shape::Kind::ConvexMesh:
      half = shape.vertices.back();
      [[fallthrough]];
    case Shape::Kind::Box:
      q = q.cwiseMax(-half).cwiseMin(half);
      break;
    case Shape::Kind::Cylinder:
      into_disc(size[0]);
      q.z() = std::clamp(q.z(), -half[1], half[1]);
      break;
    case Shape::Kind::Capsule: {
      const Eigen::Vector3d on(0.0, 0.0, std::clamp(q.z(), -half[1], half[1]));
      const double away = (q - on).norm();
      if (away > size[0]) q = on + (q - on) * (size[0] / away);
      break;
    }
    case Shape::Kind::HalfSpace:
      q.z() = std::min(q.z(), 0.0);
      break;
    case Shape::Kind::Mesh:
    case Shape::Kind::Boxes:
    case Shape::Kind::DistanceField:  // are not convex
      break;
  }
  return shape.T_base_shape * q;
}

}  // namespace pdoik::testing
