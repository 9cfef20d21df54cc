#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "detail/frame.hpp"
#include "pdoik/options.hpp"

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

/// One tip and its target (Sec. ee-pose), in both forms that the inner methods use.
class GoalTerm {
 public:
  GoalTerm(int body, const Eigen::Isometry3d& T_body_tip, GoalType type,
           const Eigen::Vector3d& axis)
      : body_(body),
        T_body_tip_(to_frame(T_body_tip)),
        type_(type),
        axis_(to_vec4(axis.normalized())) {
    target_ = to_frame(Eigen::Isometry3d::Identity());
  }

  void set_target(const Eigen::Isometry3d& T) { target_ = to_frame(T); }
  /// Take the tip from its body's frame.
  void place(const Frame& T_base_body) {
    tip_ = compose(T_base_body, T_body_tip_);
    position_error_ = tip_.p - target_.p;
  }
  /// The rotation vector from the target to the tip where it was placed [rad].
  Vec4 rotation_error() const {
    if (type_ == GoalType::Pose) return rotation_error_vector(tip_, target_);
    if (type_ == GoalType::Axis) return axis_error_vector(axis(), rotate(target_, axis_));
    return Vec4{};
  }

  int body() const { return body_; }
  GoalType type() const { return type_; }
  const Frame& tip() const { return tip_; }
  const Vec4& position_error() const { return position_error_; }  ///< [m]
  double position_distance() const { return std::sqrt(dot3(position_error_, position_error_)); }
  double rotation_distance() const {
    const Vec4 error = rotation_error();
    return std::sqrt(dot3(error, error));
  }
  /// The tip's constrained axis in the base frame (GoalType::Axis).
  Vec4 axis() const { return rotate(tip_, axis_); }

  /// Eq. obj, the trace of (U_e - U*)^T (U_e - U*) halved, and its wrench at the base's origin. The
  /// points are u_e and one at `distance` along x and y (Pose) or along the named axis (Axis).
  double point_objective(double distance, Vec4& force, Vec4& moment) const {
    double sum = 0.0;
    force = moment = Vec4{};
    const auto add = [&](const Vec4& point, const Vec4& error) {
      sum += 0.5 * dot3(error, error);
      force += error;
      moment += cross3(point, error);
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
  int body_;
  Frame T_body_tip_;
  GoalType type_;
  Vec4 axis_;
  Frame target_, tip_{};
  Vec4 position_error_{};
};

}  // namespace pdoik::detail
