#pragma once

#include <tuple>
#include <utility>

#include "problem/attachment_constraints.hpp"
#include "problem/balance_constraints.hpp"
#include "problem/obstacle_constraints.hpp"
#include "problem/self_constraints.hpp"
#include "problem/shape_constraints.hpp"

namespace pdoik::detail {

/// All constraints on a robot but its joints' limits, which both forms of the problem keep by their
/// variables: slack that is squashed, and joint positions within bounds.
class Constraints {
 public:
  explicit Constraints(const Model& model)
      : hulls(model.hulls, model.hulls.moving),
        obstacles(hulls),
        self(model, hulls),
        balance(model),
        shapes(model.robot, model.hulls, model.options.clearance),
        attachments(model, hulls) {}
  Constraints(const Constraints&) = delete;

  auto families() { return std::tie(obstacles, self, balance, shapes, attachments); }
  static constexpr std::size_t kFamilies = 5;

  /// Whether a family, by its number, has a group for each moving hull.
  static constexpr bool is_by_hull(std::size_t family) { return family == 0 || family == 3; }

  /// visit(family, its number).
  template <class Visit>
  void for_each(Visit&& visit) {
    std::size_t number = 0;
    std::apply([&](ConstraintFamily auto&... family) { (visit(family, number++), ...); },
               families());
  }

  /// Find those that act where a rollout is: c > -reach(family's number, group).
  template <class Reach>
  void find(const Rollout& rollout, Reach&& reach) {
    if (obstacles.wants_points() || self.wants_points() || shapes.wants_points() ||
        attachments.wants_points())
      hulls.place(rollout);
    if (shapes.wants_points()) shapes.place(hulls);
    for_each([&](auto& family, std::size_t number) {
      family.find(rollout, [&](int group) { return reach(number, group); });
    });
  }

  /// The clock that loops over shapes look at; null for none.
  void watch(const Deadline* deadline) {
    shapes.watch(deadline);
    attachments.watch(deadline);
  }
  /// Whether it struck before the last `find` had looked at all.
  bool was_cut() const { return shapes.was_cut() || attachments.was_cut(); }

  CollisionState hulls;
  ObstacleConstraints obstacles;
  SelfConstraints self;
  BalanceConstraints balance;
  ShapeConstraints shapes;
  AttachmentConstraints attachments;
};

}  // namespace pdoik::detail
