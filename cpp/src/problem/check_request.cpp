#include "problem/check_request.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/check_input.hpp"
#include "common/text.hpp"
#include "problem/check_options.hpp"

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

const char* link_of_tip(int tip, const Robot& robot) {
  const int link = robot.tips()[static_cast<std::size_t>(tip)];
  return robot.link_names()[static_cast<std::size_t>(link)].c_str();
}

void add_tips(const Robot& robot, InputError& error) {
  for (std::size_t k = 0; k < robot.tips().size(); ++k)
    error.add("%s%s", k == 0 ? "" : ", ", link_of_tip(static_cast<int>(k), robot));
}

/// What a goal is called in an error.
const char* name_of(const Goal& goal, const Robot& robot) {
  return goal.type == GoalType::CenterOfMass ? "the centre of mass" : link_of_tip(goal.tip, robot);
}

bool accepts_place(const Goal& goal, const Robot& robot, InputError& error) {
  const auto tips = static_cast<int>(robot.tips().size());
  if (goal.tip < 0 || goal.tip >= tips) {
    error.say("a goal's tip is %d, expected 0 to %d: ", goal.tip, tips - 1);
    add_tips(robot, error);
    return false;
  }
  const char* const link = link_of_tip(goal.tip, robot);
  if (goal.relative_to >= tips)
    return error.say(
        "the goal for '%s' is relative to tip %d, expected 0 to %d, or less for the base", link,
        goal.relative_to, tips - 1);
  if (goal.relative_to == goal.tip)
    return error.say("the goal for '%s' is relative to itself", link);
  if (!accepts_target(goal.T_base_tip, "T_base_tip", error)) {
    if (tips == 1) return false;
    InputError named;
    named.add("T_base_tip of the goal for '%s'%s", link, error.text() + sizeof("T_base_tip") - 1);
    error = named;
    return false;
  }
  if (!is_rigid(goal.T_tip_tool))
    return error.say("T_tip_tool of the goal for '%s' is not a rigid transform", link);
  return true;
}

bool accepts_numbers(const Goal& goal, const char* name, InputError& error) {
  const double length = goal.axis.norm();
  if (!(length > 1e-9) || !std::isfinite(length))
    return error.say("axis of the goal for '%s' has length %f, expected a direction", name, length);
  if (!(goal.weight > 0.0) || !std::isfinite(goal.weight))
    return error.say("weight of the goal for '%s' is %f, expected a positive finite number", name,
                     goal.weight);
  for (const auto& [what, tolerance] : {std::pair{"position_tolerance", goal.position_tolerance},
                                        std::pair{"rotation_tolerance", goal.rotation_tolerance}}) {
    if (!(tolerance >= 0.0) || !std::isfinite(tolerance))
      return error.say("%s of the goal for '%s' is %f, expected a finite number of at least 0",
                       what, name, tolerance);
  }
  const auto accepts_slack = [&](const char* what, const Eigen::Vector3d& slack,
                                 bool may_be_infinite) {
    const bool fine = (slack.array() >= 0.0).all() && (may_be_infinite || slack.allFinite());
    if (fine) return true;
    return error.say("%s of the goal for '%s' holds a number that is negative or %s", what, name,
                     may_be_infinite ? "none" : "not finite");
  };
  return accepts_slack("position_slack", goal.position_slack, true) &&
         accepts_slack("rotation_slack", goal.rotation_slack, false);
}

