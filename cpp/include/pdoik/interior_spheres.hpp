#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "pdoik/point_cloud.hpp"

namespace pdoik {

/// Balls, one row each, x y z radius [m].
using Balls = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// How spheres find the inside of what a cloud is the surface of.
struct InteriorSphereOptions {
  /// Where the points were seen from, [m]: one row for all of them, or one for each, shape (N, 3).
  /// Empty if that is not known: then the inside is what the points enclose.
  Points viewpoints = Points(0, 3);
  /// At most this far does a sphere's centre go below the surface [m]; 0 for two leaves.
  double depth = 0.0;
  /// No centre leaves this, if it is given: a region that a cloud is to fill.
  std::optional<Eigen::AlignedBox3d> within = {};
};

/// The balls of voxel_downsample and covering_radii, moved inside the solids whose surface a cloud
/// shows: a ball that lies on the surface stands a whole radius r beyond it, one of the same patch
/// whose centre is at depth d only
///
///     R - d,  R = max over its points p of |p - c + d n|,  about r^2 / (2 d).
///
/// What holds: each point of the cloud is in a ball as it was before, to rounding, whatever was
/// made of it. So nothing is uncovered, and a wrong guess costs room only. A ball moves only where
/// that lessens R less the distance to the nearest point, which bounds how far it stands beyond
/// what is sampled; all others stay where they are, with the radius that they had. They stay where
/// - PCL has no normal of the points within a leaf: there are fewer than three;
/// - viewpoints of the points there lie on both sides of their plane, or within 10 degrees of it;
/// - without viewpoints, what lies behind is not enclosed, or what lies before is: the points are
///   put into cells of half a leaf, then of a leaf, and what can be reached from around the cloud
///   without crossing an occupied one is outside. A surface of which nothing is farther than half
///   a cell from a point lets nothing through; one with a hole in it encloses nothing, nor does a
///   board thinner than two cells;
/// - the other side of a board, or the face around an edge, is so near that nothing is won.
///
/// With viewpoints, what is behind a seen surface counts as solid: a sheet that was seen from one
/// side only grows on the other, by up to R + d, where nobody has looked. Beside an edge of what
/// was seen, a ball goes no deeper than such that the face behind that edge, if it goes straight
/// down, is passed by less than the ball stood out before.
/// @param points  (N, 3), the cloud before thinning; rows with NaN or infinity are left out.
/// @param kept  (K, 3), such as voxel_downsample's.
/// @param leaf  Edge of the cells that they were kept for [m].
/// @returns (K, 4), a ball for each kept point.
/// @throws std::invalid_argument as covering_radii does, on a number of viewpoints that is neither
/// 1 nor N, on one that is NaN or infinite, and on a depth that is negative or not finite.
/// In pdoik::io.
Balls interior_spheres(const Obstacles& points, const Points& kept, double leaf,
                       const InteriorSphereOptions& options = {});

/// The old name of InteriorSphereOptions.
using SinkOptions [[deprecated("InteriorSphereOptions")]] = InteriorSphereOptions;
/// The old name of interior_spheres.
[[deprecated("interior_spheres")]] inline Balls sunk_balls(
    const Obstacles& points, const Points& kept, double leaf,
    const InteriorSphereOptions& options = {}) {
  return interior_spheres(points, kept, leaf, options);
}

}  // namespace pdoik
