#include "pdoik/floating_base.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "common/check_input.hpp"
#include "common/text.hpp"

namespace pdoik {
namespace {

bool has_link(const RobotDescription& description, const std::string& name) {
  return std::any_of(description.links.begin(), description.links.end(),
                     [&](const LinkDescription& link) { return link.name == name; });
}

void check_base_link(const RobotDescription& description, const std::string& base_link) {
  if (has_link(description, base_link)) return;
  std::vector<std::string> names;
  for (const LinkDescription& link : description.links) names.push_back(link.name);
  throw std::invalid_argument("base_link '" + base_link + "' is not a link of '" +
                              description.name + "' (links: " + detail::join(names) + ")");
}

void add_link(RobotDescription& description, const std::string& name) {
  if (name.empty()) throw std::invalid_argument("world_link is empty, expected a name");
  if (has_link(description, name)) {
    throw std::invalid_argument("'" + description.name + "' already has a link '" + name +
                                "': a second one would have to be called otherwise (world_link)");
  }
  description.links.push_back({.name = name});
}

/// Put joints, given from the world's side, between a new link and base_link. A tree has one root,
/// so unless base_link is the root they hang on it the other way round: what is X Rot(axis, q) from
/// one side is Rot(-axis, q) X^-1 from the other. Here either X or the motion is the identity.
void add_chain(RobotDescription& description, const std::string& base_link,
               const std::string& world_link, std::vector<JointDescription> joints) {
  const bool is_root =
      std::none_of(description.joints.begin(), description.joints.end(),
                   [&](const JointDescription& joint) { return joint.child_link == base_link; });
  add_link(description, world_link);
  std::string nearer = world_link;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    JointDescription& joint = joints[k];
    for (const JointDescription& other : description.joints) {
      if (other.name != joint.name) continue;
      throw std::invalid_argument("'" + description.name + "' already has a joint '" + joint.name +
                                  "'");
    }
    const bool last = k + 1 == joints.size();
    const std::string farther = last ? base_link : joint.name + "_link";
    if (!last) add_link(description, farther);
    joint.parent_link = is_root ? nearer : farther;
    joint.child_link = is_root ? farther : nearer;
    if (!is_root) {
      joint.T_parent_child = joint.T_parent_child.inverse();
      joint.axis = -joint.axis;
    }
    description.joints.push_back(joint);
    nearer = farther;
  }
}

/// The names of q's entries, which are those of the joints.
constexpr std::array<const char*, 6> kNames{"base_x",   "base_y",     "base_z",
                                            "base_yaw", "base_pitch", "base_roll"};

void check_bounds(const FloatingBaseBounds& bounds) {
  for (int i = 0; i < 6; ++i) {
    const double lower = bounds.lower[i], upper = bounds.upper[i];
    const std::string what = std::string("bounds of ") + kNames[static_cast<std::size_t>(i)] +
                             " are [" + std::to_string(lower) + ", " + std::to_string(upper) + "]";
    if (!std::isfinite(lower) || !std::isfinite(upper))
      throw std::invalid_argument(what + ", expected finite ones");
    if (lower > upper) throw std::invalid_argument(what + ", expected the lower one first");
    if (i == 4 && !(lower > -0.5 * std::numbers::pi && upper < 0.5 * std::numbers::pi)) {
      throw std::invalid_argument(what +
                                  ", expected them within (-pi/2, pi/2): at its ends yaw and roll "
                                  "turn about the same axis");
    }
  }
}

}  // namespace

RobotDescription mounted(RobotDescription description, const std::string& base_link,
                         const Eigen::Isometry3d& T_world_base, const std::string& world_link) {
  check_base_link(description, base_link);
  detail::check_target(T_world_base, "T_world_base");
  JointDescription joint;
  joint.name = world_link + "_joint";
  joint.T_parent_child = T_world_base;
  add_chain(description, base_link, world_link, {joint});
  return description;
}

RobotDescription with_floating_base(RobotDescription description, const std::string& base_link,
                                    const FloatingBaseBounds& bounds,
                                    const std::string& world_link) {
  check_base_link(description, base_link);
  check_bounds(bounds);
  std::vector<JointDescription> joints;
  for (int i = 0; i < 6; ++i) {
    JointDescription joint;
    joint.name = kNames[static_cast<std::size_t>(i)];
    joint.type = i < 3 ? JointType::Prismatic : JointType::Revolute;
    joint.axis = Eigen::Vector3d::Unit(i < 3 ? i : 5 - i);
    joint.lower = bounds.lower[i];
    joint.upper = bounds.upper[i];
    joints.push_back(joint);
  }
  add_chain(description, base_link, world_link, std::move(joints));
  return description;
}

}  // namespace pdoik
