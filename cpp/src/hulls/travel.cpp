#include "hulls/travel.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/reach.hpp"

namespace pdoik::detail {
namespace {

/// Calls visit(body, arm) for each joint between a point and the base, arm a bound on the point's
/// distance from the joint's origin while joints are between `one` and `other`.
template <class Visit>
void for_each_arm(const Robot& robot, int body, double arm, const Eigen::VectorXd& one,
                  const Eigen::VectorXd& other, Visit&& visit) {
  for (int b = body; b > 0;) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(b)];
    visit(joint, arm);
    if (joint.prismatic) arm += farthest_slide(joint, one[joint.dof], other[joint.dof]);
    arm += joint.T_parent_joint.translation().norm();
    b = joint.parent;
  }
}

}  // namespace

namespace {

/// How far a point gets that is `local` from its body's joint when each joint makes up to a step.
double travel(const Robot& robot, int body, double local, const Eigen::VectorXd& step) {
  double sum = 0.0;
  for_each_arm(robot, body, local, robot.lower(), robot.upper(),
               [&](const Body& joint, double arm) {
                 if (joint.multiplier == 0.0) return;  // it follows nothing
                 const double moves = std::abs(joint.multiplier) * step[joint.dof];
                 // However far a point turns, it ends within two arms of where it was.
                 sum += joint.prismatic ? moves : arm > 0.0 ? std::min(moves, 2.0) * arm : 0.0;
               });
  return sum;
}

}  // namespace

double farthest_travel(const Robot& robot, const HullModel& hulls, const Eigen::VectorXd& step) {
  double farthest = 0.0;
  const auto visit = [&](int body, double local) {
    farthest = std::max(farthest, travel(robot, body, local, step));
  };
  for (const AttachedPoint& point : hulls.points)
    visit(point.body, std::sqrt(dot3(point.local, point.local)));
  for (const Hull& hull : hulls.moving) {
    if (hull.has_capsules()) hulls.for_each_arm(hull, visit);
  }
  return farthest;
}

double farthest_tip_travel(const Robot& robot, const Eigen::VectorXd& step) {
  double farthest = 0.0;
  for (const int tip : robot.tips()) {
    const double local = robot.T_body_link(tip).translation().norm();
    farthest = std::max(farthest, travel(robot, robot.body_of_link(tip), local, step));
  }
  return farthest;
}

void hull_displacement_bounds(const Robot& robot, const HullModel& hulls,
                              const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                              Eigen::VectorXd& displacement_bounds) {
  displacement_bounds.setZero(robot.dof());
  for (const Hull& hull : hulls.moving) {
    hulls.for_each_arm(hull, [&](int body, double local) {
      for_each_arm(robot, body, local, from, to, [&](const Body& joint, double) {
        double bound = 0.0;  // of all in the chain that follow the same
        for_each_arm(robot, body, local, from, to, [&](const Body& other, double arm) {
          if (other.dof != joint.dof) return;
          bound += std::abs(other.multiplier) * (other.prismatic ? 1.0 : arm);
        });
        displacement_bounds[joint.dof] = std::max(displacement_bounds[joint.dof], bound);
      });
    });
  }
}

double thinnest_hull(const Robot& robot, const HullModel& hulls) {
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(robot.mid_configuration(), T_base_body);
  const auto place = [&](int point) {
    const AttachedPoint& at = hulls.points[static_cast<std::size_t>(point)];
    return T_base_body[static_cast<std::size_t>(at.body)] * to_vector3(at.local);
  };
  double thinnest = std::numeric_limits<double>::infinity();
  for (const Hull& hull : hulls.moving) {
    for (int k = 0; k < 4 * hull.blocks; ++k) {
      const double radius = hulls.capsules(hull)[k / 4].radius[k % 4];
      if (radius > 0.0) thinnest = std::min(thinnest, radius);
    }
    if (hull.has_capsules()) continue;
    const double A = hull.semi_major,
                 minor2 = A * A - 0.25 * (place(hull.b) - place(hull.a)).squaredNorm();
    if (minor2 > 0.0) thinnest = std::min(thinnest, std::sqrt(minor2));
  }
  return thinnest;
}

}  // namespace pdoik::detail
