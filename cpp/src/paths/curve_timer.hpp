#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "paths/rounded_curve.hpp"

namespace pdoik::detail {

/// The fastest motion along one curve, from rest to rest. What is between the points at which
/// limits were taken into account may be beyond them by a little: that is measured, and limits are
/// made smaller there by as much. What is left then is made up for by slowing all of it.
class CurveTimer {
 public:
  /// All of these outlive it.
  /// @param limits  Of all joints.
  /// @throws std::invalid_argument if there is no way from rest to rest.
  CurveTimer(const Robot& robot, const RoundedCurve& curve, const TimingLimits& limits);

  /// Of its steps, rising from 0.
  const Eigen::VectorXd& time() const { return time_; }
  /// Where it is on the curve at a time, and how joints move.
  void state(double t, double& s, Eigen::VectorXd& q, Eigen::VectorXd& dq, Eigen::VectorXd& ddq);

 private:
  /// Of limits: the speed and acceleration of joints, the speed and turning of the tool.
  using Shares = std::array<double, 4>;

  const Shares& share(double s) const;
  /// The less of both sides of an edge.
  Shares least_share(double s) const;
  bool has_tool() const;
  /// How fast the tool goes and turns.
  Eigen::Vector2d tool_rates(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) const;
  /// How much of limits is used.
  Shares use(const Eigen::VectorXd& q, const Eigen::VectorXd& dq, const Eigen::VectorXd& ddq) const;
  /// The largest square of ds/dt by the speeds of joints and tool.
  double ceiling(double s);
  Eigen::VectorXd grid();
  void find_motion();
  /// The largest use of each limit in each region.
  std::vector<Shares> measure();

  const Robot& robot_;
  const RoundedCurve& curve_;
  const TimingLimits& limits_;
  Eigen::VectorXd regions_;     ///< edges of regions
  std::vector<Shares> shares_;  ///< of each, how much of each limit may be used
  Eigen::VectorXd s_, x_;       ///< its grid, and the square of ds/dt there
  Eigen::VectorXd time_;
  double slowness_ = 1.0;  ///< in how many times the time all limits hold
  Eigen::VectorXd q_, q1_, q2_;
};

}  // namespace pdoik::detail
