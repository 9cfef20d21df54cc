#include "detail/judge.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {

Judge::Judge(const Robot& robot, const Options& options, const HullModel& hulls)
    : robot_(robot),
      options_(options),
      hulls_(hulls),
      T_base_body_(robot.bodies().size()),
      collision_(hulls, hulls.moving),
      fixed_hulls_(hulls, hulls.fixed) {}

void Judge::pose_errors(const Eigen::Isometry3d& target, Result& result) const {
  const int tip = robot_.tips().front();
  const Eigen::Isometry3d T =
      T_base_body_[static_cast<std::size_t>(robot_.body_of_link(tip))] * robot_.T_body_link(tip);
  result.position_error = (T.translation() - target.translation()).norm();
  result.rotation_error = 0.0;
  if (options_.goal == GoalType::Pose) {
    const Eigen::Matrix3d R = target.linear().transpose() * T.linear();
    const Eigen::Vector3d twice_sine(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
    result.rotation_error = std::atan2(twice_sine.norm(), R.trace() - 1.0);
  } else if (options_.goal == GoalType::Axis) {
    const Eigen::Vector3d axis = options_.goal_axis.normalized();
    const Eigen::Vector3d is = T.linear() * axis, wanted = target.linear() * axis;
    result.rotation_error = std::atan2(is.cross(wanted).norm(), is.dot(wanted));
  }
}

void Judge::limits(const Eigen::VectorXd& q, Result& result, WorstConstraint& worst) const {
  worst = {WorstConstraint::Kind::Limit, -1, -1, -std::numeric_limits<double>::infinity()};
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double violation = std::max(robot_.lower()[i] - q[i], q[i] - robot_.upper()[i]);
    if (violation > worst.violation) {
      worst.index = static_cast<int>(i);
      worst.violation = violation;
    }
  }
  result.limit_violation = std::max(0.0, worst.violation);
}

void Judge::operator()(const Eigen::Isometry3d& target, const Eigen::VectorXd& q,
                       const Scene& scene, Result& result) {
  result.q = q;
  robot_.body_poses(q, T_base_body_);
  pose_errors(target, result);
  for (std::size_t k = 0; k < hulls_.points.size(); ++k) {
    const AttachedPoint& point = hulls_.points[k];
    collision_.place(
        k, to_vec4(T_base_body_[static_cast<std::size_t>(point.body)] * to_vector3(point.local)));
  }
  WorstConstraint& worst = result.worst;
  limits(q, result, worst);
  const Clearance least = scene.clearance(collision_, fixed_hulls_, result.limit_violation == 0.0);
  result.clearance =
      least.distance + options_.clearance;  // obstacle radii include the clearance wanted

  double worst_length = worst.violation;  // radians of the tip weigh as metres do in the search
  result.success = worst.violation <= 0.0;
  const auto compare = [&](WorstConstraint::Kind kind, double violation, int index, int obstacle) {
    result.success = result.success && violation <= 0.0;
    const double length =
        kind == WorstConstraint::Kind::Rotation ? options_.rotation_weight * violation : violation;
    if (length <= worst_length) return;
    worst = {kind, index, obstacle, violation};
    worst_length = length;
  };
  compare(WorstConstraint::Kind::Clearance, -least.distance - options_.clearance_tolerance,
          least.source, least.obstacle);
  compare(WorstConstraint::Kind::Position, result.position_error - options_.position_tolerance, -1,
          -1);
  if (options_.goal != GoalType::Position) {
    compare(WorstConstraint::Kind::Rotation, result.rotation_error - options_.rotation_tolerance,
            -1, -1);
  }
}

}  // namespace pdoik::detail
