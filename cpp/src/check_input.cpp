#include "detail/check_input.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "detail/check_options.hpp"
#include "detail/text.hpp"
#include "pdoik/cloud.hpp"

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

bool accepts_target(const Eigen::Isometry3d& T, const char* name, Complaint& complaint) {
  if (!T.matrix().allFinite()) return complaint.say("%s holds NaN or infinity", name);
  if (!is_rigid(T)) {
    return complaint.say(
        "%s is not a rigid transform: its 3x3 part times its transpose is off the identity by %g, "
        "its determinant is %g, expected 1",
        name, off_orthonormal(T), T.linear().determinant());
  }
  return true;
}

const char* link_of_tip(int tip, const Robot& robot) {
  const int link = robot.tips()[static_cast<std::size_t>(tip)];
  return robot.link_names()[static_cast<std::size_t>(link)].c_str();
}

void add_tips(const Robot& robot, Complaint& complaint) {
  for (std::size_t k = 0; k < robot.tips().size(); ++k)
    complaint.add("%s%s", k == 0 ? "" : ", ", link_of_tip(static_cast<int>(k), robot));
}

bool accepts_goal(const Goal& goal, const Robot& robot, bool slack_allowed, Complaint& complaint) {
  const auto tips = static_cast<int>(robot.tips().size());
  if (goal.tip < 0 || goal.tip >= tips) {
    complaint.say("a goal's tip is %d, expected 0 to %d: ", goal.tip, tips - 1);
    add_tips(robot, complaint);
    return false;
  }
  const char* const link = link_of_tip(goal.tip, robot);
  if (!accepts_target(goal.T_base_tip, "T_base_tip", complaint)) {
    if (tips == 1) return false;
    Complaint named;
    named.add("T_base_tip of the goal for '%s'%s", link,
              complaint.text() + sizeof("T_base_tip") - 1);
    complaint = named;
    return false;
  }
  const double length = goal.axis.norm();
  if (!(length > 1e-9) || !std::isfinite(length))
    return complaint.say("axis of the goal for '%s' has length %f, expected a direction", link,
                         length);
  if (!(goal.weight > 0.0) || !std::isfinite(goal.weight))
    return complaint.say("weight of the goal for '%s' is %f, expected a positive finite number",
                         link, goal.weight);
  const auto accepts_slack = [&](const char* what, const Eigen::Vector3d& slack) {
    if (!slack.allFinite() || slack.minCoeff() < 0.0)
      return complaint.say("%s of the goal for '%s' holds a number that is negative or not finite",
                           what, link);
    if (!slack_allowed && !slack.isZero(0.0))
      return complaint.say(
          "%s of the goal for '%s' needs method 'default' with inner 'levenberg_marquardt'", what,
          link);
    return true;
  };
  return accepts_slack("position_slack", goal.position_slack) &&
         accepts_slack("rotation_slack", goal.rotation_slack);
}

bool by_least_squares(const Options& options) {
  return options.method == Method::Default && options.inner == InnerMethod::LevenbergMarquardt;
}

}  // namespace

bool is_rigid(const Eigen::Isometry3d& T) {
  return T.matrix().allFinite() && off_orthonormal(T) <= 1e-6 && T.linear().determinant() > 0.0;
}

bool accepts_goals(std::span<const Goal> goals, const Robot& robot, const Options& options,
                   Complaint& complaint) {
  complaint.clear();
  if (goals.empty()) {
    complaint.say("there is no goal, expected one for at least one tip of ");
    add_tips(robot, complaint);
    return false;
  }
  for (std::size_t i = 0; i < goals.size(); ++i) {
    if (!accepts_goal(goals[i], robot, by_least_squares(options), complaint)) return false;
    for (std::size_t j = 0; j < i; ++j) {
      if (goals[j].tip == goals[i].tip)
        return complaint.say("there are two goals for '%s'", link_of_tip(goals[i].tip, robot));
    }
  }
  return true;
}

void check_goals(std::span<const Goal> goals, const Robot& robot, const Options& options) {
  Complaint complaint;
  accepts_goals(goals, robot, options, complaint);
  complaint.raise();
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
  Complaint complaint;
  accepts_target(T, name.c_str(), complaint);
  complaint.raise();
}

void check_configuration(VectorIn q, int dof, const std::string& name) {
  if (q.size() != dof) {
    throw std::invalid_argument(name + " has " + std::to_string(q.size()) +
                                " entries, the robot has " + std::to_string(dof) + " joints");
  }
  if (!q.allFinite()) throw std::invalid_argument(name + " holds NaN or infinity");
}

template <class Rows>
bool accepts_obstacles(const Rows& points, Complaint& complaint, const char* name) {
  complaint.clear();
  if (points.rows() == 0) return true;
  const auto row = [](Eigen::Index i) { return static_cast<long long>(i); };
  if (points.cols() != 3 && points.cols() != 4)
    return complaint.say("%s has shape (%lld, %lld), expected (N, 3) or (N, 4)", name,
                         row(points.rows()), row(points.cols()));
  // Zero times a finite number is zero: one pass without a branch finds whether anything is wrong.
  using Scalar = typename Rows::Scalar;
  const bool has_radius = points.cols() == 4;
  Scalar poison = 0, least_radius = 0, largest = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Scalar x = points(i, 0), y = points(i, 1), z = points(i, 2),
                 r = has_radius ? points(i, 3) : Scalar{0};
    poison += Scalar{0} * x + Scalar{0} * y + Scalar{0} * z + Scalar{0} * r;
    largest =
        std::max(largest, std::max(std::max(std::abs(x), std::abs(y)), std::max(std::abs(z), r)));
    least_radius = std::min(least_radius, r);
  }
  if (poison == Scalar{0} && least_radius >= Scalar{0} && largest <= Scalar{kLargestNumber})
    return true;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (!points.row(i).allFinite())
      return complaint.say("%s holds NaN or infinity in row %lld", name, row(i));
    if (points.row(i).cwiseAbs().maxCoeff() > Scalar{kLargestNumber})
      return complaint.say("%s has a number beyond 1e6 m in row %lld", name, row(i));
    if (points.cols() == 4 && points(i, 3) < Scalar{0})
      return complaint.say("%s has a negative radius in row %lld", name, row(i));
  }
  return true;
}
template bool accepts_obstacles(const Obstacles&, Complaint&, const char*);
template bool accepts_obstacles(const ObstaclesF&, Complaint&, const char*);

void check_obstacles(const Obstacles& points) {
  Complaint complaint;
  accepts_obstacles(points, complaint);
  complaint.raise();
}

void check_count(Eigen::Index points, const char* name) {
  if (static_cast<std::size_t>(points) <= Cloud::kMostPoints) return;
  throw std::invalid_argument(std::string(name) + " has " + std::to_string(points) +
                              " rows, expected at most " + std::to_string(Cloud::kMostPoints) +
                              ": thin them out first (voxel_downsample)");
}

}  // namespace pdoik::detail
