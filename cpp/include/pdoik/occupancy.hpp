#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pdoik/abi.hpp"

namespace pdoik {

/// A ball fixed to a link (Eq. joint_coll_avoid): no obstacle point within `radius` of `center`.
struct Sphere {
  std::string link;                                  ///< by name
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< in the link frame [m]
  double radius = 0.0;                               ///< [m]
};

/// A prolate spheroid between two points of the robot (Eq. link_coll_avoid): the half sum of an
/// obstacle point's distances to both foci is at least `semi_major`. The foci may sit on different
/// links; where they come to be farther apart than twice semi_major the spheroid holds nothing.
struct Spheroid {
  std::string link_a;                                 ///< by name
  Eigen::Vector3d focus_a = Eigen::Vector3d::Zero();  ///< in link_a's frame [m]
  std::string link_b;                                 ///< by name
  Eigen::Vector3d focus_b = Eigen::Vector3d::Zero();  ///< in link_b's frame [m]
  double semi_major = 0.0;                            ///< [m]
};

/// What lies within `radius` of the segment from a to b, fixed to a link; a ball where they
/// coincide.
struct Capsule {
  std::string link;                             ///< by name
  Eigen::Vector3d a = Eigen::Vector3d::Zero();  ///< in the link frame [m]
  Eigen::Vector3d b = Eigen::Vector3d::Zero();  ///< in the link frame [m]
  double radius = 0.0;                          ///< [m]
  /// How far its surface stands beyond the link itself at most, 0 where nobody knows: so much less
  /// of it is certainly the link's [m].
  double overhang = 0.0;
};

/// A convex part of a link itself. All of a link's pieces together hold it, and stand beyond it by
/// no more than their tolerance.
struct ConvexPiece {
  std::string link;                                ///< by name
  std::vector<Eigen::Vector3d> vertices = {};      ///< in the link frame [m]
  std::vector<std::array<int, 3>> triangles = {};  ///< counter-clockwise from outside
  double tolerance = 0.0;                          ///< [m]
};

/// What a robot fills: hulls that obstacle points must stay out of. Any number per link.
///
/// Hulls come in two levels. Spheres and spheroids are the paper's, few and wide. A link that has
/// capsules as well is what these fill: its spheres and spheroids then only say where to look, and
/// are all that Method::Paper and InnerMethod::Lbfgs know.
///
/// Pieces are a third level: where a link's capsules touch something, its pieces say whether it
/// does (see Options::exact_contact). They are no hulls, and have no numbers.
struct Occupancy {
  std::vector<Sphere> spheres = {};      ///< balls
  std::vector<Spheroid> spheroids = {};  ///< between two points each
  std::vector<Capsule> capsules = {};    ///< close hulls
  std::vector<ConvexPiece> pieces = {};  ///< links themselves, of those that have capsules

  /// Whether there are no hulls.
  bool empty() const { return size() == 0; }
  /// The number of hulls. They are numbered spheres first, then spheroids, then capsules.
  std::size_t size() const { return spheres.size() + spheroids.size() + capsules.size(); }
};

/// Read an occupancy file. In pdoik::io.
/// @param path_or_text  A file's path, or YAML text (recognised by a line break or colon-space).
/// @throws LoadError naming the file, the entry and what is wrong with it.
Occupancy load_occupancy(const std::string& path_or_text);

/// The YAML text that load_occupancy reads back exactly. In pdoik::io.
std::string to_yaml(const Occupancy& occupancy);

}  // namespace pdoik
