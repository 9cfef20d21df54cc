#include "pdoik/robot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/check_input.hpp"
#include "common/text.hpp"
#include "kinematics/tree_builder.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/shape.hpp"

namespace pdoik {
namespace {

void check_configuration(VectorIn q, int dof) {
  if (q.size() != dof) {
    throw std::invalid_argument("q has " + std::to_string(q.size()) + " entries, the robot has " +
                                std::to_string(dof) + " joints");
  }
}

/// Of a link that has capsules, closed and convex.
void check_piece(const Robot& robot, const Occupancy& occupancy, std::size_t i) {
  const ConvexPiece& piece = occupancy.pieces[i];
  const std::string what = "pieces[" + std::to_string(i) + "] on '" + piece.link + "'";
  robot.link_index(piece.link);
  if (std::none_of(occupancy.capsules.begin(), occupancy.capsules.end(),
                   [&](const Capsule& capsule) { return capsule.link == piece.link; })) {
    throw std::invalid_argument(what +
                                ": the link has no capsules, which say where to look for it");
  }
  if (!(piece.tolerance >= 0.0 && piece.tolerance <= 1e6)) {
    throw std::invalid_argument(what + ": tolerance is " + std::to_string(piece.tolerance) +
                                ", expected a length of 0 to 1e6 m");
  }
  check_shape(
      Shape::convex_mesh(what, Eigen::Isometry3d::Identity(), piece.vertices, piece.triangles));
}

}  // namespace

Robot::Robot(const RobotDescription& description, const std::string& base_link,
             const std::vector<std::string>& tip_links) {
  detail::Tree tree = detail::build_tree(description, base_link);
  auto parts = std::make_shared<Parts>();
  parts->description = description;
  parts->name = description.name;
  parts->joint_names = std::move(tree.joint_names);
  parts->joint_types = std::move(tree.joint_types);
  parts->lower = std::move(tree.lower);
  parts->upper = std::move(tree.upper);
  parts->velocity = std::move(tree.velocity);
  parts->effort = std::move(tree.effort);
  parts->links = std::move(tree.links);
  parts->link_body = std::move(tree.link_body);
  parts->T_body_link = std::move(tree.T_body_link);
  parts->bodies = std::move(tree.bodies);
  parts->warnings = std::move(tree.warnings);
  for (const LinkDescription& link : parts->links) parts->link_names.push_back(link.name);
  parts_ = parts;
  std::vector<int> tips = std::move(tree.leaves);
  if (!tip_links.empty()) tips.clear();
  for (const std::string& tip : tip_links) {
    const std::optional<int> link = find_link(tip);
    if (!link) {
      throw LoadError("tip link '" + tip + "' is not a link of '" + name() +
                      "' (links: " + detail::join(link_names()) + ")");
    }
    if (std::find(tips.begin(), tips.end(), *link) != tips.end())
      throw LoadError("tip link '" + tip + "' is named twice");
    tips.push_back(*link);
  }
  parts->tips = std::move(tips);
}

Robot Robot::from_dh(const std::vector<DhRow>& rows, const Eigen::Isometry3d& T_last_tool) {
  if (rows.empty()) throw std::invalid_argument("rows is empty, expected one DH row per joint");
  RobotDescription description;
  description.name = "dh_arm";
  description.links.push_back({.name = "link0"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const DhRow& row = rows[i];
    const std::string number = std::to_string(i + 1);
    JointDescription joint;
    joint.name = "joint" + number;
    joint.parent_link = "link" + std::to_string(i);
    joint.child_link = "link" + number;
    joint.T_parent_child = Eigen::AngleAxisd(row.alpha, Eigen::Vector3d::UnitX()) *
                           Eigen::Translation3d(row.a, 0.0, 0.0) *
                           Eigen::AngleAxisd(row.theta_offset, Eigen::Vector3d::UnitZ()) *
                           Eigen::Translation3d(0.0, 0.0, row.d);
    joint.lower = row.lower;
    joint.upper = row.upper;
    const bool unlimited = std::isinf(row.lower) && std::isinf(row.upper);
    joint.type = row.prismatic ? JointType::Prismatic
                 : unlimited   ? JointType::Continuous
                               : JointType::Revolute;
    description.links.push_back({.name = joint.child_link});
    description.joints.push_back(std::move(joint));
  }
  JointDescription tool;
  tool.name = "tool_joint";
  tool.parent_link = description.links.back().name;
  tool.child_link = "tool";
  tool.T_parent_child = T_last_tool;
  description.links.push_back({.name = "tool"});
  description.joints.push_back(std::move(tool));
  return Robot(description, "link0", {"tool"});
}

std::vector<std::string> Robot::tip_links() const {
  std::vector<std::string> names;
  for (const int tip : parts_->tips)
    names.push_back(parts_->link_names[static_cast<std::size_t>(tip)]);
  return names;
}

Eigen::VectorXd Robot::mid_configuration() const {
  Eigen::VectorXd q(dof());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool low = std::isfinite(parts_->lower[i]), high = std::isfinite(parts_->upper[i]);
    q[i] = low && high ? 0.5 * (parts_->lower[i] + parts_->upper[i])
           : low       ? parts_->lower[i]
           : high      ? parts_->upper[i]
                       : 0.0;
  }
  return q;
}

std::optional<int> Robot::find_link(std::string_view name) const {
  const auto found = std::find(parts_->link_names.begin(), parts_->link_names.end(), name);
  if (found == parts_->link_names.end()) return std::nullopt;
  return static_cast<int>(found - parts_->link_names.begin());
}

int Robot::link_index(std::string_view name) const {
  const std::optional<int> link = find_link(name);
  if (!link) {
    throw std::invalid_argument("link '" + std::string(name) + "' is not a link of '" +
                                parts_->name + "' (links: " + detail::join(parts_->link_names) +
                                ")");
  }
  return *link;
}

namespace {

Eigen::Isometry3d joint_motion(const Body& body, VectorIn q) {
  const double position = body.multiplier * q[body.dof] + body.offset;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (body.prismatic) {
    motion.translation().z() = position;
  } else {
    motion.linear() = Eigen::AngleAxisd(position, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  }
  return motion;
}

int resolve_link(int link, const Robot& robot) {
  if (link < 0) {
    if (robot.tips().size() != 1) {
      throw std::invalid_argument("link is not given and the robot has " +
                                  std::to_string(robot.tips().size()) +
                                  " tips: " + detail::join(robot.tip_links()));
    }
    return robot.tips().front();
  }
  if (link >= static_cast<int>(robot.link_names().size())) {
    throw std::invalid_argument("link index " + std::to_string(link) +
                                " is out of range, the robot has " +
                                std::to_string(robot.link_names().size()) + " links");
  }
  return link;
}

}  // namespace

Eigen::Isometry3d Robot::fk(VectorIn q, int link) const {
  check_configuration(q, dof());
  link = resolve_link(link, *this);
  Eigen::Isometry3d T_body_tip = T_body_link(link);
  for (int b = body_of_link(link); b > 0;) {
    const Body& body = parts_->bodies[static_cast<std::size_t>(b)];
    T_body_tip = body.T_parent_joint * joint_motion(body, q) * T_body_tip;
    b = body.parent;
  }
  return T_body_tip;
}

void Robot::body_poses(VectorIn q, std::vector<Eigen::Isometry3d>& T_base_body) const {
  check_configuration(q, dof());
  if (T_base_body.size() != parts_->bodies.size()) T_base_body.resize(parts_->bodies.size());
  T_base_body[0].setIdentity();
  for (std::size_t b = 1; b < parts_->bodies.size(); ++b) {
    const Body& body = parts_->bodies[b];
    T_base_body[b] = T_base_body[static_cast<std::size_t>(body.parent)] * body.T_parent_joint *
                     joint_motion(body, q);
  }
}

Eigen::Matrix<double, 6, Eigen::Dynamic> Robot::jacobian(VectorIn q, int link) const {
  check_configuration(q, dof());
  link = resolve_link(link, *this);
  std::vector<int> path;  // from the base to the link
  for (int b = body_of_link(link); b > 0; b = parts_->bodies[static_cast<std::size_t>(b)].parent) {
    path.push_back(b);
  }
  std::reverse(path.begin(), path.end());
  const Eigen::Vector3d tip = fk(q, link).translation();
  Eigen::Matrix<double, 6, Eigen::Dynamic> J(6, dof());
  J.setZero();
  Eigen::Isometry3d T_base_body = Eigen::Isometry3d::Identity();
  for (const int b : path) {
    const Body& body = parts_->bodies[static_cast<std::size_t>(b)];
    T_base_body = T_base_body * body.T_parent_joint * joint_motion(body, q);
    const Eigen::Vector3d z = T_base_body.linear().col(2);
    if (body.prismatic) {
      J.col(body.dof).head<3>() += body.multiplier * z;
    } else {
      J.col(body.dof).head<3>() += body.multiplier * z.cross(tip - T_base_body.translation());
      J.col(body.dof).tail<3>() += body.multiplier * z;
    }
  }
  return J;
}

void Robot::set_ignored_pairs(std::vector<LinkPair> pairs) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (const std::string& link : {pairs[i].first, pairs[i].second}) {
      if (find_link(link)) continue;
      throw std::invalid_argument("pairs[" + std::to_string(i) + "]: link '" + link +
                                  "' is not a link of '" + parts_->name +
                                  "' (links: " + detail::join(parts_->link_names) + ")");
    }
  }
  auto parts = std::make_shared<Parts>(*parts_);
  parts->ignored_pairs = std::move(pairs);
  parts_ = std::move(parts);
}

