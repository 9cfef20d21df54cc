#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "obstacles/attachment_clearance.hpp"
#include "obstacles/scene.hpp"
#include "problem/constraint_family.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// What is attached to the robot off points, shapes and the robot: one group.
class AttachmentConstraints : public ByPointGradients {
 public:
  /// The model and the hulls outlive it.
  AttachmentConstraints(const Model& model, const CollisionState& hulls)
      : model_(model), hulls_(hulls) {}

  /// What is attached in a scene, which outlives it: asked again whenever that changes. Allocates.
  void attach(const Scene& scene) {
    scene_ = &scene;
    attachments_.reset();
    if (scene.attachments().count() > 0)
      attachments_.emplace(model_.robot, model_.hulls, model_.options, scene.attachments());
    near_.reserve(most());
  }
  /// The clock that is looked at while shapes are looked at; null for none.
  void watch(const Deadline* deadline) { deadline_ = deadline; }
  /// Whether it struck before `find` had looked at all.
  bool was_cut() const { return was_cut_; }
  void use(bool wanted) { wanted_ = wanted; }
  std::size_t most() const {
    return attachments_ ? static_cast<std::size_t>(attachments_->most(scene_->shapes().parts()))
                        : 0;
  }

  bool wants_points() const { return wanted_ && attachments_.has_value(); }
  int groups() const { return 1; }
  /// Whether anything touches where a rollout is and the hulls are, or the clock has struck.
  bool any_touches(const Rollout& rollout) {
    if (!attachments_) return false;
    find_within(rollout, 0.0);
    return was_cut_ || !near_.empty();
  }

  template <class Reach>
  void find(const Rollout& rollout, Reach&& reach) {
    near_.clear();
    was_cut_ = false;
    if (wants_points()) find_within(rollout, reach(0));
  }
  int count() const { return static_cast<int>(near_.size()); }
  ConstraintKey key(int k) const { return constraint_key(0, at(k).slot); }

  struct Near : AttachmentNear {
    double c;
  };
  const Near& at(int k) const { return near_[static_cast<std::size_t>(k)]; }

 private:
  void find_within(const Rollout& rollout, double within) {
    near_.clear();
    attachments_->place([&](int body) -> const Frame& { return rollout.frame(body); },
                        hulls_.positions(), hulls_.frames());
    was_cut_ = !attachments_->find(
        scene_->obstacles(), scene_->shapes(), within, deadline_,
        [&](const AttachmentNear& near) { near_.push_back({near, -near.distance}); });
    std::ranges::sort(near_, {}, &AttachmentNear::slot);  // by keys
  }

  const Model& model_;
  const CollisionState& hulls_;
  const Scene* scene_ = nullptr;
  std::optional<AttachmentClearance> attachments_;
  const Deadline* deadline_ = nullptr;
  bool wanted_ = false, was_cut_ = false;
  std::vector<Near> near_;
};

}  // namespace pdoik::detail
