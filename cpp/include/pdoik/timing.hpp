#pragma once

#include <Eigen/Core>
#include <limits>

#include "pdoik/robot.hpp"

namespace pdoik {

/// Limits of a timed motion, besides the speed limits of the robot.
struct TimingLimits {
  Eigen::VectorXd max_acceleration;  ///< of joints, shape (n,) [rad/s^2] or [m/s^2]
  /// Of joints' speeds, shape (n,), or empty [rad/s] or [m/s]. Needed of joints that have no limit
  /// in the robot's description.
  Eigen::VectorXd max_speed = {};
  /// Of the tool's origin, in the base frame: it goes at this speed wherever joints allow it [m/s].
  double tool_speed = std::numeric_limits<double>::infinity();
  double tool_turn = std::numeric_limits<double>::infinity();  ///< the same of its turning [rad/s]
  int tip = -1;  ///< whose speed it is: an index from Robot::link_index, or -1 for the first tip
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< the tool's origin in that link's frame [m]
};

/// How a motion is timed.
struct TimingOptions {
  /// How far a joint may be off the straight lines between rows, where corners are rounded [rad] or
  /// [m]. The smaller it is, the slower corners are.
  double deviation = 1e-4;
  double rate = 0.0;  ///< samples a second [Hz]; 0 for the motion's own steps, at uneven times
};

/// A motion in time, from rest to rest.
struct TimedMotion {
  /// Configurations or rates one after the other.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::VectorXd time;    ///< rising from 0, shape (k,) [s]
  Rows q;                  ///< (k, n) [rad] or [m]
  Rows dq;                 ///< its derivative, (k, n) [rad/s] or [m/s]
  Rows ddq;                ///< the next; where it jumps, what it is afterwards
  Eigen::VectorXd at;      ///< place on the path, shape (k,): see time_path
  double deviation = 0.0;  ///< largest of a joint from the straight lines between rows
};

/// The fastest motion along rows, such as PathResult::q and MotionResult::q, within limits of
/// speed, acceleration and of the tool; jerk is not limited. Corners are rounded by a cubic spline
/// that is twice continuously differentiable. What is returned was measured at several moments of
/// each step, and slowed by as much as was missing (Pham and Pham, A New Approach to Time-Optimal
/// Path Parameterization Based on Reachability Analysis, IEEE T-RO 34(3), 2018).
/// @param q   Configurations joined by straight lines, shape (m, n). Repeated rows are one.
/// @param at  The place of each row on the path, rising, such as PathResult::at; empty for the
///            rows' numbers.
/// @throws std::invalid_argument if a shape or number is wrong, there are no two different rows, or
///     a joint that moves has no speed limit.
TimedMotion time_path(const Robot& robot, const TimedMotion::Rows& q, const TimingLimits& limits,
                      const TimingOptions& options = {}, const Eigen::VectorXd& at = {});

/// The fastest way from rest to rest along a grid: with x the square of ds/dt and u = x'/2,
///     |a u + b x| <= 1,    0 <= x <= most
/// at both ends of each cell, on which u is constant.
/// @param s     Rising, shape (m,).
/// @param a, b  One column a constraint, shape (m, k).
/// @param most  Shape (m,), positive.
/// @returns x, shape (m,), 0 at both ends.
/// @throws std::invalid_argument if shapes do not belong together, or s does not rise.
Eigen::VectorXd fastest_squares(const Eigen::VectorXd& s, const TimedMotion::Rows& a,
                                const TimedMotion::Rows& b, const Eigen::VectorXd& most);

}  // namespace pdoik
