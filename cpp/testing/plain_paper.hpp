#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "plain_problem.hpp"

namespace pdoik::testing {

/// Algorithm IK on PlainProblem, with the same minimisers, options and stop rule as Method::Paper.
class PlainPaper {
 public:
  PlainPaper(const Robot& robot, const Options& options);

  void set_obstacles(const Obstacles& points) { problem_.set_obstacles(points); }
  /// Fills q, iterations, evaluations and time of the result; the rest is for Solver::judge.
  /// @param q0  May be null: then omega = 0.
  void solve(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd* q0, Result& result);

 private:
  Options options_;
  PlainProblem problem_;
  AugmentedLagrangian augmented_lagrangian_;
  Eigen::VectorXd omega_;
};

}  // namespace pdoik::testing
