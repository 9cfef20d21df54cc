#pragma once

#include <memory>
#include <string>
#include <vector>

#include "workbench.hpp"

/// Random trees with masses, several tips, goals of all types, balance and self-collision.
namespace pdoik::testing {

inline constexpr RobotKind kTree{
    .joints = 9, .branches = true, .fixed = 0.15, .prismatic = 0.2, .mimic = 0.15};

/// A tree whose links weigh something, with two or three of its links as tips.
inline Robot random_tree(Random& random, int tips, const RobotKind& kind = kTree) {
  RobotDescription description = random_description(random, kind);
  for (LinkDescription& link : description.links) {
    link.mass = random.chance(0.2) ? 0.0 : random.uniform(0.1, 3.0);
    link.center_of_mass = random.point(0.2);
  }
  description.links.front().mass = 1.0;
  std::vector<std::string> links;
  for (int k = 0; k < tips; ++k)
    links.push_back(
        description.links[description.links.size() - 1 - 2 * static_cast<std::size_t>(k)].name);
  Robot robot(description, {}, links);
  robot.set_occupancy(random_occupancy(robot, random, 4, 6));
  return robot;
}

/// Contacts on two links, and a box about where the centre of mass is at `q`.
inline BalanceOptions random_balance(const Robot& robot, const Eigen::VectorXd& q, Random& random,
                                     bool tilted) {
  BalanceOptions balance;
  const Eigen::Vector3d com = robot.center_of_mass(q);
  for (int axis = 0; axis < 3; ++axis) {
    balance.com_lower[axis] = com[axis] + random.uniform(-0.1, 0.02);
    balance.com_upper[axis] = balance.com_lower[axis] + random.uniform(0.0, 0.1);
  }
  if (tilted) balance.up = random.direction();
  for (const std::string& link : {robot.link_names()[1], robot.link_names().back()}) {
    Contact contact{link, {}};
    for (int k = 0; k < 4; ++k) contact.points.push_back(random.point(0.15));
    balance.contacts.push_back(contact);
  }
  balance.support_margin = random.uniform(-0.02, 0.03);
  return balance;
}

/// A goal for each tip, reachable at a random configuration, with slack in every other one.
inline std::vector<Goal> random_goals(const Robot& robot, Random& random, bool slack) {
  std::vector<Goal> goals;
  const Eigen::VectorXd q = random_configuration(robot, random);
  for (int tip = 0; tip < static_cast<int>(robot.tips().size()); ++tip) {
    Goal goal;
    goal.tip = tip;
    goal.T_base_tip = robot.fk(q, robot.tips()[static_cast<std::size_t>(tip)]);
    goal.type = static_cast<GoalType>(random.integer(0, 2));
    goal.axis = random.direction();
    goal.weight = random.uniform(0.3, 3.0);
    if (slack && tip % 2 == 0) {
      goal.position_slack = random.point(0.2).cwiseAbs();
      goal.rotation_slack = random.point(0.8).cwiseAbs();
      goal.position_slack[random.integer(0, 2)] = 0.0;
    }
    goals.push_back(goal);
  }
  return goals;
}

/// The same goals, each but the first in the frame of the tip before.
inline std::vector<Goal> one_after_the_other(std::vector<Goal> goals) {
  for (std::size_t k = goals.size() - 1; k > 0; --k) {
    goals[k].relative_to = goals[k - 1].tip;
    goals[k].T_base_tip = goals[k - 1].T_base_tip.inverse() * goals[k].T_base_tip;
  }
  return goals;
}

}  // namespace pdoik::testing
