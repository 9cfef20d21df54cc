#include "common/check_input.hpp"

#include <cmath>
#include <stdexcept>

namespace pdoik::detail {
namespace {

double off_orthonormal(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace

bool is_rigid(const Eigen::Isometry3d& T) {
  return T.matrix().allFinite() && off_orthonormal(T) <= 1e-6 && T.linear().determinant() > 0.0;
}

bool accepts_target(const Eigen::Isometry3d& T, const char* name, InputError& error) {
  if (!T.matrix().allFinite()) return error.say("%s holds NaN or infinity", name);
  if (!is_rigid(T)) {
    return error.say(
        "%s is not a rigid transform: its 3x3 part times its transpose is off the identity by %g, "
        "its determinant is %g, expected 1",
        name, off_orthonormal(T), T.linear().determinant());
  }
  return true;
}

void check_weights(const Eigen::VectorXd& weights, int dof, const std::string& name) {
  check_step(weights, dof, name);
  if (!weights.allFinite()) throw std::invalid_argument(name + " holds infinity");
}

void check_step(const Eigen::VectorXd& step, int dof, const std::string& name) {
  if (step.size() != dof) {
    throw std::invalid_argument(name + " has " + std::to_string(step.size()) +
                                " entries, the robot has " + std::to_string(dof) + " joints");
  }
  for (Eigen::Index i = 0; i < dof; ++i) {
    if (!(step[i] >= 0.0))  // infinity is fine
      throw std::invalid_argument(name + "[" + std::to_string(i) + "] is " +
                                  std::to_string(step[i]) + ", expected at least 0");
  }
}

void check_target(const Eigen::Isometry3d& T, const std::string& name) {
  InputError error;
  accepts_target(T, name.c_str(), error);
  error.raise();
}

void check_configuration(VectorIn q, int dof, const std::string& name) {
  if (q.size() != dof) {
    throw std::invalid_argument(name + " has " + std::to_string(q.size()) +
                                " entries, the robot has " + std::to_string(dof) + " joints");
  }
  if (!q.allFinite()) throw std::invalid_argument(name + " holds NaN or infinity");
}

}  // namespace pdoik::detail
