#pragma once

#include <Eigen/Core>
#include <vector>

#include "pdoik/robot.hpp"

namespace pdoik {

/// The paper's change of variables (Sec. joint-limit): unbounded slack to joint positions inside
/// their limits.
///
/// A revolute joint of range k pi is cut into K = ceil(k - 1e-9) equal sub-angles theta_m in [0,
/// range/K], each described by the squared distance L_m = 1 - cos(theta_m) between two points at
/// distance 1/sqrt(2) from the axis, and L_m = L_max sigmoid(omega_m) with L_max = 1 - cos(range/K)
/// (Eqs. theta_im-limit, Lim-limit, squash1). The joint's angle is theta = theta_min + sum_m
/// arccos(1 - L_m) (Eq. recovery). Its cosine and sine come from the product of the complex numbers
/// (1 - L_m) + i sqrt(2 L_m - L_m^2), without any arccos. A prismatic joint is lower + range
/// sigmoid(omega); joints without limits are omega itself.
///
/// The paper gives each sub-angle its own omega_m. Those of one joint have the same derivative, so
/// a gradient method that starts them equal keeps them equal: they share one variable y = sqrt(K)
/// omega_m. The factor keeps lengths and inner products, so L-BFGS takes the same steps (up to
/// rounding) with M variables instead of M'.
class JointLimitMap {
 public:
  /// Values and derivatives at one omega; its vectors are sized by `make_state`.
  struct State {
    Eigen::VectorXd cosine;  ///< of each joint's angle, shape (n,); unused for prismatic joints
    Eigen::VectorXd sine;    ///< the same
    Eigen::VectorXd q;       ///< joint positions, shape (n,); angles only if asked for
    Eigen::VectorXd slope;   ///< d q / d slack, shape (n,)
  };

  /// What the variables are.
  enum class Variables {
    Slack,      ///< the paper's, from which limits hold
    Positions,  ///< the joint positions themselves, limits left to the caller: for comparison
  };

  /// Of a robot's joints.
  explicit JointLimitMap(const Robot& robot, Variables variables = Variables::Slack);

  /// The number of variables, one per joint.
  Eigen::Index size() const { return static_cast<Eigen::Index>(joints_.size()); }
  /// K, the sub-angles of a joint: 1 where it is no angle, or has no limits.
  int sub_angles(int joint) const { return joints_[static_cast<std::size_t>(joint)].sub_angles; }
  /// A state whose vectors have their sizes.
  State make_state() const;

  /// Cosines, sines (or prismatic positions) and slopes at omega, one per joint.
  ///
  ///     d theta_m / d omega_m = sqrt(L_max s) (1 - s) / sqrt(2 - L_max s),   s = sigmoid(omega_m),
  ///
  /// the composed derivative, which is finite everywhere. Allocates nothing.
  /// @param angles  Also recover q (needs an arcsine per sub-angle).
  void forward(const Eigen::VectorXd& omega, State& state, bool angles) const;

  /// Joint positions at omega, strictly inside the limits up to rounding, and never outside them.
  void positions(const Eigen::VectorXd& omega, Eigen::VectorXd& q) const;

  /// Gradient with respect to the slack from that with respect to q: dL/dy_i = dL/dq_i
  /// dq_i/dy_i.
  void pull_back(const State& state, const Eigen::VectorXd& dq, Eigen::VectorXd& domega) const;

  /// A slack that maps to q, an angle being split evenly over its sub-angles.
  /// @param q  Positions; those outside [lower + inset range, upper - inset range] are moved to its
  /// ends, because the map's derivative vanishes at the limits and a start there could not leave.
  /// @param inset  Fraction of the range, in [0, 0.5).
  void inverse(VectorIn q, Eigen::VectorXd& omega, double inset = 0.01) const;

 private:
  enum class Kind { Direct, Sigmoid, AngleSigmoid, Distance };
  struct Joint {
    Kind kind;
    int sub_angles;               // K
    double scale, inverse_scale;  // sqrt(K)
    double lower, upper;          // [rad] or [m]
    double sub_range;             // range / K
    double L_max;                 // of each sub-angle
    double cos_lower, sin_lower;
  };
  std::vector<Joint> joints_;
};

}  // namespace pdoik
