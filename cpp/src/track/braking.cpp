#include "track/braking.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace pdoik::detail {
namespace {

constexpr double kSpeedRounding = 1e-9;  ///< of a speed
constexpr double kOfPlace = 1e-15;       ///< of where a joint is

}  // namespace

Braking::Braking(double period, Eigen::VectorXd lower, Eigen::VectorXd upper, Eigen::VectorXd speed,
                 Eigen::VectorXd acceleration)
    : period_(period),
      limited_((acceleration.array() < std::numeric_limits<double>::infinity()).any()),
      lower_(std::move(lower)),
      upper_(std::move(upper)),
      most_(std::move(speed)),
      acceleration_(std::move(acceleration)) {
  const Eigen::Index n = most_.size();
  for (Eigen::VectorXd* each : {&farthest_, &velocity_, &drift_, &rest_, &start_, &begun_})
    each->setZero(n);
  for (Eigen::Index i = 0; i < n; ++i) farthest_[i] = way(i, most_[i]);
}

double Braking::way(Eigen::Index i, double speed) const {
  const double a = acceleration_[i], brakes = std::isinf(a) ? 0.0 : speed * speed / (2.0 * a);
  return speed * period_ + std::copysign(brakes, speed);
}

double Braking::speed(Eigen::Index i, double way) const {
  // Of v T + v^2 / (2 a) = way, in the form that an infinite a and a small way leave exact.
  const double far = 2.0 * std::abs(way);
  if (std::isinf(far)) return way;
  return std::copysign(far / (period_ + std::sqrt(period_ * period_ + far / acceleration_[i])),
                       way);
}

Braking::Range Braking::range(Eigen::Index i, double from) const {
  const double change = acceleration_[i] * period_;
  const double least = speed(i, lower_[i] - from), most = speed(i, upper_[i] - from);
  return {std::clamp(std::clamp(velocity_[i] - change, -most_[i], most_[i]), least, most),
          std::clamp(std::clamp(velocity_[i] + change, -most_[i], most_[i]), least, most)};
}

void Braking::begin(const Eigen::VectorXd& at, const Eigen::Ref<const Eigen::VectorXd>& velocity) {
  if (velocity.size() > 0)
    velocity_ = velocity;
  else
    velocity_.setZero();
  drift_.setZero();
  rest_ = at;
  follows_ = was_hard_ = false;
}

void Braking::made(const Eigen::VectorXd& from, const Eigen::VectorXd& to, bool meets_goals,
                   bool held) {
  if (!limited_) return;
  was_hard_ = false;
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const double now = (to[i] - from[i]) / period_;
    const double may = acceleration_[i] * period_, change = std::abs(now - velocity_[i]);
    const double rounding = kSpeedRounding * (std::abs(now) + std::abs(velocity_[i]) + may) +
                            kOfPlace * std::abs(from[i]) / period_;
    was_hard_ |= change > may + rounding;
    velocity_[i] = now;
    rest_[i] = from[i] + way(i, now);
  }
  follows_ = meets_goals || (follows_ && !held);
}

void Braking::set_drift(const Eigen::VectorXd& drift) {
  if (drift.allFinite() && (drift.array().abs() <= most_.array()).all())
    drift_ = drift;
  else
    drift_.setZero();
}

void Braking::box(const Eigen::VectorXd& from, Eigen::VectorXd& lower,
                  Eigen::VectorXd& upper) const {
  if (!limited_) {
    lower = (from - farthest_).cwiseMax(lower_).cwiseMin(upper_);
    upper = (from + farthest_).cwiseMax(lower_).cwiseMin(upper_);
    return;
  }
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const double met = from[i] + drift_[i] * period_;
    const Range may = range(i, from[i]);
    lower[i] = met + way(i, may.slowest - drift_[i]);
    upper[i] = met + way(i, may.fastest - drift_[i]);
  }
}

void Braking::gentlest(const Eigen::VectorXd& from, Eigen::VectorXd& aim) const {
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const Range may = range(i, from[i]);
    const double least = std::clamp(speed(i, rest_[i] - from[i]), may.slowest, may.fastest);
    aim[i] = from[i] + drift_[i] * period_ + way(i, least - drift_[i]);
  }
}

void Braking::place(const Eigen::VectorXd& from, const Eigen::VectorXd& aim, Eigen::VectorXd& next,
                    Eigen::VectorXd& rest) const {
  if (!limited_) {
    next = rest = aim;
    return;
  }
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    const double v = drift_[i] + speed(i, aim[i] - from[i] - drift_[i] * period_);
    next[i] = std::clamp(from[i] + v * period_, lower_[i], upper_[i]);
    rest[i] = std::clamp(from[i] + way(i, v), lower_[i], upper_[i]);
  }
}

double Braking::brake(const Eigen::VectorXd& from, const Eigen::VectorXd& next,
                      const Eigen::VectorXd& displacement_bounds) {
  start_ = next;
  begun_ = (next - from) / period_;
  longest_ = (begun_.array().abs() / acceleration_.array()).maxCoeff();
  // A joint's speed falls evenly, and none rests later: none is faster than its share of what is
  // left of the time.
  return 0.5 * longest_ * (displacement_bounds.array() * begun_.array().abs()).sum();
}

void Braking::between(double share, Eigen::VectorXd& q) const {
  const double time = longest_ * (1.0 - std::sqrt(1.0 - share));
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double rests = std::min(time, std::abs(begun_[i]) / acceleration_[i]);
    q[i] = start_[i] + begun_[i] * rests -
           0.5 * std::copysign(acceleration_[i] * rests * rests, begun_[i]);
    if (acceleration_[i] == std::numeric_limits<double>::infinity()) q[i] = start_[i];
  }
}

}  // namespace pdoik::detail
