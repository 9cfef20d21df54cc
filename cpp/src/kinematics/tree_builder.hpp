#pragma once

#include <string>
#include <vector>

#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// A description turned into a tree of bodies from a chosen base: what Robot stores.
struct Tree {
  std::vector<LinkDescription> links;  // the base first, then depth first
  std::vector<int> link_body;
  std::vector<Eigen::Isometry3d> T_body_link;
  std::vector<int> leaves;
  std::vector<Body> bodies;
  std::vector<std::string> joint_names;
  std::vector<JointType> joint_types;
  Eigen::VectorXd lower, upper, velocity, effort;
  std::vector<std::string> warnings;
};

/// @throws LoadError as Robot's constructor.
Tree build_tree(const RobotDescription& description, const std::string& base_link);

}  // namespace pdoik::detail
