#pragma once

#include <Eigen/Core>
#include <cmath>

#include "hulls/hull_model.hpp"

namespace pdoik::detail {

/// A bound on how far any attached point of a hull, or any part of its capsules, gets when each
/// joint makes up to a step, shape (n,), from anywhere within the limits [m]: infinite if a joint
/// slides without bound.
double farthest_travel(const Robot& robot, const HullModel& hulls, const Eigen::VectorXd& step);

/// The same of the tips alone.
double farthest_tip_travel(const Robot& robot, const Eigen::VectorXd& step);

/// What one unit of each joint moves any part of any hull by, at most, shape (n,) [m/rad] or 1,
/// while all joints are between two configurations. Allocates nothing if `displacement_bounds` has
/// its size.
void hull_displacement_bounds(const Robot& robot, const HullModel& hulls,
                              const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                              Eigen::VectorXd& displacement_bounds);

/// Ways are cut into pieces so short that what a hull can touch inside one, and not where it is
/// looked at, is no deeper than this: the sagitta of a piece on a hull as narrow as the thinnest
/// [m].
constexpr double kGraze = 5e-5;
/// How long such a piece is, of what moves farthest, by half the width of the thinnest hull [m].
inline double finest_piece(double narrowest) { return std::sqrt(8.0 * narrowest * kGraze); }

/// Half the width of the thinnest moving hull, with every joint in the middle of its range where
/// that changes it; infinite if there is none [m].
double thinnest_hull(const Robot& robot, const HullModel& hulls);

}  // namespace pdoik::detail