bool accepts_goal(const Goal& goal, const Robot& robot, bool by_least_squares, InputError& error) {
  if (!accepts_place(goal, robot, error)) return false;
  const char* const name = name_of(goal, robot);
  if (!accepts_numbers(goal, name, error)) return false;
  if (goal.type == GoalType::CenterOfMass) {
    double mass = 0.0;
    for (const LinkDescription& link : robot.links()) mass += link.mass;
    if (!(mass > 0.0) || !std::isfinite(mass))
      return error.say("there is a goal for the centre of mass, but the robot's links have none");
    if (goal.soft || goal.relative_to >= 0)
      return error.say("the goal for the centre of mass is soft or relative, expected neither");
    if (!goal.T_base_tip.linear().isIdentity(1e-12))
      return error.say(
          "the goal for the centre of mass is turned, expected a box along the base's axes");
  }
  const bool turns = goal.type == GoalType::Pose || goal.type == GoalType::Axis;
  if (goal.priority == Priority::Position && !turns)
    return error.say("the goal for '%s' has no orientation that could come second", name);
  const bool is_plain = goal.position_slack.isZero(0.0) && goal.rotation_slack.isZero(0.0);
  const char* const needs = "needs method 'default' with inner 'levenberg_marquardt'";
  if (by_least_squares) return true;
  if (!is_plain)
    return error.say("%s of the goal for '%s' %s",
                     goal.position_slack.isZero(0.0) ? "rotation_slack" : "position_slack", name,
                     needs);
  if (goal.soft || goal.priority != Priority::Both || goal.type == GoalType::LookAt ||
      goal.type == GoalType::CenterOfMass)
    return error.say("the goal for '%s' is soft, looks, is of mass or has a priority: it %s", name,
                     needs);
  return true;
}

/// Whether two goals ask what cannot be, wherever the robot is: for one point of it two places, or
/// for one link two orientations.
bool contradict(const Goal& one, const Goal& other, const Robot& robot, const Options& options,
                InputError& error) {
  const auto says_where = [](const Goal& goal) {
    return goal.type != GoalType::LookAt && goal.type != GoalType::CenterOfMass;
  };
  if (one.soft || other.soft || !says_where(one) || !says_where(other)) return false;
  Eigen::Isometry3d mine = one.T_base_tip, theirs = other.T_base_tip;
  const bool mirrored =
      one.relative_to >= 0 && one.tip == other.relative_to && other.tip == one.relative_to;
  if (mirrored) {  // each in the frame of the other
    if (!one.T_tip_tool.isApprox(Eigen::Isometry3d::Identity()) ||
        !other.T_tip_tool.isApprox(Eigen::Isometry3d::Identity()))
      return false;
    theirs = other.T_base_tip.inverse();
  } else if (one.tip != other.tip || one.relative_to != other.relative_to) {
    return false;
  }
  const char* const link = link_of_tip(one.tip, robot);
  const bool fixed = one.position_slack.isZero(0.0) && other.position_slack.isZero(0.0);
  const double apart = (mine.translation() - theirs.translation()).norm();
  const bool same_point =
      mirrored || (one.T_tip_tool.translation() - other.T_tip_tool.translation()).norm() < 1e-12;
  const double tolerance =
      std::max({options.position_tolerance, one.position_tolerance, other.position_tolerance});
  if (fixed && same_point && apart > 2.0 * tolerance)
    return !error.say("two goals for '%s' contradict each other: their positions are %g m apart",
                      link, apart);
  const bool both_pose = one.type == GoalType::Pose && other.type == GoalType::Pose &&
                         one.priority == Priority::Both && other.priority == Priority::Both &&
                         one.rotation_slack.isZero(0.0) && other.rotation_slack.isZero(0.0);
  if (!both_pose) return false;
  if (!mirrored) {
    mine = mine * one.T_tip_tool.inverse();
    theirs = theirs * other.T_tip_tool.inverse();
  }
  const double turned = Eigen::AngleAxisd(mine.linear().transpose() * theirs.linear()).angle();
  const double most =
      std::max({options.rotation_tolerance, one.rotation_tolerance, other.rotation_tolerance});
  if (turned > 2.0 * most + 1e-7)
    return !error.say(
        "two goals for '%s' contradict each other: their orientations are %g rad apart", link,
        turned);
  return false;
}

bool by_least_squares(const Options& options) {
  return options.method == Method::Default && options.inner == InnerMethod::LevenbergMarquardt;
}

}  // namespace

bool accepts_goals(std::span<const Goal> goals, const Robot& robot, const Options& options,
                   InputError& error) {
  error.clear();
  if (goals.empty()) {
    error.say("there is no goal, expected one for at least one tip of ");
    add_tips(robot, error);
    return false;
  }
  if (goals.size() > kMostGoals)
    return error.say("there are %zu goals, expected at most %zu", goals.size(), kMostGoals);
  for (std::size_t i = 0; i < goals.size(); ++i) {
    if (!accepts_goal(goals[i], robot, by_least_squares(options), error)) return false;
    for (std::size_t j = 0; j < i; ++j) {
      if (contradict(goals[j], goals[i], robot, options, error)) return false;
    }
  }
  return true;
}

