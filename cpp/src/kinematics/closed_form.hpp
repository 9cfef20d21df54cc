#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// Six revolute joints in a row whose angles follow from a tip's pose by geometry: the last three
/// axes meet in a point and the second and third are parallel (most industrial arms), or the second
/// to the fourth are parallel and the last two meet (UR). Paden and Kahan's subproblems.
class ClosedForm {
 public:
  /// Of one of the robot's tips.
  ClosedForm(const Robot& robot, int tip);

  /// Whether its geometry is one of these, next to enough for what is found to be led to solutions.
  bool is_known() const { return kind_ != Kind::None; }
  /// Whether it is to rounding, so that no solution is missed.
  bool is_exact() const { return is_exact_; }
  /// At most eight branches for where the tip's link is, into `branches` with the other joints as
  /// at `start`, shape (n,): each inside the bounds and as near to it as whole turns bring it.
  void solve(const Eigen::Isometry3d& T_base_link, const Eigen::VectorXd& start,
             const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
             std::vector<Eigen::VectorXd>& branches) const;

 private:
  using Angles = std::array<double, 6>;
  enum class Kind { None, SphericalWrist, ThreeParallel };

  bool find_wrist();
  bool find_parallels();
  std::vector<Angles> by_wrist(const Eigen::Matrix3d& R, const Eigen::Vector3d& to_wrist) const;
  std::vector<Angles> by_parallels(const Eigen::Matrix3d& R, const Eigen::Vector3d& to_wrist) const;

  Kind kind_ = Kind::None;
  bool is_exact_ = false;
  std::array<int, 6> dof_{};
  /// Axes and a point on each, where all joints are at zero, in the base frame.
  std::array<Eigen::Vector3d, 6> axis_, at_;
  Eigen::Matrix3d R_link_;     ///< of the link there
  Eigen::Vector3d from_last_;  ///< from the last axis's point to the link's origin
};

}  // namespace pdoik::detail
