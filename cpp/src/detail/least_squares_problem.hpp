#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "detail/collision.hpp"
#include "detail/constraint.hpp"
#include "detail/deadline.hpp"
#include "detail/goal_term.hpp"
#include "detail/own_constraints.hpp"
#include "detail/rollout.hpp"
#include "detail/scene.hpp"

namespace pdoik::detail {

/// The same problem as least squares over joint positions: what LevenbergMarquardt minimises.
///
///     f(q) = 1/2 sum over goals g (|dp|^2 + w^2 |e|^2) + 1/2 v^2 sum over constraints max(0, c)^2
///            + 1/2 sum over joints pull (q - q*)^2
/// with e the rotation vector to the target (or between the axes) and c in metres: of penetration,
/// of the centre of mass beyond its region. Where a solution exists f without the pull to a posture
/// q* is zero there and no multipliers are needed. Which obstacles count is for the caller to say:
/// all of the scene's near ones, those about one configuration, or none.
class LeastSquaresProblem {
 public:
  LeastSquaresProblem(Rollout& rollout, std::vector<GoalTerm>& goals, CollisionState& collision,
                      OwnConstraints& own, const Scene& scene, const Options& options, int dof)
      : rollout_(rollout),
        goals_(goals),
        collision_(collision),
        own_(own),
        scene_(&scene),
        options_(options) {
    cosine_.setZero(dof);
    sine_.setZero(dof);
    row_.setZero(dof);
    at_.setZero(dof);
    columns_.resize(static_cast<std::size_t>(dof));
  }

  /// Room for copies of this many obstacles: called at set-up.
  void reserve(int padded_obstacles) {
    const auto count = static_cast<std::size_t>(padded_obstacles);
    about_.reserve(std::min(count, kMostAbout));
    const std::size_t words = count / 64 + 1;
    if (is_about_.size() < words) is_about_.resize(words);
  }
  /// The scene of the evaluations that follow; it outlives them. All of it counts.
  void use(const Scene& scene) {
    scene_ = &scene;
    heed_all();
  }
  /// Evaluations look at this now and then from now on, and are cut short once it has struck: f is
  /// then infinite. It outlives them; null for none.
  void watch(const Deadline* deadline) { deadline_ = deadline; }

  void heed_all() { heeded_ = Heeded::All; }
  void heed_none() { heeded_ = Heeded::None; }
  /// Heed those that are within `margin` of a hull where f was last evaluated [m]. If not `exact`,
  /// points with a radius are then held off by half_sum_constraint, which errs to the safe side.
  void heed_those_about(double margin, bool exact = false) {
    exact_ = exact;
    heeded_ = Heeded::All;
    const ObstacleView all = scene_->obstacles();
    if (!std::isfinite(margin)) return;
    const std::size_t words = static_cast<std::size_t>(all->places()) / 64 + 1;
    std::fill_n(is_about_.begin(), words, 0U);
    collision_.place(rollout_);
    std::size_t count = 0;
    const auto note = [&](const NearPair* begin, const NearPair* end) {
      for (const NearPair* pair = begin; pair != end; ++pair) {
        const auto j = static_cast<std::size_t>(pair->obstacle);
        const std::uint64_t bit = std::uint64_t{1} << (j % 64);
        if ((is_about_[j / 64] & bit) == 0) ++count;
        is_about_[j / 64] |= bit;
      }
      return count <= kMostAbout;
    };
    if (!collision_.visit_near(all, [margin](std::size_t) { return margin; }, note)) return;
    about_.begin(static_cast<int>(count), to_vector3(all->origin()));
    for (std::size_t w = 0; w < words; ++w) {
      for (std::uint64_t bits = is_about_[w]; bits != 0; bits &= bits - 1) {
        const int j = static_cast<int>(64 * w) + __builtin_ctzll(bits);
        about_.add(all[j], all->id(j));
      }
    }
    about_.finish(all->in_order());
    heeded_ = Heeded::About;
  }
  int heeded() const { return obstacles()->count(); }

  /// Pull each joint towards a position, with a weight each [m^2/rad^2]: both shape (n,), kept by
  /// the caller. Null ends it.
  void pull_towards(const Eigen::VectorXd* positions, const Eigen::VectorXd* weights) {
    pull_to_ = positions;
    pull_ = weights;
  }

