#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

namespace pdoik {

/// A convex solid that the robot has to keep off, beside points. Lengths in metres, in the base
/// frame.
struct Shape {
  /// What it is, about its own frame.
  enum class Kind {
    Sphere,      ///< about the frame's origin
    Box,         ///< along the frame's axes, the origin in its middle
    Cylinder,    ///< about the frame's z axis, the origin in its middle
    Capsule,     ///< a cylinder between two half balls: all within `radius` of a part of the z axis
    HalfSpace,   ///< all below the frame's xy plane: a table, a floor, a wall
    ConvexMesh,  ///< a closed surface of triangles
  };

  std::string name;                                                ///< in results, not empty
  Kind kind = Kind::Sphere;                                        ///< what it is
  Eigen::Isometry3d T_base_shape = Eigen::Isometry3d::Identity();  ///< of its frame
  /// Box: the lengths of its edges. Sphere: its radius, twice nothing. Cylinder and Capsule: radius
  /// and length, a capsule's without its half balls. Unused otherwise.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> vertices = {};      ///< of a mesh, in the shape's frame
  std::vector<std::array<int, 3>> triangles = {};  ///< counter-clockwise seen from outside

  /// @name Making one
  /// @{

  /// A ball.
  /// @param radius  [m]
  static Shape sphere(std::string name, const Eigen::Vector3d& center, double radius);
  /// A box about its frame's origin.
  /// @param size  Lengths of its edges [m].
  static Shape box(std::string name, const Eigen::Isometry3d& T_base_shape,
                   const Eigen::Vector3d& size);
  /// A cylinder along its frame's z axis, the origin in its middle [m].
  static Shape cylinder(std::string name, const Eigen::Isometry3d& T_base_shape, double radius,
                        double length);
  /// The same with half balls at its ends, which `length` leaves out [m].
  static Shape capsule(std::string name, const Eigen::Isometry3d& T_base_shape, double radius,
                       double length);
  /// All on the side of a plane that its normal points away from.
  /// @param normal  Of any length but 0.
  /// @param point  On the plane.
  static Shape half_space(std::string name, const Eigen::Vector3d& normal,
                          const Eigen::Vector3d& point);
  /// A convex solid by its surface, see check_shape.
  /// @param vertices  In the shape's frame [m].
  /// @param triangles  Counter-clockwise seen from outside.
  static Shape convex_mesh(std::string name, const Eigen::Isometry3d& T_base_shape,
                           std::vector<Eigen::Vector3d> vertices,
                           std::vector<std::array<int, 3>> triangles);
  /// @}
};

/// Says whether a shape may be used.
/// @throws std::invalid_argument  naming the shape and what is wrong with it: no name, a pose that
/// is not rigid to 1e-6, NaN or infinity, a number beyond 1e6 m, a size that is not positive; a
/// mesh with a hole, with triangles that turn the wrong way, or that is not convex to a ten
/// thousandth of its extent.
void check_shape(const Shape& shape);

}  // namespace pdoik
