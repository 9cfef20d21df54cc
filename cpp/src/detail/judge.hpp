#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "detail/balance.hpp"
#include "detail/collision_state.hpp"
#include "detail/forgiven.hpp"
#include "detail/held_clearance.hpp"
#include "detail/scene.hpp"
#include "detail/self_collision.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// Says whether a configuration is a solution, from q alone: by Robot's forward kinematics, not by
/// the rollout the solvers run on.
class Judge {
 public:
  Judge(const Robot& robot, const Options& options, const HullModel& hulls, const HullModel& whole);

  /// What may touch obstacles at the target. Outlives it.
  void let_touch(const Touching* touching) {
    collision_.let_touch(touching);
    capsules_.let_touch(touching);
    if (forgiven_) forgiven_->let_touch(touching);
  }
  /// What the robot holds in a scene, which outlives it: asked again whenever that changes.
  void hold(const Scene& scene);

  /// Fills q, errors, clearance, limit violation, worst constraint, what was forgiven and success.
  /// Allocates nothing when result.q has its size.
  /// @param look  Clearance beyond this is told as this, or as what is wanted if that is more: to
  /// find how far the far is takes time [m].
  void operator()(std::span<const Goal> goals, const Eigen::VectorXd& q, const Scene& scene,
                  Result& result, double look = std::numeric_limits<double>::infinity());

 private:
  /// Keeps the worst of what it is told of.
  class Verdict;
  void judge_goal(const Goal& goal, Verdict& verdict, Result& result) const;
  void judge_limits(const Eigen::VectorXd& q, Result& result) const;
  void judge_balance(Verdict& verdict, Result& result);
  void judge_hulls(Verdict& verdict, Result& result);
  void judge_points(const Scene& scene, double look, Verdict& verdict, Result& result);
  void judge_shapes(const Scene& scene, double look, Verdict& verdict, Result& result);
  void judge_held(const Scene& scene, double look, Verdict& verdict, Result& result);

  const Robot& robot_;
  const Options& options_;
  const HullModel& hulls_;
  std::vector<Eigen::Isometry3d> T_base_body_;
  CollisionState collision_, fixed_hulls_;
  /// What of the hulls that no joint moves is nearest to the points of that stamp, if anything is
  /// nearer than was looked.
  Clearance fixed_;
  std::uint64_t fixed_stamp_ = 0;
  double fixed_look_ = 0.0;
  HullCapsules capsules_;
  Balance balance_;
  std::optional<SelfCollision> self_;
  std::optional<HeldClearance> held_;
  std::optional<ForgivenContact> forgiven_;  ///< where any contact is
};

}  // namespace pdoik::detail
