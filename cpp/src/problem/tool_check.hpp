#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "hulls/hull_capsules.hpp"
#include "obstacles/attachment_clearance.hpp"
#include "obstacles/collision_state.hpp"
#include "obstacles/scene.hpp"
#include "pdoik/result.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// Looks at what is rigid to a tip, which a pose goal alone puts where it is: if that touches an
/// obstacle no configuration will do. One thread's. Allocates at construction only.
class ToolCheck {
 public:
  /// The model outlives it.
  explicit ToolCheck(const Model& model);

  /// What may touch obstacles at the target. Outlives it.
  void allow(const AllowedContact* contact) {
    for (const auto& tool : tools_) {
      tool->state->allow(contact);
      tool->capsules->allow(contact);
    }
  }
  /// What is attached to the robot in a scene, which outlives it: asked again whenever that
  /// changes.
  void attach(const Scene& scene);

  /// The deepest contact that goals without slack make certain, beyond what their tolerances could
  /// avoid; none if there is none.
  std::optional<WorstConstraint> contact(std::span<const Goal> goals, const Scene& scene);

 private:
  struct Tool {
    int body;
    double arm = 0.0;        ///< of all its hulls, from the tip's origin [m]
    double from_body = 0.0;  ///< of the tip's origin, from the body's [m]
    std::vector<Hull> hulls;
    std::vector<std::pair<int, Eigen::Vector3d>> points;  ///< attached ones, in the body's frame
    std::unique_ptr<CollisionState> state;
    std::unique_ptr<HullCapsules> capsules;
  };
  std::optional<WorstConstraint> contact(Tool& tool, const Goal& goal, const Scene& scene);

  const Model& model_;
  std::vector<std::unique_ptr<Tool>> tools_;  ///< of each tip
  std::optional<AttachmentClearance> attachments_;
};

}  // namespace pdoik::detail
