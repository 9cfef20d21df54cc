#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "detail/collision.hpp"
#include "detail/constraint.hpp"
#include "detail/goal_term.hpp"
#include "detail/rollout.hpp"

namespace pdoik::detail {

/// The same problem as least squares over joint positions: what LevenbergMarquardt minimises.
///
///     f(q) = 1/2 sum over goals (|dp|^2 + w^2 |e|^2) + 1/2 v^2 sum over constraints max(0, c)^2
/// with e the rotation vector to the target (or between the axes) and c in metres of penetration.
/// Where a solution exists f is zero there and no multipliers are needed.
class LeastSquaresProblem {
 public:
  LeastSquaresProblem(Rollout& rollout, std::vector<GoalTerm>& goals, CollisionState& collision,
                      const Scene& scene, const Options& options, int dof)
      : rollout_(rollout), goals_(goals), collision_(collision), scene_(scene), options_(options) {
    cosine_.setZero(dof);
    sine_.setZero(dof);
    row_.setZero(dof);
    linear_.setZero(3, dof);
    angular_.setZero(3, dof);
  }

  double evaluate(const Eigen::VectorXd& q) {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      cosine_[i] = std::cos(q[i]);
      sine_[i] = std::sin(q[i]);
    }
    rollout_.forward(cosine_.data(), sine_.data(), q.data());
    double sum = 0.0;
    const double w2 = options_.rotation_weight * options_.rotation_weight;
    position_error_ = rotation_error_ = 0.0;
    for (GoalTerm& goal : goals_) {
      goal.place(rollout_.frame(goal.body()));
      const double p2 = dot3(goal.position_error(), goal.position_error());
      const double r2 = dot3(goal.rotation_error(), goal.rotation_error());
      sum += p2 + w2 * r2;
      position_error_ = std::max(position_error_, p2);
      rotation_error_ = std::max(rotation_error_, r2);
    }
    return 0.5 * (sum + penetration());
  }

  bool done() const {
    const double p = options_.position_tolerance, r = options_.rotation_tolerance;
    return position_error_ < p * p && rotation_error_ < r * r && !touching_;
  }

  void linearise(Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    H.setZero();
    g.setZero();
    for (const GoalTerm& goal : goals_) add_goal(goal, H, g);
    const double v2 = options_.collision_weight * options_.collision_weight;
    for (int k = 0; k < collision_.near_count(); ++k) {
      const Constraint at = constraint(collision_.near(k));
      if (at.c <= -kContactGap) continue;
      constraint_row(collision_.near(k), at);
      g += v2 * (at.c + kContactGap) * row_;
      add_outer(v2, H);
    }
  }

 private:
  /// Aim this far beyond contact, so that reaching it to rounding is clear of it [m].
  static constexpr double kContactGap = 1e-8;

  Constraint constraint(const NearPair& pair) const {
    return distance_constraint(collision_, collision_.hull(pair), scene_.near[pair.obstacle]);
  }

  double penetration() {
    touching_ = false;
    if (scene_.near.count() == 0) return 0.0;
    collision_.place(rollout_);
    collision_.find_near(scene_.near, [](std::size_t) { return kContactGap; });
    double sum = 0.0;
    for (int k = 0; k < collision_.near_count(); ++k) {
      const double c = constraint(collision_.near(k)).c;
      if (c <= -kContactGap) continue;
      sum += (c + kContactGap) * (c + kContactGap);
      touching_ = touching_ || c > 0.0;
    }
    return options_.collision_weight * options_.collision_weight * sum;
  }

  void add_goal(const GoalTerm& goal, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const double w2 = options_.rotation_weight * options_.rotation_weight;
    linear_.setZero();
    angular_.setZero();
    const Vec4 axis = goal.type() == GoalType::Axis ? goal.axis() : Vec4{};
    rollout_.for_each_joint(
        goal.body(), [&](int dof, double multiplier, bool prismatic, const Frame& frame) {
          const Vec4 scaled = broadcast(multiplier) * frame.z;
          if (prismatic) {
            linear_.col(dof) += to_vector3(scaled);
            return;
          }
          linear_.col(dof) += to_vector3(cross3(scaled, goal.tip().p - frame.p));
          if (goal.type() == GoalType::Position) return;
          // Turning about the constrained axis itself changes nothing.
          angular_.col(dof) += to_vector3(scaled - broadcast(dot3(axis, scaled)) * axis);
        });
    const Vec4 e = goal.rotation_error(), p = goal.position_error();
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      const double* li = linear_.data() + 3 * i;
      const double* ai = angular_.data() + 3 * i;
      g[i] += li[0] * p[0] + li[1] * p[1] + li[2] * p[2] +
              w2 * (ai[0] * e[0] + ai[1] * e[1] + ai[2] * e[2]);
      for (Eigen::Index j = 0; j <= i; ++j) {
        const double* lj = linear_.data() + 3 * j;
        const double* aj = angular_.data() + 3 * j;
        H(j, i) += li[0] * lj[0] + li[1] * lj[1] + li[2] * lj[2] +
                   w2 * (ai[0] * aj[0] + ai[1] * aj[1] + ai[2] * aj[2]);
      }
    }
  }

  void constraint_row(const NearPair& pair, const Constraint& at) {
    row_.setZero();
    const Hull& hull = collision_.hull(pair);
    const auto add = [&](int point, const Vec4& direction) {
      rollout_.add_row(collision_.body_of_point(point), direction,
                       cross3(collision_.position(point), direction), row_.data());
    };
    add(hull.a, at.dc_da);
    if (!hull.is_sphere()) add(hull.b, at.dc_db);
  }

  void add_outer(double weight, Eigen::MatrixXd& H) const {
    for (Eigen::Index i = 0; i < row_.size(); ++i) {
      const double scaled = weight * row_[i];
      for (Eigen::Index j = 0; j <= i; ++j) H(j, i) += scaled * row_[j];
    }
  }

  Rollout& rollout_;
  std::vector<GoalTerm>& goals_;
  CollisionState& collision_;
  const Scene& scene_;
  const Options& options_;
  Eigen::VectorXd cosine_, sine_, row_;
  Eigen::Matrix3Xd linear_, angular_;
  double position_error_ = 0.0, rotation_error_ = 0.0;  // squared
  bool touching_ = false;
};

}  // namespace pdoik::detail