  /// Whether there is anything that hulls could touch.
  bool can_touch() const { return scene_->within_reach() > 0 || own_.any_self(); }
  /// Whether a hull touches one of the scene's near obstacles or another hull, where f was last
  /// evaluated or the robot was last placed.
  bool touches() {
    collision_.place(rollout_);
    if (own_.any_self() && own_.is_violated(rollout_, collision_)) return true;
    const ObstacleView all = scene_->obstacles();
    return collision_.any_near(
        all,
        [&](const NearPair& pair) {  // the point itself, whatever its radius
          const Vec4 o = all[pair.obstacle];
          return o[3] >= 0.0 &&
                 paper_constraint(collision_, collision_.hull(pair), o).c > 2.0 * o[3];
        },
        [&](const NearPair& pair) {
          return distance_constraint(collision_, collision_.hull(pair), all[pair.obstacle]).c > 0.0;
        });
  }

  /// Weigh all goals by this much more or less from now on.
  void scale_goals(double scale) { goal_scale_ = scale; }

  /// Place the robot, and evaluate nothing.
  void place(const Eigen::VectorXd& q) {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double angle = q[i];  // read once, so that the two calls become one
      cosine_[i] = std::cos(angle);
      sine_[i] = std::sin(angle);
    }
    rollout_.forward(cosine_.data(), sine_.data(), q.data());
  }

