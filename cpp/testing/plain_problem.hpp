#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::testing {

/// Algorithms FWD and Jacobian as the paper prints them, its misprints corrected and nothing
/// clever: 4x4 matrix products, one unit per sub-angle, dL/dT_i propagated as 4x4 matrices, and a
/// square root for every pair of attached point and obstacle. No culling, no vector instructions by
/// hand.
///
/// It is a Problem of AugmentedLagrangian over the M' slack variables.
class PlainProblem {
 public:
  /// @throws std::invalid_argument unless the robot is a serial chain of revolute joints with
  /// limits.
  PlainProblem(const Robot& robot, const Options& options);

  void set_target(const Eigen::Isometry3d& T_base_tip) { T_target_ = T_base_tip.matrix(); }
  /// @param points  (N, 3), in the base frame [m].
  void set_obstacles(const Obstacles& points);

  /// M', the number of sub-angles.
  Eigen::Index size() const { return static_cast<Eigen::Index>(units_.size()); }

  double lagrangian(const Eigen::VectorXd& omega, const Penalty& penalty,
                    Eigen::VectorXd& gradient);
  double max_constraint(const Eigen::VectorXd& omega);
  void reset_multipliers() { mu_.setZero(); }
  void update_multipliers(const Eigen::VectorXd& omega, const Penalty& penalty);

  /// At the last evaluation.
  double last_max_constraint() const { return max_constraint_; }
  double position_error() const;  ///< [m]
  double rotation_error() const;  ///< [rad], of the axis for axis goals, 0 for position goals

  /// theta = theta_min + sum of arccos(1 - L_m) for each joint (Eq. recovery) [rad].
  void recover(const Eigen::VectorXd& omega, Eigen::VectorXd& q) const;
  /// The slack that maps to q, each joint's angle split evenly, at least `inset` of its range
  /// inside.
  void start_from(const Eigen::VectorXd& q, double inset, Eigen::VectorXd& omega) const;

 private:
  struct Unit {
    int joint;
    double L_max;           // of Eq. Lim-limit, with L_min = 0
    Eigen::Matrix4d fixed;  // what precedes the rotation by this sub-angle
  };
  struct AttachedPoint {
    int frame;
    Eigen::Vector4d local;  // homogeneous
  };
  struct Hull {
    int a, b;  // attached points; equal for a sphere
    double semi_major;
  };

  int attach(const Robot& robot, const std::string& link, const Eigen::Vector3d& xyz);
  void add_hulls(const Robot& robot);
  void roll_out(const Eigen::VectorXd& omega);
  void measure_distances();
  double constraint(const Hull& hull, Eigen::Index obstacle) const;
  double objective();
  double penalties(const Penalty& penalty);
  void push(int point, Eigen::Index obstacle, double slope);

  std::vector<Unit> units_;
  std::vector<int> last_frame_;  // of each body
  std::vector<AttachedPoint> points_;
  std::vector<Hull> hulls_;
  Eigen::VectorXd lower_;
  Eigen::Matrix4d T_last_tip_;
  std::vector<Eigen::Vector4d> tip_points_;  // U_e in the tip's frame
  GoalType goal_;
  Eigen::Vector3d goal_axis_;
  double clearance_;
  Eigen::Matrix4d T_target_ = Eigen::Matrix4d::Identity();

  std::vector<Eigen::Matrix4d> T_, T_step_, dT_domega_;  // T_i; from T_(i-1) to T_i; its derivative
  std::vector<Eigen::Matrix4d> dL_dT_;
  Eigen::Matrix4d T_tip_;
  Eigen::Matrix3Xd obstacles_;  // o_j
  Eigen::Matrix3Xd positions_;  // u_i
  Eigen::MatrixXd distances_;   // |u_i - o_j|, (points, N)
  Eigen::MatrixXd mu_;          // (hulls, N)
  double max_constraint_ = 0.0;
};

}  // namespace pdoik::testing
