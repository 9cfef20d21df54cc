#include "problem/start_table.hpp"

#include <cmath>

#include "kinematics/goal_of.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

StartTable::StartTable(const Model& model, int tip)
    : configurations_(model.robot.dof(), kRows), frames_(kRows, 13) {
  const Robot& robot = model.robot;
  const int link = robot.tips()[static_cast<std::size_t>(tip)];
  Eigen::VectorXd q(robot.dof());
  for (int k = 0; k < kRows; ++k) {
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      const double lower = robot.lower()[i], upper = robot.upper()[i];
      const bool bounded = std::isfinite(lower) && std::isfinite(upper);
      const double low = bounded ? lower : -M_PI, high = bounded ? upper : M_PI;
      q[i] = low + model.sequence(k + 1, i) * (high - low);
    }
    const Eigen::Isometry3d T = robot.fk(q, link);
    configurations_.col(k) = q;
    const Eigen::Matrix<double, 3, 4> frame = T.matrix().topRows<3>();
    for (int c = 0; c < 12; ++c) frames_(k, c) = static_cast<float>(frame(c % 3, c / 3));
    frames_(k, 12) = static_cast<float>(T.translation().squaredNorm());
  }
}

bool StartTable::knows(const Goal& goal) {
  if (!has_place(goal)) return false;
  if (goal.type == GoalType::Pose) return true;
  return goal.T_tip_tool.translation().isZero(0.0);
}

StartTable::Nearest StartTable::nearest(const Goal& goal, double rotation_weight) const {
  const double w2 = rotation_weight * rotation_weight;
  const bool is_pose = goal.type == GoalType::Pose;
  const Eigen::Isometry3d target =
      is_pose ? goal.T_base_tip * goal.T_tip_tool.inverse() : goal.T_base_tip;
  // |p - t|^2 + w^2 |R - T|^2 / 2, of an axis |R a - T a|^2: linear in the frame but for |p|^2.
  Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
  if (is_pose) turned = -w2 * target.linear();
  if (goal.type == GoalType::Axis) {
    const Eigen::Vector3d axis = goal.axis.normalized();
    turned = -2.0 * w2 * (target.linear() * axis) * (goal.T_tip_tool.linear() * axis).transpose();
  }
  Eigen::Matrix<float, 13, 1> slope;
  for (int c = 0; c < 9; ++c) slope[c] = static_cast<float>(turned(c % 3, c / 3));
  slope.segment<3>(9) = (-2.0 * target.translation()).cast<float>();
  slope[12] = 1.0F;
  Eigen::Matrix<float, kRows, 1> off;
  off.noalias() = frames_ * slope;
  Eigen::Index row = 0;
  const float least = off.minCoeff(&row);
  const double constant =
      target.translation().squaredNorm() + (is_pose                       ? 3.0
                                            : goal.type == GoalType::Axis ? 2.0
                                                                          : 0.0) *
                                               w2;
  return {static_cast<int>(row), least + static_cast<float>(constant)};
}

}  // namespace pdoik::detail
