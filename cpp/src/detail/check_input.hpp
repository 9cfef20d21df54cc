#pragma once

#include <string>

#include "pdoik/solver.hpp"

namespace pdoik::detail {

// What enters at the border. All throw std::invalid_argument that names the thing, what was
// expected and what came.

/// One tip, 1 to 64 joints.
void check_robot(const Robot& robot);
/// Rigid to 1e-6.
void check_target(const Eigen::Isometry3d& T, const std::string& name = "T_base_tip");
void check_configuration(const Eigen::VectorXd& q, int dof, const std::string& name);
/// Finite rows of three or four, none beyond 1e6 m, no radius negative.
void check_obstacles(const Obstacles& points);

}  // namespace pdoik::detail
