#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <vector>

#include "pdoik/robot.hpp"
#include "pdoik/solver.hpp"

namespace pdoik {

namespace detail {
class CloudState;
}

/// Obstacle points in single precision, as cameras and PCL have them; see Obstacles.
using ObstaclesF =
    Eigen::Ref<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
               Eigen::OuterStride<>>;

/// Obstacle points that were taken in once, for any number of solves and solvers: put in the order
/// of the cells that they lie in, with boxes around neighbours, so that a solve among a million
/// looks at few of them.
///
///     pdoik::Cloud cloud(points);
///     solver.set_obstacles(cloud);           // microseconds, whatever its size
///     solver.solve(request, result);
///     cloud.update(seen, region);            // what the camera saw there, for what was there
///     solver.solve(request, result);         // among the new points
///
/// A copy is another handle of the same cloud. A solve sees the cloud as it is when it begins, for
/// an update makes another one beside it: no solve waits for an update and no update for a solve,
/// and any number of threads may solve and update at once. Updates take turns. A cloud that has
/// been updated takes twice the memory, and once more for each older one that is still solved
/// among.
class Cloud {
 public:
  /// No points.
  Cloud();
  /// Take points in.
  /// @param points  x y z, or x y z radius, one row each, in the base frame [m]. Read once, into a
  /// copy that is then checked and used: another thread may write into them meanwhile.
  /// @throws std::invalid_argument on a wrong shape, NaN or infinity, a negative radius or a number
  /// beyond 1e6, naming the row, and on more than kMostPoints.
  explicit Cloud(const Obstacles& points);
  /// The same in single precision.
  explicit Cloud(const ObstaclesF& points);

  /// More would take more than 2 GB.
  static constexpr std::size_t kMostPoints = std::size_t{1} << 25U;

  /// The number of points.
  std::size_t size() const;

  /// Put points in place of all those in a region, whose cost is twice that of what changes: it
  /// sorts the new points and looks at blocks of 16 that the region meets. The first time, where
  /// much changes, and while an older one is still solved among, it copies all; now and then, as
  /// room runs out, it makes the whole cloud anew.
  /// @param region  An axis-aligned box, its border included.
  /// @returns How many points there were.
  /// @throws std::invalid_argument as the constructor; on a region that is empty, inside out or no
  /// number; on points outside of it. The cloud is then as before.
  int update(const Obstacles& points, const Eigen::AlignedBox3d& region);
  /// The same in single precision.
  int update(const ObstaclesF& points, const Eigen::AlignedBox3d& region);
  /// Take out the points in a region.
  /// @returns How many there were.
  int remove(const Eigen::AlignedBox3d& region);
  /// Take out the points that lie in the robot's hulls, or within a distance of them: its own
  /// surface, as a camera sees it.
  /// @param q  Where the robot is, shape (n,), [rad] or [m].
  /// @param padding  For what noise and calibration hide [m].
  /// @returns How many there were.
  /// @throws std::invalid_argument on a wrong length, NaN or infinity, a negative padding, or a
  /// robot without occupancy.
  int remove_robot(const Robot& robot, VectorIn q, double padding = 0.0);

  /// Rows x y z radius, in the cloud's own order, shape (N, 4) [m].
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> points() const;
  /// Some of them, spread over all, shape (K, 4) with K <= most.
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> sample(int most) const;
  /// What results call each of `points` (WorstConstraint's obstacle): its row when it was taken in,
  /// numbered on with each update.
  std::vector<int> ids() const;
  /// The memory that the points take, with those of older ones that are kept [bytes].
  std::size_t bytes() const;

 private:
  friend class Solver;
  friend class Tracker;
  std::shared_ptr<detail::CloudState> state_;
};

}  // namespace pdoik
