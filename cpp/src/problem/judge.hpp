#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "hulls/self_collision.hpp"
#include "obstacles/attachment_clearance.hpp"
#include "obstacles/collision_state.hpp"
#include "obstacles/scene.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"
#include "problem/balance.hpp"

namespace pdoik::detail {

/// Says whether a configuration is a solution, from q alone: by Robot's forward kinematics, not by
/// the rollout the solvers run on.
class Judge {
 public:
  Judge(const Robot& robot, const Options& options, const HullModel& hulls, const HullModel& whole);

  /// What may touch obstacles at the target. Outlives it.
  void allow(const AllowedContact* contact) {
    collision_.allow(contact);
    capsules_.allow(contact);
  }
  /// What is attached to the robot in a scene, which outlives it: asked again whenever that
  /// changes.
  void attach(const Scene& scene);
  /// How far links are to keep off one another in a scene: asked again whenever that changes.
  void keep_off_itself(const Scene& scene);

  /// Fills q, errors, clearance and room, limit violation, worst constraint and success.
  /// Allocates nothing when result.q has its size.
  /// @param look  Clearance beyond this, and room beyond as much, is reported as this, or as what
  /// is wanted if that is more: to find how far the far is takes time [m].
  void operator()(std::span<const Goal> goals, const Eigen::VectorXd& q, const Scene& scene,
                  Result& result, double look = std::numeric_limits<double>::infinity());

 private:
  /// Keeps the worst of what is added.
  class Verdict;
  void judge_goal(const Goal& goal, Verdict& verdict, Result& result) const;
  void judge_limits(const Eigen::VectorXd& q, Result& result) const;
  void judge_balance(Verdict& verdict, Result& result);
  /// Distances by some pairs, as if each had to keep as far off as the options say.
  struct Least {
    double obstacles = std::numeric_limits<double>::infinity();
    double self = std::numeric_limits<double>::infinity();
  };
  /// What is asked of some pairs again and again.
  struct Asked {
    /// What of the hulls that no joint moves is nearest to the points of that stamp, if anything is
    /// nearer than was looked.
    Clearance fixed;
    std::uint64_t fixed_stamp = 0;
    double fixed_look = 0.0;
    std::optional<SelfCollision> self;
    std::optional<AttachmentClearance> attachments;
  };
  /// @param verdict  Gets the least; null for nobody.
  void judge_points(const Scene& scene, const Pairs& pairs, double look, Asked& asked,
                    Verdict* verdict, Least& least);
  void judge_shapes(const Pairs& pairs, double look, Verdict* verdict, Least& least);
  void judge_hulls(Asked& asked, Verdict* verdict, Least& least);
  void judge_attached(const Scene& scene, const Pairs& pairs, double look, Asked& asked,
                      Verdict* verdict, Least& least);

  const Robot& robot_;
  const Options& options_;
  const HullModel &hulls_, &whole_;
  std::vector<Eigen::Isometry3d> T_base_body_;
  CollisionState collision_, fixed_hulls_;
  HullCapsules capsules_;
  Balance balance_;
  Asked by_pairs_, plain_;  ///< plain where some pair has a clearance of its own
};

}  // namespace pdoik::detail
