#include "detail/check_input.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "detail/check_options.hpp"
#include "detail/text.hpp"

namespace pdoik::detail {

void check_robot(const Robot& robot) {
  if (robot.dof() < 1 || robot.dof() > 64) {
    throw std::invalid_argument("the robot has " + std::to_string(robot.dof()) +
                                " joints, expected 1 to 64");
  }
}

void check_set_up(const Robot& robot, const Options& options) {
  check_options(options);
  check_robot(robot);
  if (options.joint_weights.size() > 0)
    check_weights(options.joint_weights, robot.dof(), "joint_weights");
}

void check_one_tip(const Robot& robot) {
  if (robot.tips().size() == 1) return;
  throw std::invalid_argument("the robot has " + std::to_string(robot.tips().size()) +
                              " tips, expected one, or goals by tip: " + join(robot.tip_links()));
}

namespace {

double off_orthonormal(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

bool is_rigid(const Eigen::Isometry3d& T) {
  return T.matrix().allFinite() && off_orthonormal(T) <= 1e-6 && T.linear().determinant() > 0.0;
}

std::string name_of(const Goal& goal, const Robot& robot) {
  const int link = robot.tips()[static_cast<std::size_t>(goal.tip)];
  return robot.link_names()[static_cast<std::size_t>(link)];
}

void check_goal(const Goal& goal, const Robot& robot, bool slack_allowed) {
  const auto tips = static_cast<int>(robot.tips().size());
  if (goal.tip < 0 || goal.tip >= tips) {
    throw std::invalid_argument("a goal's tip is " + std::to_string(goal.tip) + ", expected 0 to " +
                                std::to_string(tips - 1) + ": " + join(robot.tip_links()));
  }
  // Names are made up only where something is wrong: a good goal allocates nothing.
  const auto refuse = [&](const char* what, const std::string& complaint) {
    throw std::invalid_argument(what + (" of the goal for '" + name_of(goal, robot)) + "' " +
                                complaint);
  };
  if (!is_rigid(goal.T_base_tip)) {
    check_target(
        goal.T_base_tip,
        tips == 1 ? "T_base_tip" : "T_base_tip of the goal for '" + name_of(goal, robot) + "'");
  }
  const double length = goal.axis.norm();
  if (!(length > 1e-9) || !std::isfinite(length))
    refuse("axis", "has length " + std::to_string(length) + ", expected a direction");
  if (!(goal.weight > 0.0) || !std::isfinite(goal.weight))
    refuse("weight", "is " + std::to_string(goal.weight) + ", expected a positive finite number");
  const auto check_slack = [&](const char* what, const Eigen::Vector3d& slack) {
    if (!slack.allFinite() || slack.minCoeff() < 0.0)
      refuse(what, "holds a number that is negative or not finite");
    if (!slack_allowed && !slack.isZero(0.0))
      refuse(what, "needs method 'default' with inner 'levenberg_marquardt'");
  };
  check_slack("position_slack", goal.position_slack);
  check_slack("rotation_slack", goal.rotation_slack);
}

bool by_least_squares(const Options& options) {
  return options.method == Method::Default && options.inner == InnerMethod::LevenbergMarquardt;
}

}  // namespace

void check_goals(std::span<const Goal> goals, const Robot& robot, const Options& options) {
  if (goals.empty())
    throw std::invalid_argument("there is no goal, expected one for at least one tip of " +
                                join(robot.tip_links()));
  for (std::size_t i = 0; i < goals.size(); ++i) {
    check_goal(goals[i], robot, by_least_squares(options));
    for (std::size_t j = 0; j < i; ++j) {
      if (goals[j].tip == goals[i].tip)
        throw std::invalid_argument("there are two goals for '" + name_of(goals[i], robot) + "'");
    }
  }
}

void check_request(const Request& request, const Robot& robot, const Options& options) {
  check_goals(request.goals, robot, options);
  if (request.q0 != nullptr) check_configuration(*request.q0, robot.dof(), "q0");
  if (request.posture != nullptr) {
    check_configuration(*request.posture, robot.dof(), "posture");
    if (options.method == Method::Paper)
      throw std::invalid_argument("posture needs method 'default'");
  }
  if (request.max_step == nullptr) return;
  if (request.q0 == nullptr) throw std::invalid_argument("max_step needs q0, to count from");
  if (!by_least_squares(options))
    throw std::invalid_argument("max_step needs method 'default' with inner 'levenberg_marquardt'");
  check_step(*request.max_step, robot.dof(), "max_step");
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
  if (is_rigid(T)) return;
  if (!T.matrix().allFinite()) throw std::invalid_argument(name + " holds NaN or infinity");
  std::ostringstream message;
  message << name
          << " is not a rigid transform: its 3x3 part times its transpose is off the identity by "
          << off_orthonormal(T) << ", its determinant is " << T.linear().determinant()
          << ", expected 1";
  throw std::invalid_argument(message.str());
}

void check_configuration(VectorIn q, int dof, const std::string& name) {
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
