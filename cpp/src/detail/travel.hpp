#pragma once

#include <Eigen/Core>

#include "detail/collision_state.hpp"
#include "detail/hull_model.hpp"
#include "detail/rollout.hpp"

namespace pdoik::detail {

/// A bound on how far any attached point of a hull, or any part of its capsules, gets when each
/// joint makes up to a step, shape (n,), from anywhere within the limits [m]: infinite if a joint
/// slides without bound.
double farthest_travel(const Robot& robot, const HullModel& hulls, const Eigen::VectorXd& step);

/// The same of one hull, from where a rollout has it and all are placed.
double travel_from(const Rollout& rollout, const CollisionState& hulls, std::size_t hull,
                   const Eigen::VectorXd& step);

/// The same of the tips alone.
double farthest_tip_travel(const Robot& robot, const Eigen::VectorXd& step);

/// What one unit of each joint moves any part of any hull by, at most, shape (n,) [m/rad] or 1,
/// while all joints are between two configurations. Allocates nothing if `levers` has its size.
void hull_levers(const Robot& robot, const HullModel& hulls, const Eigen::VectorXd& from,
                 const Eigen::VectorXd& to, Eigen::VectorXd& levers);

/// Half the width of the thinnest moving hull, with every joint in the middle of its range where
/// that changes it; infinite if there is none [m].
double thinnest_hull(const Robot& robot, const HullModel& hulls);

}  // namespace pdoik::detail
