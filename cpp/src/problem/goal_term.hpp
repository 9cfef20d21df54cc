#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/frame.hpp"
#include "kinematics/goal_of.hpp"
#include "kinematics/rollout.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// The rotation vector e with R = exp(e) R_target, both given by their axes.
inline Vec4 rotation_error_vector(const Frame& R, const Frame& target) {
  const Vec4 twice_sine = cross3(target.x, R.x) + cross3(target.y, R.y) + cross3(target.z, R.z);
  const double twice_cosine = dot3(target.x, R.x) + dot3(target.y, R.y) + dot3(target.z, R.z) - 1.0;
  const double sine_norm = std::sqrt(dot3(twice_sine, twice_sine));
  if (sine_norm > 1e-12)
    return broadcast(std::atan2(sine_norm, twice_cosine) / sine_norm) * twice_sine;
  if (twice_cosine > 0.0) return broadcast(0.5) * twice_sine;
  // Half a turn: any target axis's mean with its image lies along the rotation's axis.
  Vec4 longest = R.x + target.x;
  for (const Vec4& sum : {R.y + target.y, R.z + target.z}) {
    if (dot3(sum, sum) > dot3(longest, longest)) longest = sum;
  }
  return broadcast(M_PI / std::sqrt(dot3(longest, longest))) * longest;
}

/// The rotation vector that takes direction `target` to direction `axis`, shortest way.
inline Vec4 axis_error_vector(const Vec4& axis, const Vec4& target) {
  const Vec4 sine = cross3(target, axis);
  const double cosine = dot3(target, axis), norm = std::sqrt(dot3(sine, sine));
  if (norm > 1e-12) return broadcast(std::atan2(norm, cosine) / norm) * sine;
  if (cosine > 0.0) return sine;
  return broadcast(M_PI) * to_vec4(to_vector3(target).unitOrthogonal());
}

/// A vector's component beyond `slack`, of its sign; 0 within, but what is no number stays none.
inline double beyond(double value, double slack) {
  return value > slack ? value - slack : value < -slack ? value + slack : 0.0 * value;
}

/// What is left of an error vector (base frame) when each component along `axes` is forgiven its
/// slack.
inline Vec4 beyond(const Vec4& error, const Frame& axes, const Eigen::Vector3d& slack) {
  return axes.x * broadcast(beyond(dot3(axes.x, error), slack.x())) +
         axes.y * broadcast(beyond(dot3(axes.y, error), slack.y())) +
         axes.z * broadcast(beyond(dot3(axes.z, error), slack.z()));
}

/// How that changes when the error changes by d: d along the axes that are beyond their slack.
inline Vec4 beyond_derivative(const Vec4& d, const Vec4& error, const Frame& axes,
                              const Eigen::Vector3d& slack) {
  Vec4 result{};
  const auto add = [&](const Vec4& axis, double allowed) {
    if (std::abs(dot3(axis, error)) >= allowed) result += broadcast(dot3(axis, d)) * axis;
  };
  add(axes.x, slack.x());
  add(axes.y, slack.y());
  add(axes.z, slack.z());
  return result;
}

