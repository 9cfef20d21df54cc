#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "obstacles/nearby_obstacles.hpp"
#include "problem/posture_pull.hpp"
#include "problem/problem.hpp"

namespace pdoik::detail {

/// The same problem as least squares over joint positions: what LevenbergMarquardt minimises.
///
///     f(q) = 1/2 sum over goals g (|dp|^2 + w^2 |e|^2) + 1/2 v^2 sum over constraints max(0, c)^2
///            + 1/2 sum over joints pull (q - q*)^2, and wishes as goals, where these count
/// with e the rotation vector to the target (or between the axes) and c in metres: of penetration,
/// of the centre of mass beyond its region. Where a solution exists f without the pull to a posture
/// q* is zero there and no multipliers are needed. Which obstacles count is for the caller to say:
/// all of the scene's near ones, those about one configuration, or none.
class LeastSquaresProblem {
 public:
  /// The problem outlives it.
  explicit LeastSquaresProblem(Problem& problem)
      : problem_(problem), options_(problem.model.options) {
    const Eigen::Index dof = problem.model.robot.dof();
    for (Eigen::VectorXd* each : {&cosine_, &sine_, &row_, &at_}) each->setZero(dof);
    columns_.resize(static_cast<std::size_t>(dof));
  }

  /// Room for copies of this many obstacles: called at set-up.
  void reserve(int padded_obstacles) { nearby_.reserve(padded_obstacles); }

  void count_all_obstacles() { counted_ = Counted::All; }
  void count_no_obstacles() { counted_ = Counted::None; }
  /// Not even the robot itself: no constraint but bounds.
  void count_goals_alone() { counted_ = Counted::Goals; }
  /// Count those that are within `margin` of a hull where f was last evaluated [m]. Points with a
  /// radius are then held off by half_sum_constraint, which errs to the safe side.
  void count_obstacles_within(double margin) {
    counted_ = Counted::All;
    if (!std::isfinite(margin)) return;
    hulls().place(problem_.rollout);
    if (!nearby_.gather(hulls(), problem_.scene->obstacles(), margin)) return;
    counted_ = Counted::Near;
  }
  /// How many pairs of links' pieces have been looked at.
  std::int64_t looks() const { return problem_.constraints.self.looks(); }
  int obstacle_count() const { return obstacles()->count(); }

  PosturePull posture;        ///< of the evaluations that follow
  double wishes_count = 0.0;  ///< in them: how much, of their weights; 0 for not at all

  /// Whether a hull touches one of the scene's shapes or near points or another hull, where f was
  /// last evaluated or the robot was last placed; or the clock has struck before that is known.
  bool touches() {
    hulls().place(problem_.rollout);
    if (problem_.constraints.self.any_touches()) return true;
    if (problem_.constraints.shapes.any_touches(problem_.scene->shapes(), options_.clearance,
                                                hulls()))
      return true;
    if (problem_.constraints.attachments.any_touches(problem_.rollout)) return true;
    const ObstacleView all = problem_.scene->obstacles();
    return hulls().any_near(
        all,
        [&](const NearPair& pair) {  // the point itself, whatever its radius
          const Hull& hull = hulls().hull(pair);
          const Vec4 o = all.of(hull.source, pair.obstacle);
          return !hull.has_capsules() && o[3] >= 0.0 &&
                 paper_constraint(hulls(), hull, o).c > 2.0 * o[3];
        },
        [&](const NearPair& pair) {
          const Hull& hull = hulls().hull(pair);
          const Vec4 o = all.of(hull.source, pair.obstacle);
          return hull.has_capsules() ? link_violation(hulls(), hull, o) > 0.0
                                     : distance_constraint(hulls(), hull, o).c > 0.0;
        });
  }

  /// Place the robot, and evaluate nothing.
  void place(const Eigen::VectorXd& q) {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double angle = q[i];  // read once, so that the two calls become one
      cosine_[i] = std::cos(angle);
      sine_[i] = std::sin(angle);
    }
    problem_.rollout.forward(cosine_.data(), sine_.data(), q.data());
  }

  double evaluate(const Eigen::VectorXd& q) {
    double sum = 2.0 * evaluate_goals(q);
    sum += options_.collision_weight * options_.collision_weight * violation();
    if (cut_) return std::numeric_limits<double>::infinity();
    return 0.5 * sum + posture.value(q) + (wishes_count > 0.0 ? wishes_count * wishes() : 0.0);
  }

