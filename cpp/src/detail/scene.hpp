#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

#include "detail/collision.hpp"

namespace pdoik::detail {

/// The obstacles of one scene, sorted by what the arm can do about them. Solvers that are copies of
/// each other share it.
struct Scene {
  using Points =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                 Eigen::OuterStride<>>;

  void reserve(std::size_t count);
  /// @param points  (N, 3) or (N, 4) rows x y z [radius]; radii grow by `margin`.
  /// @param fixed_hulls  A state of the hulls that no joint moves.
  void assign(const Points& points, double margin, const HullModel& hulls,
              CollisionState& fixed_hulls);
  /// Clearance of every hull, margin included, at the configuration where `moving` is placed.
  /// Leaves the states' near pairs changed.
  /// @param within_limits  Whether the joints are, so that what is out of reach stays so.
  /// @param look  What is farther is not looked for: the distance is then this, and nobody's [m].
  Clearance clearance(CollisionState& moving, CollisionState& fixed_hulls,
                      bool within_limits = true,
                      double look = std::numeric_limits<double>::infinity()) const;

  ObstacleSet near;  ///< within reach of a moving hull: the solver's
  ObstacleSet far;   ///< out of reach of all of them: only the reported clearance sees these
  double far_bound =
      std::numeric_limits<double>::infinity();  ///< no far one comes closer than this
  double fixed_far_bound =
      std::numeric_limits<double>::infinity();  ///< nor as close to a hull that no joint moves
  Clearance fixed;  ///< the deepest obstacle in a hull that no joint moves, if there is any

 private:
  CellOrder order_;
};

}  // namespace pdoik::detail
