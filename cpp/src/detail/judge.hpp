#pragma once

#include <vector>

#include "detail/collision.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// Says whether a configuration is a solution, from q alone: by Robot's forward kinematics, not by
/// the rollout the solvers run on.
class Judge {
 public:
  Judge(const Robot& robot, const Options& options, const HullModel& hulls);

  /// Room for this many obstacles: called at set-up.
  void reserve(int padded_obstacles) {
    collision_.reserve(padded_obstacles);
    fixed_hulls_.reserve(padded_obstacles);
  }

  /// Fills q, errors, clearance, limit violation, worst constraint and success. Allocates nothing
  /// when result.q has its size.
  void operator()(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd& q, const Scene& scene,
                  Result& result);

 private:
  void pose_errors(const Eigen::Isometry3d& target, Result& result) const;
  void limits(const Eigen::VectorXd& q, Result& result, WorstConstraint& worst_limit) const;

  const Robot& robot_;
  const Options& options_;
  const HullModel& hulls_;
  std::vector<Eigen::Isometry3d> T_base_body_;
  CollisionState collision_, fixed_hulls_;
};

}  // namespace pdoik::detail
