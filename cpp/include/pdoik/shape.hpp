#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "pdoik/distance_field.hpp"

namespace pdoik {

/// A solid, or a surface, that the robot has to keep off, beside points. Lengths in metres, in the
/// base frame.
struct Shape {
  /// What it is, about its own frame.
  enum class Kind {
    Sphere,      ///< about the frame's origin
    Box,         ///< along the frame's axes, the origin in its middle
    Cylinder,    ///< about the frame's z axis, the origin in its middle
    Capsule,     ///< a cylinder between two half balls: all within `radius` of a part of the z axis
    HalfSpace,   ///< all below the frame's xy plane: a table, a floor, a wall
    ConvexMesh,  ///< a closed surface of triangles
    Mesh,        ///< a surface of triangles of any form, and what is inside if it is closed
    Boxes,       ///< several boxes along the frame's axes, such as the cells of a grid
    DistanceField,  ///< what a field of signed distances is at most 0 in
  };

  std::string name;                                                ///< in results, not empty
  Kind kind = Kind::Sphere;                                        ///< what it is
  Eigen::Isometry3d T_base_shape = Eigen::Isometry3d::Identity();  ///< of its frame
  /// Box: the lengths of its edges. Sphere: its radius, twice nothing. Cylinder and Capsule: radius
  /// and length, a capsule's without its half balls. Unused otherwise.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  /// Of a mesh, in the shape's frame; of boxes the lowest and the highest corner of each.
  std::vector<Eigen::Vector3d> vertices = {};
  std::vector<std::array<int, 3>> triangles = {};  ///< counter-clockwise seen from outside
  /// Of a distance field, in the shape's frame; shared with all copies.
  std::optional<pdoik::DistanceField> field = {};

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
  /// A surface of any form: concave, in several bodies, open. Where each edge has a triangle on
  /// both sides (open_edges() is 0) what is inside counts too, by the winding number; of an open
  /// one the surface alone is kept off. A part of the robot whose radius is less than a fortieth of
  /// the mesh's longest side is noticed inside only if it comes near the surface.
  /// @param vertices  In the shape's frame [m]. Those at one place count as one.
  /// @param triangles  Of a closed mesh, all clockwise or all counter-clockwise seen from outside.
  static Shape mesh(std::string name, const Eigen::Isometry3d& T_base_shape,
                    std::vector<Eigen::Vector3d> vertices,
                    std::vector<std::array<int, 3>> triangles);
  /// Several boxes along its frame's axes.
  /// @param boxes  Each by its lowest and its highest corner [m].
  static Shape boxes(std::string name, const Eigen::Isometry3d& T_base_shape,
                     std::span<const Eigen::AlignedBox3d> boxes);
  /// The cells of a grid that are taken, put together to few boxes: an occupancy grid, an octree's
  /// leaves of one size. Cell (i, j, k) goes from (i, j, k) to (i + 1, j + 1, k + 1) edges.
  /// @param taken  Of cell (i, j, k) at (i counts[1] + j) counts[2] + k; 0 where it is free.
  /// @param edge  Of a cell [m].
  /// @throws std::invalid_argument  Another number of cells, or none is taken.
  static Shape grid(std::string name, const Eigen::Isometry3d& T_base_shape,
                    std::span<const std::uint8_t> taken, const std::array<int, 3>& counts,
                    double edge);
  /// What a field of signed distances is at most 0 in. Hulls keep off by the field's values along
  /// their axes, which it says the error of; a field that is interpolated may be steeper than 1 at
  /// edges and in gaps of a cell, and there tells of more than that.
  static Shape distance_field(std::string name, const Eigen::Isometry3d& T_base_shape,
                              pdoik::DistanceField field);
  /// @}
};

/// How many edges of a mesh do not have as many triangles on one side as on the other: 0 of a
/// closed one. Vertices at one place count as one.
int open_edges(const Shape& mesh);

/// Says whether a shape may be used.
/// @throws std::invalid_argument  naming the shape and what is wrong with it: no name, a pose that
/// is not rigid to 1e-6, NaN or infinity, a number beyond 1e6 m, a size that is not positive; a
/// convex mesh with a hole, with triangles that turn the wrong way, or that is not convex to a ten
/// thousandth of its extent; a mesh of no area.
void check_shape(const Shape& shape);

}  // namespace pdoik