void Robot::set_occupancy(Occupancy occupancy) {
  const auto check_point = [](const Eigen::Vector3d& point, const std::string& what) {
    if (!point.allFinite()) throw std::invalid_argument(what + " is not finite");
    if (point.cwiseAbs().maxCoeff() > detail::kLargestNumber)
      throw std::invalid_argument(what + " has a number beyond 1e6 m");
  };
  const auto is_size = [](double size) { return size > 0.0 && size <= detail::kLargestNumber; };
  for (std::size_t i = 0; i < occupancy.spheres.size(); ++i) {
    const Sphere& sphere = occupancy.spheres[i];
    const std::string what = "spheres[" + std::to_string(i) + "] on '" + sphere.link + "'";
    link_index(sphere.link);
    check_point(sphere.center, what + ": center");
    if (!is_size(sphere.radius)) {
      throw std::invalid_argument(what + ": radius is " + std::to_string(sphere.radius) +
                                  ", expected a positive length of at most 1e6 m");
    }
  }
  for (std::size_t i = 0; i < occupancy.spheroids.size(); ++i) {
    const Spheroid& s = occupancy.spheroids[i];
    const std::string what =
        "spheroids[" + std::to_string(i) + "] on '" + s.link_a + "', '" + s.link_b + "'";
    const int a = link_index(s.link_a), b = link_index(s.link_b);
    check_point(s.focus_a, what + ": focus_a");
    check_point(s.focus_b, what + ": focus_b");
    if (!is_size(s.semi_major)) {
      throw std::invalid_argument(what + ": semi_major is " + std::to_string(s.semi_major) +
                                  ", expected a positive length of at most 1e6 m");
    }
    if (body_of_link(a) != body_of_link(b)) continue;
    const double half = 0.5 * (T_body_link(a) * s.focus_a - T_body_link(b) * s.focus_b).norm();
    if (!(s.semi_major > half)) {
      throw std::invalid_argument(what + ": semi_major is " + std::to_string(s.semi_major) +
                                  ", expected more than half the distance between the foci, " +
                                  std::to_string(half));
    }
  }
  for (std::size_t i = 0; i < occupancy.capsules.size(); ++i) {
    const Capsule& capsule = occupancy.capsules[i];
    const std::string what = "capsules[" + std::to_string(i) + "] on '" + capsule.link + "'";
    link_index(capsule.link);
    check_point(capsule.a, what + ": a");
    check_point(capsule.b, what + ": b");
    if (!is_size(capsule.radius)) {
      throw std::invalid_argument(what + ": radius is " + std::to_string(capsule.radius) +
                                  ", expected a positive length of at most 1e6 m");
    }
    if (!(capsule.overhang >= 0.0 && capsule.overhang <= 1e6)) {
      throw std::invalid_argument(what + ": overhang is " + std::to_string(capsule.overhang) +
                                  ", expected a length of 0 to 1e6 m");
    }
  }
  for (std::size_t i = 0; i < occupancy.pieces.size(); ++i) check_piece(*this, occupancy, i);
  auto parts = std::make_shared<Parts>(*parts_);
  parts->occupancy = std::move(occupancy);
  parts_ = std::move(parts);
}

}  // namespace pdoik