  double evaluate(const Eigen::VectorXd& q) {
    place(q);
    double sum = 0.0;
    const double w2 = options_.rotation_weight * options_.rotation_weight;
    position_error_ = rotation_error_ = 0.0;
    cut_ = false;
    for (GoalTerm& goal : goals_) {
      goal.place(rollout_.frame(goal.body()));
      const Vec4 p = goal.position_error();
      const double p2 = dot3(p, p);
      const Vec4& e = goal.keep_rotation_error();
      const double r2 = dot3(e, e);
      sum += goal_scale_ * goal.weight() * (p2 + w2 * r2);
      position_error_ = std::max(position_error_, p2);
      rotation_error_ = std::max(rotation_error_, r2);
    }
    sum += penetration();
    if (first_holds_ == First::Wanted) first_holds_ = holds() ? First::Holds : First::Fails;
    if (cut_) return std::numeric_limits<double>::infinity();
    if (pull_to_ != nullptr) {
      at_ = q;
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        const double off = q[i] - (*pull_to_)[i];
        sum += (*pull_)[i] * off * off;
      }
    }
    return 0.5 * sum;
  }

  /// Whether goals and constraints hold where f was last evaluated; a pull has no such end.
  bool done() const { return holds() && pull_to_ == nullptr; }
  bool holds() const { return reached() && !touching_ && !cut_; }
  /// Whether any constraint is violated there.
  bool touching() const { return touching_; }
  /// From now on remember whether they hold where f is evaluated next.
  void remember_next() { first_holds_ = First::Wanted; }
  bool remembered_holds() const { return first_holds_ == First::Holds; }
  /// The weightiest goal's error there, radians weighed [m].
  double goal_pull() const {
    double largest = 0.0;
    for (const GoalTerm& goal : goals_) {
      const double turned = options_.rotation_weight * goal.rotation_distance();
      largest = std::max(largest, goal.weight() * (goal.position_distance() + turned));
    }
    return largest;
  }
  /// Whether the goals are, where f was last evaluated.
  bool reached() const {
    const double p = options_.position_tolerance, r = options_.rotation_tolerance;
    return position_error_ < p * p && rotation_error_ < r * r;
  }

  void linearise(Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    H.setZero();
    g.setZero();
    for (const GoalTerm& goal : goals_) add_goal(goal, H, g);
    const double v2 = options_.collision_weight * options_.collision_weight;
    for (int k = 0; k < collision_.near_count(); ++k) {
      if (is_cut(k)) return;  // whoever linearises asks the clock next
      const Constraint at = constraint(collision_.near(k));
      if (at.c <= -kContactGap) continue;
      constraint_row(collision_.near(k), at);
      g += v2 * (at.c + kContactGap) * row_;
      add_outer(v2, H);
    }
    for (const OwnConstraints::Active& active : own_.active()) {
      row_.setZero();
      own_.add_row(active, rollout_, collision_, row_.data());
      g += v2 * (active.c + kContactGap) * row_;
      add_outer(v2, H);
    }
    if (pull_to_ == nullptr) return;
    for (Eigen::Index i = 0; i < g.size(); ++i) {
      g[i] += (*pull_)[i] * (at_[i] - (*pull_to_)[i]);
      H(i, i) += (*pull_)[i];
    }
  }

 private:
  static double sum4(const Vec4& v) { return (v[0] + v[2]) + (v[1] + v[3]); }

  /// Copies of more obstacles than this save nothing.
  static constexpr std::size_t kMostAbout = 16384;

  /// Aim this far beyond contact, so that reaching it to rounding is clear of it [m].
  static constexpr double kContactGap = 1e-8;

  enum class Heeded { All, About, None };
  ObstacleView obstacles() const {
    if (heeded_ == Heeded::All) return scene_->obstacles();
    return heeded_ == Heeded::About ? about_ : none_;
  }

  Constraint constraint(const NearPair& pair) const {
    const Vec4 o = obstacles()[pair.obstacle];
    if (heeded_ == Heeded::About && !exact_ && o[3] >= 0.0)
      return half_sum_constraint(collision_, collision_.hull(pair), o);
    return distance_constraint(collision_, collision_.hull(pair), o);
  }

  /// Asked for each near pair.
  bool is_cut(int pair) {
    if (passed_in(pair, deadline_)) cut_ = true;
    return cut_;
  }

  double penetration() {
    touching_ = false;
    if (heeded() > 0 || own_.any_self()) collision_.place(rollout_);
    collision_.find_near(obstacles(), [](std::size_t) { return kContactGap; });
    double sum = 0.0;
    for (int k = 0; k < collision_.near_count(); ++k) {
      if (is_cut(k)) return sum;
      const double c = constraint(collision_.near(k)).c;
      if (c <= -kContactGap) continue;
      sum += (c + kContactGap) * (c + kContactGap);
      touching_ = touching_ || c > 0.0;
    }
    if (own_.any()) {
      own_.find(rollout_, collision_, [](int) { return kContactGap; });
      for (const OwnConstraints::Active& active : own_.active()) {
        sum += (active.c + kContactGap) * (active.c + kContactGap);
        touching_ = touching_ || active.c > 0.0;
      }
    }
    return options_.collision_weight * options_.collision_weight * sum;
  }

  void add_goal(const GoalTerm& goal, Eigen::MatrixXd& H, Eigen::VectorXd& g) {
    for (Column& column : columns_) column = Column{};
    const Vec4 w = broadcast(options_.rotation_weight);
    const Vec4 axis = goal.type() == GoalType::Axis ? goal.axis() : Vec4{};
    const bool turns = goal.type() != GoalType::Position;
    rollout_.for_each_joint(goal.body(),
                            [&](int dof, double multiplier, bool prismatic, const Frame& frame) {
                              const Vec4 scaled = broadcast(multiplier) * frame.z;
                              Column& column = columns_[static_cast<std::size_t>(dof)];
                              if (prismatic) {
                                column.linear += scaled;
                                return;
                              }
                              column.linear += cross3(scaled, goal.tip().p - frame.p);
                              if (!turns) return;
                              // Turning about the constrained axis itself changes nothing.
                              column.angular += w * (scaled - broadcast(dot3(axis, scaled)) * axis);
                            });
    if (goal.has_slack()) {
      for (Column& column : columns_) {
        column.linear = goal.position_error_rate(column.linear);
        if (goal.type() == GoalType::Pose)
          column.angular = goal.rotation_error_rate(column.angular);
      }
    }
    Vec4 p = goal.position_error(), e = w * goal.kept_rotation_error();
    const double weight = goal_scale_ * goal.weight();
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
  OwnConstraints& own_;
  const Scene* scene_;
  const Options& options_;
  const Deadline* deadline_ = nullptr;
  Heeded heeded_ = Heeded::All;
  bool exact_ = false, cut_ = false;
  enum class First { Unwanted, Wanted, Holds, Fails };
  First first_holds_ = First::Unwanted;
  double goal_scale_ = 1.0;
  const Eigen::VectorXd *pull_to_ = nullptr, *pull_ = nullptr;
  ObstacleSet about_, none_;
  std::vector<std::uint64_t> is_about_;  ///< a bit for each of the scene's near obstacles
  Eigen::VectorXd cosine_, sine_, row_, at_;
  /// How the tip's position and orientation (weighted) follow one joint; the fourth entries are
  /// zero.
  struct Column {
    Vec4 linear{}, angular{};
  };
  std::vector<Column> columns_;
  double position_error_ = 0.0, rotation_error_ = 0.0;  // squared
  bool touching_ = false;
};

}  // namespace pdoik::detail
