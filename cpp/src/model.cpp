#include "detail/model.hpp"

#include <algorithm>
#include <cmath>

#include "detail/travel.hpp"

namespace pdoik::detail {
namespace {

/// Hulls are taken for no wider than this, of usual arms [m].
constexpr double kWide = 0.02;
/// Hulls are taken for no thinner than this, of usual arms [m].
constexpr double kThin = 2e-4;

double narrowest_of(const Robot& robot, const HullModel& hulls) {
  const double size = relative_size(robot);
  return std::clamp(thinnest_hull(robot, hulls), kThin * size, kWide * size);
}

std::vector<bool> joints_that_matter(const Robot& robot, const HullModel& hulls, bool balance) {
  std::vector<bool> matters(static_cast<std::size_t>(robot.dof()), balance);
  const auto mark = [&](int body) {
    for (int b = body; b > 0; b = robot.bodies()[static_cast<std::size_t>(b)].parent) {
      matters[static_cast<std::size_t>(robot.bodies()[static_cast<std::size_t>(b)].dof)] = true;
    }
  };
  for (const int tip : robot.tips()) mark(robot.body_of_link(tip));
  for (const AttachedPoint& point : hulls.points) mark(point.body);
  for (const Hull& hull : hulls.moving) mark(hull.body);
  return matters;
}

std::vector<Model::Turn> turns_of(const Robot& robot) {
  std::vector<Model::Turn> turns;
  for (int i = 0; i < robot.dof(); ++i) {
    const bool endless = std::isinf(robot.lower()[i]) &&
                         robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Continuous;
    const bool turns_about =
        robot.joint_types()[static_cast<std::size_t>(i)] != JointType::Prismatic;
    const bool whole = turns_about && robot.upper()[i] - robot.lower()[i] >= 2.0 * M_PI;
    turns.push_back(endless ? Model::Turn::Wrap
                    : whole ? Model::Turn::Whole
                            : Model::Turn::Limited);
  }
  for (const Body& body : robot.bodies()) {
    if (body.dof < 0 || (!body.prismatic && body.multiplier == std::round(body.multiplier)))
      continue;
    Model::Turn& turn = turns[static_cast<std::size_t>(body.dof)];
    if (turn == Model::Turn::Wrap) turn = Model::Turn::Bound;
    if (turn == Model::Turn::Whole) turn = Model::Turn::Limited;
  }
  return turns;
}

int dimensions(GoalType goal) {
  return goal == GoalType::Pose ? 6 : goal == GoalType::Axis ? 5 : 3;
}

}  // namespace

Model::Model(const Robot& robot_in, const Options& options_in)
    : robot(robot_in),
      options(options_in.sized_for(robot)),
      hulls(robot, options.base_collision, options.forgive_overhang),
      matters(joints_that_matter(robot, hulls, options.balance.wanted())),
      turns(turns_of(robot)),
      sequence(robot.dof(), options.seed),
      narrowest(narrowest_of(robot, hulls)) {
  pull.setConstant(robot.dof(), options.posture_weight);
  if (options.joint_weights.size() > 0) pull = options.posture_weight * options.joint_weights;
  for (const int tip : robot.tips()) {
    tip_reach.push_back(
        reach_of(robot, robot.body_of_link(tip), robot.T_body_link(tip).translation().norm()));
  }
  hull_levers(robot, hulls, robot.lower(), robot.upper(), levers);
}

bool Model::is_out_of_reach(const Goal& goal) const {
  const Reach& reach = tip_reach[static_cast<std::size_t>(goal.tip)];
  const double slack =
      options.position_tolerance + 1e-9 * reach.distance + goal.position_slack.norm();
  return (goal.T_base_tip.translation() - reach.centre(robot)).norm() > reach.distance + slack;
}

void Model::wrap(const Eigen::VectorXd& start, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const Turn turn = turns[static_cast<std::size_t>(i)];
    if (turn == Turn::Bound) q[i] = std::clamp(q[i], start[i] - M_PI, start[i] + M_PI);
    if (turn == Turn::Wrap) q[i] = start[i] + std::remainder(q[i] - start[i], 2.0 * M_PI);
  }
}

void Model::unwind(const Eigen::VectorXd& wanted, const Eigen::VectorXd& lower,
                   const Eigen::VectorXd& upper, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (turns[static_cast<std::size_t>(i)] != Turn::Whole) continue;
    const double near = wanted[i] + std::remainder(q[i] - wanted[i], 2.0 * M_PI);
    for (const double other : {near, near - 2.0 * M_PI, near + 2.0 * M_PI}) {
      if (other < lower[i] || other > upper[i]) continue;
      if (std::abs(other - wanted[i]) < std::abs(q[i] - wanted[i])) q[i] = other;
    }
  }
}

bool Model::is_redundant(std::span<const Goal> goals) const {
  std::ptrdiff_t fixed = 0;
  for (const Goal& goal : goals) fixed += dimensions(goal.type);
  return std::count(matters.begin(), matters.end(), true) > fixed;
}

}  // namespace pdoik::detail
