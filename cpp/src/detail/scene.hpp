#pragma once

#include <Eigen/Core>
#include <limits>

#include "detail/collision.hpp"
#include "detail/model.hpp"

namespace pdoik::detail {

/// The obstacles of one scene, sorted by what the arm can do about them. Solvers that are copies of
/// each other share it.
struct Scene {
  using Points =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                 Eigen::OuterStride<>>;

  /// No obstacles, and room for as many as the options say. The model outlives it.
  explicit Scene(const Model& model);
  /// @param points  (N, 3) or (N, 4) rows x y z [radius]; radii grow by the options' clearance.
  void assign(const Points& points, const Model& model);
  /// Clearance of every hull, margin included, at the configuration where `moving` is placed.
  /// Leaves the states' near pairs changed.
  /// @param within_limits  Whether the joints are, so that what is out of reach stays so.
  /// @param look  What is farther is not looked for: the distance is then this, and nobody's [m].
  Clearance clearance(CollisionState& moving, CollisionState& fixed_hulls,
                      bool within_limits = true,
                      double look = std::numeric_limits<double>::infinity()) const;

  /// Whether an obstacle is in a hull that no joint moves.
  bool base_collides(const Options& options) const {
    return fixed.distance < -options.clearance_tolerance;
  }

  ObstacleSet near;  ///< within reach of a moving hull: the solver's
  ObstacleSet far;   ///< out of reach of all of them: only the reported clearance sees these
  double far_bound =
      std::numeric_limits<double>::infinity();  ///< no far one comes closer than this
  double fixed_far_bound =
      std::numeric_limits<double>::infinity();  ///< nor as close to a hull that no joint moves
  Clearance fixed;      ///< the deepest obstacle in a hull that no joint moves, if there is any
  double intake = 0.0;  ///< what taking the points in took [s]

 private:
  CollisionState fixed_hulls_;
  CellOrder order_;
};

}  // namespace pdoik::detail