  /// f without constraints and without the pull to a posture.
  double evaluate_goals(const Eigen::VectorXd& q) {
    place(q);
    at_ = q;
    double sum = 0.0;
    const double w2 = options_.rotation_weight * options_.rotation_weight;
    reached_ = true;
    for (GoalTerm& goal : problem_.goals) {
      double p2 = 0.0, r2 = 0.0;
      place(goal, p2, r2);
      sum += goal.weight() * (p2 + w2 * r2);
      reached_ = reached_ && goal.allows(p2, r2);
    }
    return 0.5 * sum;
  }

  /// Whether goals and constraints hold where f was last evaluated; a pull has no such end.
  bool done() const { return holds() && !posture.wanted() && wishes_count == 0.0; }
  bool holds() const { return reached() && !touching_ && !cut_; }
  /// Whether the goals are, where f was last evaluated.
  bool reached() const { return reached_; }

  /// Of the goals alone.
  void linearise_goals(Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    H.setZero();
    g.setZero();
    for (const GoalTerm& goal : problem_.goals) add_goal(goal, H, g);
  }

  void linearise(Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    linearise_goals(H, g);
    if (counted_ != Counted::Goals) linearise_constraints(H, g);
    posture.linearise(at_, H, g);
    if (wishes_count == 0.0) return;
    for (const GoalTerm& goal : problem_.wishes) add_goal(goal, H, g, wishes_count);
    // What is wished need not be had: errors stay, and with them how the chain bends.
    for (const GoalTerm& goal : problem_.goals) add_curvature(goal, H, 1.0);
    for (const GoalTerm& goal : problem_.wishes) add_curvature(goal, H, wishes_count);
  }

  /// How a tip moves and turns, in the base frame, with each joint; the fourth entries are zero.
  struct Column {
    Vec4 linear{}, angular{};
  };
  /// Of a goal's tip as its target sees it, where f was last evaluated: shape (n,).
  void find_columns(const GoalTerm& goal, std::vector<Column>& columns) const {
    for (Column& column : columns) column = Column{};
    const auto move_with = [&](int body, double way) {
      problem_.rollout.for_each_joint(
          body, [&](int dof, double multiplier, bool prismatic, const Frame& frame) {
            const Vec4 scaled = broadcast(way * multiplier) * frame.z;
            Column& column = columns[static_cast<std::size_t>(dof)];
            if (prismatic) {
              column.linear += scaled;
              return;
            }
            column.linear += cross3(scaled, goal.tip().p - frame.p);
            if (goal.turns()) column.angular += scaled;
          });
    };
    move_with(goal.body(), 1.0);
    if (goal.is_relative()) move_with(goal.reference(), -1.0);
  }

  /// What the wishes cost where f was last evaluated or the robot was last placed.
  double wishes() {
    double sum = 0.0;
    const double w2 = options_.rotation_weight * options_.rotation_weight;
    for (GoalTerm& goal : problem_.wishes) {
      double p2 = 0.0, r2 = 0.0;
      place(goal, p2, r2);
      sum += goal.weight() * (p2 + w2 * r2);
    }
    return 0.5 * sum;
  }

