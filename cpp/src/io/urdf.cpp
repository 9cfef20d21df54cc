#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cctype>
#include <cmath>
#include <functional>
#include <mutex>

#include "io/xml_text.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/robot.hpp"

namespace pdoik {
namespace {

/// Collects what urdfdom prints, so that it reaches the user as part of the exception.
class MessageCollector : public console_bridge::OutputHandler {
 public:
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_WARN)
      messages_ += (messages_.empty() ? "" : "; ") + text;
  }
  const std::string& messages() const { return messages_; }

 private:
  std::string messages_;
};

constexpr double kUnlimited = 1e300;  // stands in for a limit that a file leaves out

bool has_attribute(const std::string& tag, const std::string& name) {
  for (std::size_t at = tag.find(name); at != std::string::npos; at = tag.find(name, at + 1)) {
    const std::size_t after = tag.find_first_not_of(" \t\r\n", at + name.size());
    if (std::isspace(static_cast<unsigned char>(tag[at - 1])) && after != std::string::npos &&
        tag[after] == '=')
      return true;
  }
  return false;
}

/// With velocity and effort limits where a file leaves them out, for which urdfdom refuses it.
std::string with_all_limits(const std::string& xml) {
  std::string result;
  std::size_t copied = 0;
  detail::for_each_tag(xml, [&](std::size_t at) {
    const std::size_t end = xml.find('>', at);
    constexpr std::size_t kName = 6;  // characters of "<limit"
    if (end == std::string::npos || xml.compare(at, kName, "<limit") != 0) return;
    const std::string tag = xml.substr(at, end - at);
    if (tag.size() > kName && tag[kName] != '/' &&
        !std::isspace(static_cast<unsigned char>(tag[kName])))
      return;
    result.append(xml, copied, at + kName - copied);
    copied = at + kName;
    for (const std::string name : {"velocity", "effort"})
      if (!has_attribute(tag, name)) result += " " + name + "=\"1e300\"";
  });
  return result.append(xml, copied);
}

urdf::ModelInterfaceSharedPtr parse(const std::string& xml, const std::string& source) {
  static std::mutex mutex;  // console_bridge has one handler for the whole process
  const std::lock_guard<std::mutex> lock(mutex);
  MessageCollector collector;
  console_bridge::OutputHandler* previous = console_bridge::getOutputHandler();
  console_bridge::useOutputHandler(&collector);
  urdf::ModelInterfaceSharedPtr model;
  std::string failure;
  try {
    model = urdf::parseURDF(xml);
  } catch (const std::exception& error) {
    failure = error.what();
  }
  console_bridge::useOutputHandler(previous);
  if (!model) {
    throw LoadError(source +
                    " is not a valid URDF: " + (failure.empty() ? collector.messages() : failure));
  }
  return model;
}

Eigen::Isometry3d to_isometry(const urdf::Pose& pose) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const Eigen::Quaterniond q(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z);
  T.linear() = q.normalized().toRotationMatrix();
  T.translation() << pose.position.x, pose.position.y, pose.position.z;
  return T;
}

LinkDescription convert(const urdf::Link& link) {
  LinkDescription result;
  result.name = link.name;
  if (!link.inertial) return result;
  const urdf::Inertial& inertial = *link.inertial;
  const Eigen::Isometry3d T_link_com = to_isometry(inertial.origin);
  Eigen::Matrix3d inertia;
  inertia << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
      inertial.ixz, inertial.iyz, inertial.izz;
  result.mass = inertial.mass;
  result.center_of_mass = T_link_com.translation();
  result.inertia = T_link_com.linear() * inertia * T_link_com.linear().transpose();
  return result;
}

JointType convert_type(const urdf::Joint& joint, const std::string& source) {
  switch (joint.type) {
    case urdf::Joint::REVOLUTE:
      return JointType::Revolute;
    case urdf::Joint::CONTINUOUS:
      return JointType::Continuous;
    case urdf::Joint::PRISMATIC:
      return JointType::Prismatic;
    case urdf::Joint::FIXED:
      return JointType::Fixed;
    default:
      throw LoadError(source + ": joint '" + joint.name +
                      "' is of a type that is not supported: expected revolute, continuous, "
                      "prismatic or fixed");
  }
}

JointDescription convert(const urdf::Joint& joint, const std::string& source) {
  JointDescription result;
  result.name = joint.name;
  result.type = convert_type(joint, source);
  result.parent_link = joint.parent_link_name;
  result.child_link = joint.child_link_name;
  result.T_parent_child = to_isometry(joint.parent_to_joint_origin_transform);
  result.axis << joint.axis.x, joint.axis.y, joint.axis.z;
  if (joint.limits) {
    if (result.type != JointType::Continuous) {
      result.lower = joint.limits->lower;
      result.upper = joint.limits->upper;
    }
    if (joint.limits->velocity != kUnlimited) result.velocity = joint.limits->velocity;
    if (joint.limits->effort != kUnlimited) result.effort = joint.limits->effort;
  }
  if (joint.mimic) {
    result.mimic = Mimic{joint.mimic->joint_name, joint.mimic->multiplier, joint.mimic->offset};
  }
  return result;
}

/// One line that names the joints of limited motion of which `what` holds; nothing if there is
/// none.
void warn_of_limits(RobotDescription& description, const std::string& what,
                    const std::function<bool(const JointDescription&)>& holds) {
  std::string names;
  for (const JointDescription& joint : description.joints) {
    if (joint.type != JointType::Fixed && joint.type != JointType::Continuous && holds(joint))
      names += (names.empty() ? "" : ", ") + joint.name;
  }
  if (!names.empty()) description.warnings.push_back(what + " at " + names);
}

void check_joint_count(const std::string& xml, const std::string& source) {
  constexpr int kMostJoints = 5000;
  int joints = 0;
  detail::for_each_tag(xml, [&](std::size_t at) { joints += xml.compare(at, 6, "<joint") == 0; });
  if (joints > kMostJoints)
    throw LoadError(source + " has more than " + std::to_string(kMostJoints) + " joints");
}

}  // namespace

RobotDescription load_urdf(const std::string& path_or_xml) {
  const auto [xml, source] = detail::read_xml(path_or_xml, "URDF");
  check_joint_count(xml, source);
  const urdf::ModelInterfaceSharedPtr model = parse(with_all_limits(xml), source);
  RobotDescription description;
  description.name = model->getName();
  for (const auto& [name, link] : model->links_) description.links.push_back(convert(*link));
  for (const auto& [name, joint] : model->joints_) {
    description.joints.push_back(convert(*joint, source));
  }
  warn_of_limits(description, "no velocity limit: taken as unlimited",
                 [](const auto& joint) { return std::isinf(joint.velocity); });
  warn_of_limits(description, "no effort limit: taken as unlimited",
                 [](const auto& joint) { return std::isinf(joint.effort); });
  warn_of_limits(
      description, "lower and upper limit are 0, as where URDF gives none: locked",
      [](const auto& joint) { return joint.lower == 0.0 && joint.upper == 0.0 && !joint.mimic; });
  return description;
}

Robot Robot::from_urdf(const std::string& path_or_xml, const std::string& base_link,
                       const std::vector<std::string>& tip_links) {
  return Robot(load_urdf(path_or_xml), base_link, tip_links);
}

}  // namespace pdoik
