#include "pdoik/joint_limit_map.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik {
namespace {

/// Wider joints would take more than 64 sub-angles [rad].
constexpr double kWidestRange = 64.0 * M_PI;

struct Sigmoid {
  double s;           ///< sigmoid(omega)
  double complement;  ///< 1 - s = sigmoid(-omega), without cancellation
};

Sigmoid sigmoid(double omega) {
  const double e = std::exp(-std::abs(omega));
  const double large = 1.0 / (1.0 + e), small = e * large;
  return omega >= 0.0 ? Sigmoid{large, small} : Sigmoid{small, large};
}

}  // namespace

JointLimitMap::JointLimitMap(const Robot& robot, Variables variables) {
  for (Eigen::Index i = 0; i < robot.dof(); ++i) {
    Joint joint{};
    joint.sub_angles = 1;
    joint.scale = joint.inverse_scale = 1.0;
    joint.lower = robot.lower()[i];
    joint.upper = robot.upper()[i];
    const double range = joint.upper - joint.lower;
    const JointType type = robot.joint_types()[static_cast<std::size_t>(i)];
    if (!std::isfinite(range) || variables == Variables::Positions) {
      joint.kind = Kind::Direct;
    } else if (type == JointType::Prismatic || range > kWidestRange) {
      joint.kind = type == JointType::Prismatic ? Kind::Sigmoid : Kind::AngleSigmoid;
      joint.sub_range = range;
    } else {
      joint.kind = Kind::Distance;
      joint.sub_angles = std::max(1, static_cast<int>(std::ceil(range / M_PI - 1e-9)));
      joint.scale = std::sqrt(joint.sub_angles);
      joint.inverse_scale = 1.0 / joint.scale;
      joint.sub_range = std::min(range / joint.sub_angles, M_PI);
      const double half = std::sin(0.5 * joint.sub_range);
      joint.L_max = joint.sub_range > M_PI - 1e-9 ? 2.0 : 2.0 * half * half;
      joint.cos_lower = std::cos(joint.lower);
      joint.sin_lower = std::sin(joint.lower);
    }
    joints_.push_back(joint);
  }
}

JointLimitMap::State JointLimitMap::make_state() const {
  State state;
  state.cosine.setOnes(size());
  state.sine.setZero(size());
  state.q.setZero(size());
  state.slope.setZero(size());
  return state;
}

void JointLimitMap::forward(const Eigen::VectorXd& omega, State& state, bool angles) const {
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Joint& joint = joints_[static_cast<std::size_t>(i)];
    if (joint.kind == Kind::Direct) {
      state.q[i] = omega[i];
      state.cosine[i] = std::cos(state.q[i]);
      state.sine[i] = std::sin(state.q[i]);
      state.slope[i] = 1.0;
      continue;
    }
    const auto [s, complement] = sigmoid(omega[i] * joint.inverse_scale);
    if (joint.kind != Kind::Distance) {
      state.q[i] = std::clamp(joint.lower + joint.sub_range * s, joint.lower, joint.upper);
      state.slope[i] = joint.sub_range * s * complement;
      if (joint.kind == Kind::Sigmoid) continue;
      state.cosine[i] = std::cos(state.q[i]);
      state.sine[i] = std::sin(state.q[i]);
      continue;
    }
    const double L = joint.L_max * s;                                     // Eq. squash1
    const double rest = joint.L_max == 2.0 ? 2.0 * complement : 2.0 - L;  // 2 - L
    const double root_L = std::sqrt(L), root_rest = std::sqrt(rest);
    const double cosine = 1.0 - L, sine = root_L * root_rest;  // Eq. sin2dist
    state.slope[i] =
        joint.scale * (joint.L_max == 2.0 ? 0.5 * sine : root_L * complement / root_rest);
    double re = joint.cos_lower, im = joint.sin_lower;
    for (int m = 0; m < joint.sub_angles; ++m) {
      const double product = re * cosine - im * sine;
      im = re * sine + im * cosine;
      re = product;
    }
    state.cosine[i] = re;
    state.sine[i] = im;
    if (!angles) continue;
    // Eq. recovery, with arccos(1 - L) written so that it is precise.
    const double angle = joint.lower + joint.sub_angles * 2.0 * std::atan2(root_L, root_rest);
    state.q[i] = std::clamp(angle, joint.lower, joint.upper);
  }
}

void JointLimitMap::positions(const Eigen::VectorXd& omega, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Joint& joint = joints_[static_cast<std::size_t>(i)];
    if (joint.kind == Kind::Direct) {
      q[i] = omega[i];
      continue;
    }
    const auto [s, complement] = sigmoid(omega[i] * joint.inverse_scale);
    const double L = joint.L_max * s;
    const double rest = joint.L_max == 2.0 ? 2.0 * complement : 2.0 - L;
    const double way = joint.kind != Kind::Distance
                           ? joint.sub_range * s
                           : joint.sub_angles * 2.0 * std::atan2(std::sqrt(L), std::sqrt(rest));
    q[i] = std::clamp(joint.lower + way, joint.lower, joint.upper);
  }
}

void JointLimitMap::pull_back(const State& state, const Eigen::VectorXd& dq,
                              Eigen::VectorXd& domega) const {
  domega = dq.cwiseProduct(state.slope);
}

void JointLimitMap::inverse(VectorIn q, Eigen::VectorXd& omega, double inset) const {
  for (Eigen::Index i = 0; i < size(); ++i) {
    const Joint& joint = joints_[static_cast<std::size_t>(i)];
    const double position = q[i];
    if (joint.kind == Kind::Direct) {
      omega[i] = position;
      continue;
    }
    const double range = joint.upper - joint.lower;
    const double fraction =
        range > 0.0 ? std::clamp((position - joint.lower) / range, inset, 1.0 - inset) : 0.5;
    double slack = 0.0;
    if (joint.kind != Kind::Distance) {
      slack = std::log(fraction) - std::log1p(-fraction);
    } else {
      // s : 1 - s = (1 - cos theta) : (cos theta - cos sub_range), both as products of sines.
      const double theta = fraction * joint.sub_range;
      const double low = std::sin(0.5 * theta);
      const double high = std::sin(0.5 * (joint.sub_range + theta)) *
                          std::sin(0.5 * joint.sub_range * (1.0 - fraction));
      slack = range > 0.0 ? std::log(low * low) - std::log(high) : 0.0;
    }
    constexpr double kSaturated = 700.0;  // exp of more overflows
    omega[i] = joint.scale * std::clamp(slack, -kSaturated, kSaturated);
  }
}

}  // namespace pdoik
