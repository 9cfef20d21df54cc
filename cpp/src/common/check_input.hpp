#pragma once

#include <string>

#include "common/input_error.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

// What enters at the border. Functions named check_ throw std::invalid_argument that names the
// thing, what was expected and what came; those named accepts_ say so in an error, without an
// allocation or exception, and return whether there is none.

/// Lengths beyond this are refused: rounding would blur distances [m].
constexpr double kLargestNumber = 1e6;

/// Whether a transform is finite, and its 3x3 part a rotation to 1e-6.
bool is_rigid(const Eigen::Isometry3d& T);
/// The same, where the transform is a target.
bool accepts_target(const Eigen::Isometry3d& T, const char* name, InputError& error);
void check_target(const Eigen::Isometry3d& T, const std::string& name = "T_base_tip");
/// Bounds on a step, one per joint, none negative; infinity is fine.
void check_step(const Eigen::VectorXd& step, int dof, const std::string& name);
/// The same, and finite.
void check_weights(const Eigen::VectorXd& weights, int dof, const std::string& name);
void check_configuration(VectorIn q, int dof, const std::string& name);

}  // namespace pdoik::detail
