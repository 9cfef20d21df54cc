#pragma once

#include <span>
#include <vector>

#include "common/deadline.hpp"
#include "kinematics/rollout.hpp"
#include "obstacles/scene.hpp"
#include "problem/constraints.hpp"
#include "problem/goal_term.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// A robot, its goals and its constraints: what both forms of the problem, LagrangianProblem and
/// LeastSquaresProblem, evaluate. One thread's.
struct Problem {
  /// Both outlive it.
  Problem(const Model& model_in, const Scene& scene_in)
      : model(model_in),
        allowed_contact(model.robot, model.options.touch),
        rollout(model.robot),
        constraints(model),
        scene(&scene_in) {
    constraints.hulls.allow(&allowed_contact);
    constraints.shapes.allow(&allowed_contact);
    goals.reserve(kMostGoals);
    wishes.reserve(2 * kMostGoals);
  }
  Problem(const Problem&) = delete;

  void set_goals(std::span<const Goal> asked) {
    allowed_contact.set_goals(asked);
    constraints.balance.ask(asked);
    goals.clear();
    wishes.clear();
    for (const Goal& goal : asked) {
      if (goal.type == GoalType::CenterOfMass) continue;
      if (goal.priority == Priority::Position) {
        (goal.soft ? wishes : goals)
            .emplace_back(model.robot, model.options, goal, GoalPart::Position);
        wishes.emplace_back(model.robot, model.options, goal, GoalPart::Rotation);
      } else {
        (goal.soft ? wishes : goals).emplace_back(model.robot, model.options, goal);
      }
    }
  }

  /// Whether there is anything that hulls could touch.
  bool can_touch() const {
    return scene->within_reach() > 0 || scene->shapes().count() > 0 ||
           scene->attachments().count() > 0 || constraints.self.wants_points();
  }
  /// Whether whoever evaluates should give up: asked for each constraint.
  bool is_late(int constraint) const { return passed_in(constraint, deadline); }

  const Model& model;
  AllowedContact allowed_contact;
  Rollout rollout;
  std::vector<GoalTerm> goals, wishes;  ///< what is hard, and what is soft
  Constraints constraints;
  const Scene* scene;
  /// Evaluations look at this now and then, and are cut short once it has struck: what they give is
  /// then of no use. Null for none.
  const Deadline* deadline = nullptr;
};

}  // namespace pdoik::detail
