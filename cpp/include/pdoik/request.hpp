#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "pdoik/goal.hpp"

namespace pdoik {

/// A joint that keeps a position.
struct Lock {
  int joint = 0;          ///< its place in robot.joint_names()
  double position = 0.0;  ///< [rad] or [m], inside its limits
};

/// What one solve is asked. All is read where the caller keeps it.
struct Request {
  std::span<const Goal> goals = {};  ///< tips without one are free
  /// Instead of `goals`: lists of which any one will do, a grasp set. Starts are shared among them;
  /// the answer is the first that is found, or with Prefer::Nearest the nearest of all.
  std::span<const std::vector<Goal>> any_of = {};
  /// What each of `any_of` costs: the cheapest that can be met is wanted. Empty for all alike.
  std::span<const double> costs = {};
  /// Where to start, shape (n,), moved inside the limits; answers near it are preferred. Null for
  /// the middle of the ranges (Method::Paper: omega = 0), and any answer.
  const Eigen::VectorXd* q0 = nullptr;
  /// A posture, shape (n,), that the answer comes as near to as goals and constraints let it, by
  /// going downhill from the first solution found. Null for none.
  const Eigen::VectorXd* posture = nullptr;
  /// Hard bounds on |q - q0| of each joint, shape (n,), not negative [rad] or [m]: speed times
  /// period, for a step that a machine can make. Null for none. Needs q0.
  const Eigen::VectorXd* max_step = nullptr;
  std::span<const Lock> locks = {};  ///< joints that keep a position

  /// The goals of a place among `any_of`, or `goals`, which are the only ones where it is empty.
  std::span<const Goal> alternative(int place) const {
    return any_of.empty() ? goals : any_of[static_cast<std::size_t>(place)];
  }
};

}  // namespace pdoik
