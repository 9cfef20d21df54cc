#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "pdoik/robot.hpp"

/// Kinematics once more, straight from a description and without bodies, bases or indices.
namespace pdoik::testing {

inline const JointDescription* find_joint(const RobotDescription& description,
                                          const std::string& name) {
  for (const JointDescription& joint : description.joints) {
    if (joint.name == name) return &joint;
  }
  return nullptr;
}

/// A joint's position, through its leader if it follows one.
inline double joint_position(const RobotDescription& description, const JointDescription& joint,
                             const std::map<std::string, double>& positions) {
  if (!joint.mimic) return positions.at(joint.name);
  const JointDescription* leader = find_joint(description, joint.mimic->joint);
  return joint.mimic->multiplier * joint_position(description, *leader, positions) +
         joint.mimic->offset;
}

/// Pose of a link in the root's frame: the product of T_parent_child and the joints' motions.
inline Eigen::Isometry3d textbook_pose(const RobotDescription& description, const std::string& link,
                                       const std::map<std::string, double>& positions) {
  for (const JointDescription& joint : description.joints) {
    if (joint.child_link != link) continue;
    Eigen::Isometry3d T =
        textbook_pose(description, joint.parent_link, positions) * joint.T_parent_child;
    if (joint.type == JointType::Fixed) return T;
    const double position = joint_position(description, joint, positions);
    if (joint.type == JointType::Prismatic)
      return T * Eigen::Translation3d(position * joint.axis.normalized());
    return T * Eigen::AngleAxisd(position, joint.axis.normalized());
  }
  return Eigen::Isometry3d::Identity();
}

/// Joints that have an entry in q, depth first from a link, siblings by name.
inline void names_depth_first(const RobotDescription& description, const std::string& link,
                              const std::string& came_by, std::vector<std::string>& names) {
  std::vector<const JointDescription*> next;
  for (const JointDescription& joint : description.joints) {
    const bool touches = joint.parent_link == link || joint.child_link == link;
    if (touches && joint.name != came_by) next.push_back(&joint);
  }
  std::sort(next.begin(), next.end(),
            [](const auto* a, const auto* b) { return a->name < b->name; });
  for (const JointDescription* joint : next) {
    if (joint->type != JointType::Fixed && !joint->mimic) names.push_back(joint->name);
    const std::string& other = joint->parent_link == link ? joint->child_link : joint->parent_link;
    names_depth_first(description, other, joint->name, names);
  }
}

}  // namespace pdoik::testing
