#include "detail/check_input.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "detail/text.hpp"

namespace pdoik::detail {

void check_robot(const Robot& robot) {
  if (robot.tips().size() != 1) {
    throw std::invalid_argument("the robot has " + std::to_string(robot.tips().size()) +
                                " tips, expected one: choose tip_link among " +
                                join(robot.tip_links()));
  }
  if (robot.dof() < 1 || robot.dof() > 64) {
    throw std::invalid_argument("the robot has " + std::to_string(robot.dof()) +
                                " joints, expected 1 to 64");
  }
}

void check_target(const Eigen::Isometry3d& T, const std::string& name) {
  if (!T.matrix().allFinite()) throw std::invalid_argument(name + " holds NaN or infinity");
  const Eigen::Matrix3d R = T.linear();
  const double gap = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (gap <= 1e-6 && R.determinant() > 0.0) return;
  std::ostringstream message;
  message << name
          << " is not a rigid transform: its 3x3 part times its transpose is off the identity by "
          << gap << ", its determinant is " << R.determinant() << ", expected 1";
  throw std::invalid_argument(message.str());
}

void check_configuration(const Eigen::VectorXd& q, int dof, const std::string& name) {
  if (q.size() != dof) {
    throw std::invalid_argument(name + " has " + std::to_string(q.size()) +
                                " entries, the robot has " + std::to_string(dof) + " joints");
  }
  if (!q.allFinite()) throw std::invalid_argument(name + " holds NaN or infinity");
}

namespace {

/// Beyond this rounding would blur distances to the arm [m].
constexpr double kLargestCoordinate = 1e6;

}  // namespace

void check_obstacles(const Obstacles& points) {
  if (points.rows() == 0) return;
  if (points.cols() != 3 && points.cols() != 4) {
    throw std::invalid_argument("obstacles has shape (" + std::to_string(points.rows()) + ", " +
                                std::to_string(points.cols()) + "), expected (N, 3) or (N, 4)");
  }
  // Zero times a finite number is zero: one pass without a branch finds whether anything is wrong.
  double poison = 0.0, least_radius = 0.0, largest = 0.0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    for (Eigen::Index j = 0; j < points.cols(); ++j) {
      poison += 0.0 * points(i, j);
      largest = std::max(largest, std::abs(points(i, j)));
    }
    if (points.cols() == 4) least_radius = std::min(least_radius, points(i, 3));
  }
  if (poison == 0.0 && least_radius >= 0.0 && largest <= kLargestCoordinate) return;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (!points.row(i).allFinite()) {
      throw std::invalid_argument("obstacles holds NaN or infinity in row " + std::to_string(i));
    }
    if (points.row(i).cwiseAbs().maxCoeff() > kLargestCoordinate) {
      throw std::invalid_argument("obstacles has a number beyond 1e6 m in row " +
                                  std::to_string(i));
    }
    if (points.cols() == 4 && points(i, 3) < 0.0) {
      throw std::invalid_argument("obstacles has a negative radius in row " + std::to_string(i));
    }
  }
}

}  // namespace pdoik::detail
