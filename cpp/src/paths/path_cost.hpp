#pragma once

#include <Eigen/Core>
#include <vector>

#include "paths/path_stepper.hpp"

namespace pdoik::detail {

/// What a path is judged by: see PathCosts.
class PathCost {
 public:
  PathCost(const Model& model, const PathCosts& costs) : model_(model), costs_(costs) {}

  /// Of getting from one configuration to another.
  double of_motion(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
    return costs_.motion * (to - from).norm();
  }
  bool minds_places() const {
    return costs_.limits > 0.0 || costs_.obstacles > 0.0 || costs_.singularities > 0.0;
  }
  /// Of being at a point, for each way of a tool (see PathGoals::way).
  double of_place(PathStepper& stepper, const PathPoint& point) const;
  /// Of the motion through points at stations, and of being at each after the first.
  double of_all(PathStepper& stepper, const std::vector<PathPoint>& points) const;

 private:
  const Model& model_;
  PathCosts costs_;
};

}  // namespace pdoik::detail