void check_goals(std::span<const Goal> goals, const Robot& robot, const Options& options) {
  InputError error;
  accepts_goals(goals, robot, options, error);
  error.raise();
}

namespace {

void check_alternatives(const Request& request, const Robot& robot, const Options& options) {
  if (!request.goals.empty())
    throw std::invalid_argument("there are goals and lists of which any will do, expected either");
  if (options.method == Method::Paper) throw std::invalid_argument("any_of needs method 'default'");
  InputError error;
  for (std::size_t i = 0; i < request.any_of.size(); ++i) {
    if (accepts_goals(request.any_of[i], robot, options, error)) continue;
    throw std::invalid_argument("goal " + std::to_string(i) + " of " +
                                std::to_string(request.any_of.size()) + ": " + error.text());
  }
  if (!request.costs.empty() && request.costs.size() != request.any_of.size())
    throw std::invalid_argument("costs has " + std::to_string(request.costs.size()) +
                                " entries, expected " + std::to_string(request.any_of.size()));
  for (const double cost : request.costs) {
    if (std::isnan(cost)) throw std::invalid_argument("costs holds NaN");
  }
}

void check_locks(const Request& request, const Robot& robot, const Options& options) {
  if (request.locks.empty()) return;
  if (!by_least_squares(options))
    throw std::invalid_argument("locks need method 'default' with inner 'levenberg_marquardt'");
  for (const Lock& lock : request.locks) {
    if (lock.joint < 0 || lock.joint >= robot.dof())
      throw std::invalid_argument("the joint of a lock is " + std::to_string(lock.joint) +
                                  ", expected 0 to " + std::to_string(robot.dof() - 1));
    const std::string& name = robot.joint_names()[static_cast<std::size_t>(lock.joint)];
    if (!(lock.position >= robot.lower()[lock.joint] && lock.position <= robot.upper()[lock.joint]))
      throw std::invalid_argument("'" + name + "' is locked at " + std::to_string(lock.position) +
                                  ", outside its limits");
    if (!std::isfinite(lock.position))
      throw std::invalid_argument("'" + name + "' is locked at infinity");
    if (request.max_step == nullptr) continue;
    const double way = std::abs(lock.position - (*request.q0)[lock.joint]);
    if (way > (*request.max_step)[lock.joint] + 1e-12)
      throw std::invalid_argument("'" + name + "' is locked " + std::to_string(way) +
                                  " from q0, farther than max_step lets it");
  }
}

}  // namespace

void check_all(const Request& request, const AllOptions& wanted, const Options& options) {
  if (!request.any_of.empty())
    throw std::invalid_argument("all solutions are of goals, not of lists of which any will do");
  if (options.method == Method::Paper)
    throw std::invalid_argument("all solutions need method 'default'");
  if (wanted.limit < 0)
    throw std::invalid_argument("limit is " + std::to_string(wanted.limit) +
                                ", expected at least 0");
  if (!(wanted.distinct >= 0.0) || !std::isfinite(wanted.distinct))
    throw std::invalid_argument("distinct is " + std::to_string(wanted.distinct) +
                                ", expected a finite number of at least 0");
}

void check_request(const Request& request, const Robot& robot, const Options& options, int which) {
  std::string of;
  if (which >= 0) of.append("[").append(std::to_string(which)).append("]");
  if (request.any_of.empty())
    check_goals(request.goals, robot, options);
  else
    check_alternatives(request, robot, options);
  if (request.q0 != nullptr) check_configuration(*request.q0, robot.dof(), "q0" + of);
  if (request.posture != nullptr) {
    check_configuration(*request.posture, robot.dof(), "posture" + of);
    if (options.method == Method::Paper)
      throw std::invalid_argument("posture needs method 'default'");
  }
  if (request.max_step != nullptr) {
    if (request.q0 == nullptr) throw std::invalid_argument("max_step needs q0, to count from");
    if (!by_least_squares(options))
      throw std::invalid_argument(
          "max_step needs method 'default' with inner 'levenberg_marquardt'");
    check_step(*request.max_step, robot.dof(), "max_step" + of);
  }
  check_locks(request, robot, options);
}

}  // namespace pdoik::detail