/// How the rotation vector e of exp(e) changes when that rotation is followed by a small one w: the
/// inverse left Jacobian of SO(3), e' = w - e x w / 2 + k e x (e x w).
inline Vec4 rotation_vector_rate(const Vec4& e, const Vec4& w) {
  const double square = dot3(e, e), angle = std::sqrt(square);
  const double k = angle < 1e-3 ? 1.0 / 12.0 + square / 720.0
                                : (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / square;
  const Vec4 once = cross3(e, w);
  return w - broadcast(0.5) * once + broadcast(k) * cross3(e, once);
}

/// What of a goal a term has: of one whose position comes first both in turn, the second as a wish.
enum class GoalPart { Whole, Position, Rotation };

/// How little a wish weighs of what is hard: as much as it may bend hard goals while it is gone
/// after, before they are met once more.
constexpr double kWish = 1e-3;

/// One tip and its target (Sec. ee-pose), in both forms that the inner methods use.
class GoalTerm {
 public:
  GoalTerm(const Robot& robot, const Options& options, const Goal& goal,
           GoalPart part = GoalPart::Whole)
      : type_(part == GoalPart::Position ? GoalType::Position : goal.type),
        axis_(to_vec4(goal.axis.normalized())),
        target_(to_frame(goal.T_base_tip)) {
    const int link = robot.tips()[static_cast<std::size_t>(goal.tip)];
    body_ = robot.body_of_link(link);
    T_body_tip_ = compose(to_frame(robot.T_body_link(link)), to_frame(goal.T_tip_tool));
    if (goal.relative_to >= 0) {
      const int reference = robot.tips()[static_cast<std::size_t>(goal.relative_to)];
      reference_ = robot.body_of_link(reference);
      T_reference_target_ = compose(to_frame(robot.T_body_link(reference)), target_);
    }
    is_placed_ = part != GoalPart::Rotation && goal.type != GoalType::LookAt;
    weight_ = goal.weight * (goal.soft || part == GoalPart::Rotation ? kWish : 1.0);
    stands_ = goal.stands;
    position_slack_ = goal.position_slack;
    rotation_slack_ = goal.rotation_slack;
    has_slack_ = detail::has_slack(goal);
    position_tolerance_ = position_tolerance(goal, options);
    rotation_tolerance_ = rotation_tolerance(goal, options);
  }
  GoalTerm(int body, const Eigen::Isometry3d& T_body_tip, GoalType type,
           const Eigen::Vector3d& axis)
      : body_(body),
        T_body_tip_(to_frame(T_body_tip)),
        type_(type),
        axis_(to_vec4(axis.normalized())) {
    target_ = to_frame(Eigen::Isometry3d::Identity());
  }

  /// Let its errors weigh so many times as much.
  void weigh(double times) { weight_ *= times; }
  void set_target(const Eigen::Isometry3d& T) { target_ = to_frame(T); }
  /// Bring the target towards the tip, as placed, until the errors are within bounds [m], [rad]:
  /// both by the same share, so that what comes nearer to it comes nearer to where it was.
  /// @returns Whether it was farther.
  bool come_within(double position, double rotation) {
    const double p = position_distance(), r = rotation_distance();
    const double share = std::min({1.0, position / p, rotation / r});
    if (!(share < 1.0)) return false;
    if (r > 0.0) {
      const Vec4 e = broadcast(1.0 - share) * rotation_error();
      const double angle = std::sqrt(dot3(e, e));
      const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, to_vector3(e) / angle).toRotationMatrix();
      for (Vec4* axis : {&target_.x, &target_.y, &target_.z})
        *axis = to_vec4(R * to_vector3(*axis));
    }
    const Vec4 shift = broadcast(1.0 - share) * position_error();
    target_.p += shift;
    position_error_ -= shift;
    if (is_relative()) T_reference_target_ = to_local(T_base_reference_, target_);
    return true;
  }
  /// Take the tip, and what the target is relative to, from where the robot is.
  void place(const Rollout& rollout) {
    if (is_relative()) {
      T_base_reference_ = rollout.frame(reference_);
      target_ = compose(T_base_reference_, T_reference_target_);
    }
    place(rollout.frame(body_));
  }
  /// Take the tip from its body's frame.
  void place(const Frame& T_base_body) {
    tip_ = compose(T_base_body, T_body_tip_);
    position_error_ = tip_.p - target_.p;
    if (type_ != GoalType::LookAt) return;
    distance_ = std::max(std::sqrt(dot3(position_error_, position_error_)), kNearest);
    sight_ = broadcast(-1.0 / distance_) * position_error_;
  }
  /// The rotation vector from the target to the tip where it was placed [rad].
  Vec4 rotation_vector() const {
    if (type_ == GoalType::Pose) return rotation_error_vector(tip_, target_);
    if (by_axis()) return axis_error_vector(axis(), wanted_axis());
    return Vec4{};
  }

  int body() const { return body_; }
  /// Whether the target moves with another body, `reference`.
  bool is_relative() const { return reference_ >= 0; }
  int reference() const { return reference_; }
  GoalType type() const { return type_; }
  bool turns() const { return type_ != GoalType::Position; }
  /// Whether of the tip's orientation one axis counts, and which way it points and ought to, in
  /// the base frame.
  bool by_axis() const { return type_ == GoalType::Axis || type_ == GoalType::LookAt; }
  Vec4 axis() const { return rotate(tip_, axis_); }
  Vec4 wanted_axis() const { return type_ == GoalType::LookAt ? sight_ : rotate(target_, axis_); }
  double weight() const { return weight_; }
  bool stands() const { return stands_; }
  bool has_slack() const { return has_slack_; }
  const Frame& tip() const { return tip_; }
  const Frame& target() const { return target_; }
  bool is_met() const {
    return position_distance() < position_tolerance_ && rotation_distance() < rotation_tolerance_;
  }
  /// The same of squared errors.
  bool allows(double position2, double rotation2) const {
    return position2 < position_tolerance_ * position_tolerance_ &&
           rotation2 < rotation_tolerance_ * rotation_tolerance_;
  }
  /// What of the errors the goal's slack does not forgive, in the base frame [m], [rad].
  Vec4 position_error() const {
    if (!is_placed_) return Vec4{};
    return has_slack_ ? beyond(position_error_, target_, position_slack_) : position_error_;
  }
  Vec4 rotation_error() const {
    const Vec4 e = rotation_vector();
    if (!has_slack_) return e;
    if (type_ == GoalType::Pose) return beyond(e, target_, rotation_slack_);
    const double angle = std::sqrt(dot3(e, e)), slack = rotation_slack_.maxCoeff();
    return angle <= slack ? Vec4{} : broadcast(1.0 - slack / angle) * e;
  }
  /// The rotation error, computed once and kept until the tip is placed again.
  const Vec4& keep_rotation_error() { return kept_rotation_error_ = rotation_error(); }
  const Vec4& kept_rotation_error() const { return kept_rotation_error_; }
  /// How the errors change as the tip moves and turns, as the target sees it: `linear` and
  /// `angular`, in place. Of an axis, turning about itself changes nothing.
  void to_error_rates(Vec4& linear, Vec4& angular) const {
    if (by_axis()) {
      angular -= broadcast(dot3(axis(), angular)) * axis();
      // What is looked at goes by the other way.
      if (type_ == GoalType::LookAt) angular += broadcast(1.0 / distance_) * cross3(sight_, linear);
    } else if (has_slack_ && type_ == GoalType::Pose) {
      const Vec4 e = rotation_vector();
      angular = beyond_derivative(rotation_vector_rate(e, angular), e, target_, rotation_slack_);
    }
    if (!is_placed_)
      linear = Vec4{};
    else if (has_slack_)
      linear = beyond_derivative(linear, position_error_, target_, position_slack_);
  }
  double position_distance() const {
    const Vec4 error = position_error();
    return std::sqrt(dot3(error, error));
  }
  double rotation_distance() const {
    const Vec4 error = rotation_error();
    return std::sqrt(dot3(error, error));
  }
  /// Eq. obj, the trace of (U_e - U*)^T (U_e - U*) halved and weighted, and its wrench at the
  /// base's origin: the target's is against it, as the lines of both forces are one. The points are
  /// u_e and one at `distance` along x and y (Pose) or along the named axis (Axis).
  double point_objective(double distance, Vec4& force, Vec4& moment) const {
    double sum = 0.0;
    force = moment = Vec4{};
    const auto add = [&](const Vec4& point, const Vec4& error) {
      sum += 0.5 * weight_ * dot3(error, error);
      const Vec4 pull = broadcast(weight_) * error;
      force += pull;
      moment += cross3(point, pull);
    };
    add(tip_.p, position_error_);
    const auto add_on_axis = [&](const Vec4& axis, const Vec4& target_axis) {
      add(tip_.p + broadcast(distance) * axis,
          position_error_ + broadcast(distance) * (axis - target_axis));
    };
    if (type_ == GoalType::Pose) {
      add_on_axis(tip_.x, target_.x);
      add_on_axis(tip_.y, target_.y);
    } else if (type_ == GoalType::Axis) {
      add_on_axis(axis(), rotate(target_, axis_));
    }
    return sum;
  }

 private:
  /// What is looked at is nowhere if it is nearer than this [m].
  static constexpr double kNearest = 1e-9;

  int body_ = 0, reference_ = -1;
  Frame T_body_tip_{}, T_reference_target_{}, T_base_reference_{};
  GoalType type_;
  Vec4 axis_;
  Frame target_, tip_{};
  Vec4 position_error_{}, kept_rotation_error_{};
  double weight_ = 1.0;
  double position_tolerance_ = 0.0, rotation_tolerance_ = 0.0;
  bool stands_ = false, has_slack_ = false;
  bool is_placed_ = true;  ///< whether its position counts
  Vec4 sight_{};           ///< to what is looked at, and how far that is
  double distance_ = 1.0;
  Eigen::Vector3d position_slack_ = Eigen::Vector3d::Zero(),
                  rotation_slack_ = Eigen::Vector3d::Zero();
};

}  // namespace pdoik::detail
