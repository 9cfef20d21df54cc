#pragma once

#include <Eigen/Core>

#include "hulls/hull_model.hpp"
#include "kinematics/rollout.hpp"
#include "obstacles/collision_state.hpp"

namespace pdoik::detail {

/// A bound on how far any part of one hull gets from where a rollout has it and all are placed,
/// when each joint makes up to a share of a step, shape (n,) [m]; seen from the base, or a body
/// that moves all of the hull.
double travel_from(const Rollout& rollout, const CollisionState& hulls, const Hull& hull,
                   const Eigen::VectorXd& step, double share = 1.0, int carrier = 0);

}  // namespace pdoik::detail