 private:
  static double sum4(const Vec4& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

  /// Aim this far beyond contact, so that reaching it to rounding is clear of it [m].
  static constexpr double kContactGap = 1e-8;

  /// Take a goal to where the robot is; its squared errors there.
  void place(GoalTerm& goal, double& p2, double& r2) const {
    goal.place(problem_.rollout);
    const Vec4 p = goal.position_error();
    const Vec4& e = goal.keep_rotation_error();
    p2 = dot3(p, p);
    r2 = dot3(e, e);
  }

  CollisionState& hulls() { return problem_.constraints.hulls; }

  enum class Counted { All, Near, None, Goals };
  ObstacleView obstacles() const {
    if (counted_ == Counted::All) return problem_.scene->obstacles();
    return counted_ == Counted::Near ? nearby_.view() : ObstacleView(none_);
  }

  /// The sum of squares of what is violated.
  double violation() {
    touching_ = cut_ = false;
    if (counted_ == Counted::Goals) return 0.0;
    problem_.constraints.obstacles.use(obstacles(), counted_ == Counted::Near
                                                        ? ObstacleConstraints::Form::HalfSum
                                                        : ObstacleConstraints::Form::Distance);
    if (counted_ == Counted::None)
      problem_.constraints.shapes.use_none();
    else
      problem_.constraints.shapes.use(problem_.scene->shapes(), options_.clearance);
    problem_.constraints.attachments.use(counted_ != Counted::None);
    problem_.constraints.find(problem_.rollout, [](std::size_t, int) { return kContactGap; });
    double sum = 0.0, worst = 0.0;
    bool cut = problem_.constraints.was_cut();
    problem_.constraints.for_each([&](const auto& family, std::size_t) {
      for (int k = 0; k < family.count() && !cut; ++k) {
        cut = problem_.is_late(k);
        const double c = family.at(k).c, over = c + kContactGap;
        if (over <= 0.0) continue;
        sum += over * over;
        worst = std::max(worst, c);
      }
    });
    touching_ = worst > 0.0;
    cut_ = cut;
    return sum;
  }

  void linearise_constraints(Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    const double v2 = options_.collision_weight * options_.collision_weight;
    problem_.constraints.for_each([&](auto& family, std::size_t) {
      for (int k = 0; k < family.count() && !problem_.is_late(k); ++k) {
        const auto& at = family.at(k);
        if (at.c <= -kContactGap) continue;
        row_.setZero();
        family.add_row(at, problem_.rollout, row_.data());
        g += v2 * (at.c + kContactGap) * row_;
        add_outer(v2, H);
      }
    });
  }

  void add_goal(const GoalTerm& goal, Eigen::MatrixXd& H, Eigen::VectorXd& g, double share = 1.0) {
    find_columns(goal, columns_);
    const Vec4 w = broadcast(options_.rotation_weight);
    for (Column& column : columns_) {
      goal.to_error_rates(column.linear, column.angular);
      column.angular *= w;
    }
    Vec4 p = goal.position_error(), e = w * goal.kept_rotation_error();
    const double weight = share * goal.weight();
    if (weight != 1.0) {
      const Vec4 root = broadcast(std::sqrt(weight));
      p *= root;
      e *= root;
      for (Column& column : columns_) {
        column.linear *= root;
        column.angular *= root;
      }
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Column& column = columns_[i];
      g[row] += sum4(column.linear * p + column.angular * e);
      double* const h = H.data() + row * H.rows();  // column i, filled down to the diagonal
      for (std::size_t k = 0; k <= i; ++k) {
        h[k] += sum4(column.linear * columns_[k].linear + column.angular * columns_[k].angular);
      }
    }
  }

  /// The errors times the second derivatives of the tip by pairs of joints: with them Gauss and
  /// Newton's matrix is Newton's, next to. Of a target that moves its own are left out.
  void add_curvature(const GoalTerm& goal, Eigen::MatrixXd& H, double share) {
    const Vec4 p = broadcast(share * goal.weight()) * goal.position_error();
    const double w2 = options_.rotation_weight * options_.rotation_weight;
    // Of one axis it is another, and less of it.
    const double turn = goal.by_axis() ? 0.0 : 0.5 * share * goal.weight() * w2;
    const Vec4 e = broadcast(turn) * goal.kept_rotation_error();
    const Rollout& rollout = problem_.rollout;
    for (int body = goal.body(); body > 0; body = rollout.joint(body).parent) {
      const RolloutJoint& joint = rollout.joint(body);
      const Frame& frame = rollout.frame(body);
      const Vec4 axis = broadcast(joint.multiplier) * frame.z;
      const Column after = joint.prismatic ? Column{axis, Vec4{}}
                                           : Column{cross3(axis, goal.tip().p - frame.p), axis};
      rollout.for_each_joint(body, [&](int before, double times, bool prismatic, const Frame& at) {
        if (prismatic) return;
        const Vec4 z = broadcast(times) * at.z;
        const double bend = dot3(p, cross3(z, after.linear)) + dot3(e, cross3(z, after.angular));
        H(std::min(before, joint.dof), std::max(before, joint.dof)) +=
            before == joint.dof && &at != &frame ? 2.0 * bend : bend;
      });
    }
  }

  void add_outer(double weight, Eigen::MatrixXd& H) const {
    for (Eigen::Index i = 0; i < row_.size(); ++i) {
      const double scaled = weight * row_[i];
      for (Eigen::Index j = 0; j <= i; ++j) H(j, i) += scaled * row_[j];
    }
  }

  Problem& problem_;
  const Options& options_;
  Counted counted_ = Counted::All;
  bool cut_ = false;
  ObstacleSet none_;
  NearbyObstacles nearby_;
  Eigen::VectorXd cosine_, sine_, row_, at_;
  std::vector<Column> columns_;
  bool reached_ = false;
  bool touching_ = false;
};

}  // namespace pdoik::detail
