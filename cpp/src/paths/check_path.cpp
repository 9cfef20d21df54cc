#include "paths/check_path.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "common/check_input.hpp"
#include "kinematics/goal_of.hpp"
#include "problem/check_request.hpp"
#include "search/lane_search.hpp"

namespace pdoik::detail {
namespace {

/// Two targets no farther apart than this are the same: less than a tolerance [m] and [rad].
constexpr double kSame = 1e-9;

void check_method(const Options& options, const char* what) {
  if (options.method != Method::Default || options.inner != InnerMethod::LevenbergMarquardt)
    throw std::invalid_argument(std::string(what) +
                                " needs method 'default' with inner 'levenberg_marquardt'");
}

void check_positive(double value, const char* name) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                              ", expected a positive number");
}

void check_cost(double value, const char* name) {
  if (value >= 0.0 && std::isfinite(value)) return;
  throw std::invalid_argument("the cost of " + std::string(name) + " is " + std::to_string(value) +
                              ", expected a finite number of at least 0");
}

std::string station(std::size_t k) { return "station " + std::to_string(k); }

bool are_same(const std::vector<Goal>& one, const std::vector<Goal>& other) {
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Eigen::Isometry3d T = one[i].T_base_tip.inverse() * other[i].T_base_tip;
    if (T.translation().norm() > kSame || Eigen::AngleAxisd(T.linear()).angle() > kSame ||
        one[i].position_slack != other[i].position_slack ||
        one[i].rotation_slack != other[i].rotation_slack)
      return false;
  }
  return true;
}

void check_end(const Eigen::VectorXd* q, const char* name, const Robot& robot) {
  if (q == nullptr) return;
  check_configuration(*q, robot.dof(), name);
  for (Eigen::Index i = 0; i < q->size(); ++i) {
    const double beyond = std::max(robot.lower()[i] - (*q)[i], (*q)[i] - robot.upper()[i]);
    if (beyond > 1e-9)
      throw std::invalid_argument(std::string(name) + " has " + std::to_string((*q)[i]) + " for " +
                                  robot.joint_names()[static_cast<std::size_t>(i)] + ", " +
                                  std::to_string(beyond) + " beyond its limit");
  }
}

/// Whether joints that are given meet a station, whatever they touch.
void check_meets(const Eigen::VectorXd* q, const char* name, std::span<const Goal> goals,
                 std::size_t of, const Robot& robot, const Options& options) {
  if (q == nullptr) return;
  for (const Goal& goal : goals) {
    if (!has_place(goal) || has_slack(goal)) continue;
    const Eigen::Isometry3d T =
        robot.fk(*q, robot.tips()[static_cast<std::size_t>(goal.tip)]) * goal.T_tip_tool;
    const double off = (T.translation() - goal.T_base_tip.translation()).norm();
    if (off <= 2.0 * position_tolerance(goal, options)) continue;
    throw std::invalid_argument(std::string(name) + " does not meet " + station(of) +
                                ": the tool is " + std::to_string(1e3 * off) + " mm off");
  }
}

}  // namespace

void check_path(const PathRequest& request, const PathOptions& wanted, const Robot& robot,
                const Options& options) {
  check_method(options, "a path");
  check_positive(wanted.max_time, "max_time");
  check_positive(wanted.position_tolerance, "position_tolerance");
  check_positive(wanted.rotation_tolerance, "rotation_tolerance");
  check_positive(wanted.max_joint_step, "max_joint_step");
  check_positive(wanted.costs.room, "room");
  check_positive(wanted.costs.motion, "the cost of motion");
  check_cost(wanted.costs.limits, "limits");
  check_cost(wanted.costs.obstacles, "obstacles");
  check_cost(wanted.costs.singularities, "singularities");
  const std::size_t count = request.stations.size();
  if (count < 2)
    throw std::invalid_argument("a path has " + std::to_string(count) +
                                " stations, expected at least 2");
  if (request.closed && request.end != nullptr)
    throw std::invalid_argument("a closed path ends where it began, and needs no end");
  Request one;
  one.locks = request.locks;
  for (std::size_t k = 0; k < count; ++k) {
    one.goals = request.stations[k];
    try {
      check_request(one, robot, options);
    } catch (const std::invalid_argument& refused) {
      throw std::invalid_argument(station(k) + ": " + refused.what());
    }
    for (const Goal& goal : request.stations[k]) {
      if (goal.soft) throw std::invalid_argument(station(k) + " has a soft goal: a path has none");
    }
    if (k == 0) continue;
    if (!LaneSearch::are_alike(request.stations[k], request.stations[k - 1]))
      throw std::invalid_argument(station(k) + " asks another kind of thing than " +
                                  station(k - 1) + ": other tips, types, axes, tools or slacks");
    if (are_same(request.stations[k], request.stations[k - 1]))
      throw std::invalid_argument(station(k) + " is the same as " + station(k - 1) +
                                  ": leave one out");
  }
  if (request.closed && are_same(request.stations.front(), request.stations.back()))
    throw std::invalid_argument(
        "the last station is the same as the first: a closed path goes back to it by itself");
  check_end(request.start, "start", robot);
  check_end(request.end, "end", robot);
  check_meets(request.start, "start", request.stations.front(), 0, robot, options);
  check_meets(request.end, "end", request.stations.back(), count - 1, robot, options);
}

void check_motion(const MotionRequest& request, const MotionOptions& wanted, const Robot& robot,
                  const Options& options) {
  check_method(options, "a move");
  check_positive(wanted.max_time, "max_time");
  if (wanted.goal_count < 1)
    throw std::invalid_argument("goal_count is " + std::to_string(wanted.goal_count) +
                                ", expected at least 1");
  if (request.from == nullptr) throw std::invalid_argument("a move needs a start");
  check_configuration(*request.from, robot.dof(), "from");
  if ((request.to != nullptr) == !request.any_of.empty())
    throw std::invalid_argument("a move ends at a configuration or at goals, expected either");
  if (request.to != nullptr) check_configuration(*request.to, robot.dof(), "to");
  Request one;
  one.locks = request.locks;
  if (request.to != nullptr) return;
  one.any_of = request.any_of;
  check_request(one, robot, options);
}

}  // namespace pdoik::detail
