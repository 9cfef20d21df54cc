#include <stdexcept>

#include "pdoik/robot.hpp"

namespace pdoik {

double Robot::total_mass() const {
  double mass = 0.0;
  for (const LinkDescription& link : parts_->links) mass += link.mass;
  return mass;
}

namespace {

/// What each body carries with all that hangs on it: its mass [kg] and mass times centre in the
/// base frame [kg m]. The base's is the whole robot's.
struct Load {
  double mass = 0.0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
};

std::vector<Load> loads(const Robot& robot, const std::vector<Eigen::Isometry3d>& T_base_body) {
  std::vector<Load> loads(robot.bodies().size());
  for (int k = 0; k < static_cast<int>(robot.links().size()); ++k) {
    const LinkDescription& link = robot.links()[static_cast<std::size_t>(k)];
    const auto b = static_cast<std::size_t>(robot.body_of_link(k));
    loads[b].mass += link.mass;
    loads[b].moment += link.mass * (T_base_body[b] * (robot.T_body_link(k) * link.center_of_mass));
  }
  for (std::size_t b = loads.size() - 1; b > 0; --b) {
    Load& parent = loads[static_cast<std::size_t>(robot.bodies()[b].parent)];
    parent.mass += loads[b].mass;
    parent.moment += loads[b].moment;
  }
  if (!(loads[0].mass > 0.0)) {
    throw std::invalid_argument("robot '" + robot.name() +
                                "' has no centre of mass: its links' masses sum up to " +
                                std::to_string(loads[0].mass) + " kg");
  }
  return loads;
}

}  // namespace

Eigen::Vector3d Robot::center_of_mass(VectorIn q) const {
  std::vector<Eigen::Isometry3d> T_base_body(parts_->bodies.size());
  body_poses(q, T_base_body);
  const Load whole = loads(*this, T_base_body).front();
  return whole.moment / whole.mass;
}

Eigen::Matrix3Xd Robot::center_of_mass_jacobian(VectorIn q) const {
  std::vector<Eigen::Isometry3d> T_base_body(parts_->bodies.size());
  body_poses(q, T_base_body);
  const std::vector<Load> carried = loads(*this, T_base_body);
  Eigen::Matrix3Xd J = Eigen::Matrix3Xd::Zero(3, dof());
  for (std::size_t b = 1; b < parts_->bodies.size(); ++b) {
    const Body& body = parts_->bodies[b];
    const Load& load = carried[b];
    const Eigen::Vector3d z = T_base_body[b].linear().col(2);
    const Eigen::Vector3d arm = load.moment - load.mass * T_base_body[b].translation();
    const Eigen::Vector3d speed = body.prismatic ? Eigen::Vector3d(load.mass * z) : z.cross(arm);
    J.col(body.dof) += body.multiplier / carried[0].mass * speed;
  }
  return J;
}

}  // namespace pdoik
