#include "problem/model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "hulls/travel.hpp"
#include "kinematics/goal_of.hpp"

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

/// How many degrees of freedom a goal fixes: those that it gives no slack.
/// @param whole  Whether what comes second of it counts as well.
std::ptrdiff_t dimensions(const Goal& goal, bool whole) {
  if (goal.soft) return 0;
  const auto fixed = [](const Eigen::Vector3d& slack) { return (slack.array() == 0.0).count(); };
  const std::ptrdiff_t position = goal.type == GoalType::LookAt ? 0 : fixed(goal.position_slack);
  if (goal.priority == Priority::Position && !whole) return position;
  switch (goal.type) {
    case GoalType::Pose:
      return position + fixed(goal.rotation_slack);
    case GoalType::Axis:
    case GoalType::LookAt:
      return position + (goal.rotation_slack.isZero(0.0) ? 2 : 0);
    case GoalType::Position:
    case GoalType::CenterOfMass:
      return position;
  }
  return position;
}

HullModel whole_of(const Robot& robot, const Options& options, const HullModel& hulls) {
  if (!options.keeps_off_itself(robot)) return {};
  return options.base_collision ? hulls : HullModel(robot, true, hulls.pieces);
}

}  // namespace

Model::Model(const Robot& robot_in, const Options& options_in)
    : robot(robot_in),
      options(options_in.sized_for(robot)),
      hulls(robot, options.base_collision,
            options.exact_contact ? std::make_shared<LinkPieces>(robot)
                                  : std::make_shared<LinkPieces>()),
      whole(whole_of(robot, options, hulls)),
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
  for (std::size_t k = 0; k < robot.tips().size(); ++k)
    closed_forms.emplace_back(robot, static_cast<int>(k));
  hull_displacement_bounds(robot, hulls, robot.lower(), robot.upper(), displacement_bounds);
}

const StartTable& Model::starts_for(int tip) const {
  const std::lock_guard lock(start_tables_mutex_);
  start_tables_.resize(robot.tips().size());
  std::unique_ptr<StartTable>& table = start_tables_[static_cast<std::size_t>(tip)];
  if (table == nullptr) table = std::make_unique<StartTable>(*this, tip);
  return *table;
}

double Model::beyond_reach(const Goal& goal) const {
  if (!has_place(goal)) return 0.0;
  const Reach& reach = tip_reach[static_cast<std::size_t>(goal.tip)];
  const double slack =
      position_tolerance(goal, options) + 1e-9 * reach.distance + goal.position_slack.norm();
  // A tool reaches as far from its link as it is long.
  const double most = reach.distance + goal.T_tip_tool.translation().norm() + slack;
  return std::max(0.0, (goal.T_base_tip.translation() - reach.centre(robot)).norm() - most);
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
  for (const Goal& goal : goals) fixed += dimensions(goal, false);
  return std::count(matters.begin(), matters.end(), true) > fixed;
}

bool Model::has_joints_for(std::span<const Goal> goals) const {
  return std::ranges::all_of(goals, [this](const Goal& goal) {
    if (goal.type == GoalType::CenterOfMass) return true;
    const int link = robot.tips()[static_cast<std::size_t>(goal.tip)];
    return static_cast<std::ptrdiff_t>(joints_of(robot.body_of_link(link))) >=
           dimensions(goal, true);
  });
}

int Model::joints_of(int body) const {
  std::uint64_t dofs = 0;
  for (int b = body; b > 0; b = robot.bodies()[static_cast<std::size_t>(b)].parent)
    dofs |= std::uint64_t{1} << robot.bodies()[static_cast<std::size_t>(b)].dof;
  return std::popcount(dofs);
}

}  // namespace pdoik::detail
