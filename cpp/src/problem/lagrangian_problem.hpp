#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "problem/multipliers.hpp"
#include "problem/problem.hpp"

namespace pdoik::detail {

/// Eq. AL over the slack variables omega: what AugmentedLagrangian minimises (Algorithms FWD and
/// Jacobian).
class LagrangianProblem {
 public:
  /// Both outlive it.
  LagrangianProblem(const JointLimitMap& map, Problem& problem)
      : map_(map), problem_(problem), state_(map.make_state()) {
    dq_.setZero(problem.model.robot.dof());
    reserve(0);
  }

  /// Room for the multipliers among this many obstacles: called at set-up by who minimises.
  void reserve(int padded_obstacles) {
    problem_.constraints.for_each([&](const auto& family, std::size_t number) {
      const auto groups = static_cast<std::size_t>(family.groups());
      multipliers_[number].reserve(family.groups(), groups);
    });
    const ShapeConstraints& shapes = problem_.constraints.shapes;
    multipliers_[3].reserve(shapes.groups(), shapes.most());
    const AttachmentConstraints& attached = problem_.constraints.attachments;
    multipliers_[4].reserve(attached.groups(), attached.most());
    const ObstacleConstraints& obstacles = problem_.constraints.obstacles;
    const auto groups = static_cast<std::size_t>(obstacles.groups());
    multipliers_[0].reserve(
        obstacles.groups(),
        std::min(groups * static_cast<std::size_t>(padded_obstacles), CollisionState::kMostPairs));
  }

  double lagrangian(const Eigen::VectorXd& omega, const Penalty& penalty,
                    Eigen::VectorXd& gradient) {
    roll_out(omega);
    Rollout& rollout = problem_.rollout;
    rollout.clear_wrenches();
    double value = 0.0;
    for (const GoalTerm& goal : problem_.goals) {
      Vec4 force, moment;
      value += goal.point_objective(problem_.model.options.point_distance, force, moment);
      rollout.add_wrench(goal.body(), force, moment);
      if (goal.is_relative()) rollout.add_wrench(goal.reference(), -force, -moment);
    }
    max_constraint_ = 0.0;
    find(penalty);
    problem_.constraints.for_each([&](auto& family, std::size_t number) {
      Multipliers::Reader multiplier(multipliers_[number]);
      for (int k = 0; k < family.count() && !problem_.is_late(k); ++k) {
        const auto& at = family.at(k);
        max_constraint_ = std::max(max_constraint_, at.c);
        const Penalty::Term term = penalty.term(at.c, multiplier(family.key(k)));
        if (term.slope == 0.0) continue;
        value += term.value;
        family.add_wrenches(at, term.slope, rollout);
      }
    });
    rollout.reverse(dq_.data(), static_cast<int>(dq_.size()));
    map_.pull_back(state_, dq_, gradient);
    return value;
  }

  double max_constraint(const Eigen::VectorXd& omega) {
    roll_out(omega);
    use_obstacles();
    problem_.constraints.find(problem_.rollout, [](std::size_t, int) { return 0.0; });
    max_constraint_ = 0.0;
    problem_.constraints.for_each([&](const auto& family, std::size_t) {
      for (int k = 0; k < family.count(); ++k)
        max_constraint_ = std::max(max_constraint_, family.at(k).c);
    });
    return max_constraint_;
  }

  void reset_multipliers() {
    for (Multipliers& each : multipliers_) each.reset();
  }

  void update_multipliers(const Eigen::VectorXd& omega, const Penalty& penalty) {
    roll_out(omega);
    find(penalty);
    problem_.constraints.for_each([&](const auto& family, std::size_t number) {
      multipliers_[number].update(family, penalty);
    });
  }

  /// At the last evaluation: the largest constraint, at least 0.
  double last_max_constraint() const { return max_constraint_; }

 private:
  void roll_out(const Eigen::VectorXd& omega) {
    Rollout& rollout = problem_.rollout;
    map_.forward(omega, state_, rollout.needs_angles());
    rollout.forward(state_.cosine.data(), state_.sine.data(), state_.q.data());
    for (GoalTerm& goal : problem_.goals) goal.place(rollout);
  }

  void use_obstacles() {
    const Scene& scene = *problem_.scene;
    ObstacleConstraints& obstacles = problem_.constraints.obstacles;
    if (scene.within_reach() > 0)
      obstacles.use(scene.obstacles(), ObstacleConstraints::Form::Paper);
    else
      obstacles.use_none();
    problem_.constraints.shapes.use(scene.shapes(), problem_.model.options.clearance);
    problem_.constraints.attachments.use(true);
  }

  /// Find the constraints whose penalty acts: in the smooth form up to mu / rho before contact.
  void find(const Penalty& penalty) {
    use_obstacles();
    problem_.constraints.find(problem_.rollout, [&](std::size_t family, int group) {
      return penalty.reach(multipliers_[family].largest(group));
    });
  }

  const JointLimitMap& map_;
  Problem& problem_;
  JointLimitMap::State state_;
  Eigen::VectorXd dq_;
  std::array<Multipliers, Constraints::kFamilies> multipliers_;
  double max_constraint_ = 0.0;
};

}  // namespace pdoik::detail
