#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "detail/collision_state.hpp"
#include "detail/held_clearance.hpp"
#include "detail/hull_capsules.hpp"
#include "detail/hull_model.hpp"
#include "detail/scene.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// What Options::forgive_overhang passes over: contact of the capsules that it counts as thinner,
/// at the size that they have. One thread's. Allocates at construction and in `hold` only.
class ForgivenContact {
 public:
  /// Both outlive it.
  ForgivenContact(const Robot& robot, const Options& options);
  ForgivenContact(const ForgivenContact&) = delete;

  /// What may touch obstacles at the target. Outlives it.
  void let_touch(const Touching* touching) {
    state_.let_touch(touching);
    capsules_.let_touch(touching);
  }
  /// What the robot holds in a scene, which outlives it: asked again whenever that changes.
  void hold(const Scene& scene);

  /// The deepest contact, or none, where the bodies are.
  WorstConstraint deepest(const std::vector<Eigen::Isometry3d>& T_base_body, const Scene& scene);

 private:
  const Robot& robot_;
  const Options& options_;
  HullModel whole_;
  std::vector<Hull> hulls_;  ///< all of them, in the order of the model's
  std::vector<int> placed_;  ///< places among them of those with capsules that count as thinner
  CollisionState state_;
  HullCapsules capsules_;
  std::optional<HeldClearance> held_;
};

}  // namespace pdoik::detail
