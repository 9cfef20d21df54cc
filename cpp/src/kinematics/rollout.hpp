#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/frame.hpp"
#include "pdoik/robot.hpp"
#include "simd/roll_out.hpp"

namespace pdoik::detail {

/// What moves each body, in the robot's order; the base first, which nothing does.
inline std::vector<RolloutJoint> rollout_joints(const Robot& robot) {
  std::vector<RolloutJoint> joints;
  for (const Body& body : robot.bodies()) {
    const bool slides = body.dof >= 0 && robot.joint_types()[static_cast<std::size_t>(body.dof)] ==
                                             JointType::Prismatic;
    const bool plain = body.multiplier == 1.0 && body.offset == 0.0 && slides == body.prismatic;
    joints.push_back({body.parent, body.dof, body.prismatic, plain, body.multiplier, body.offset,
                      to_frame(body.T_parent_joint)});
  }
  return joints;
}

/// Algorithms FWD (lines 1 to 7) and Jacobian (its second loop) for a tree of bodies.
///
/// Forward: T_i = T_parent(i) T_parent_joint Rz(theta_i), each from its parent's. Reverse: a force
/// f on a point u of body i, f = dL/du, is gathered as a wrench (f, u x f) at the base's origin and
/// handed from body to parent; a revolute joint reads dL/dtheta_i = z_i . (moment - p_i x force), a
/// prismatic one z_i . force. The 3x4 matrix dL/dT_i of the paper holds the same: its last column
/// is the force, and its entries reach dL/dtheta_i only through the moment sum_k column_k(T_i) x
/// column_k(dL/dT_i). Six numbers per body instead of twelve, and nothing is computed twice.
class Rollout {
 public:
  explicit Rollout(const Robot& robot)
      : joints_(rollout_joints(robot)), frames_(joints_.size()), wrenches_(joints_.size()) {
    for (const Joint& joint : joints_)
      needs_angles_ = needs_angles_ || (joint.dof >= 0 && !joint.plain);
    frames_[0] = to_frame(Eigen::Isometry3d::Identity());
  }

  /// Whether `forward` reads the angles of q as well as their cosines and sines (mimic joints do).
  bool needs_angles() const { return needs_angles_; }

  /// @param cosine, sine  of each joint's angle, shape (n,).
  /// @param q  positions, shape (n,): read for prismatic joints, and for all where needs_angles().
  void forward(const double* cosine, const double* sine, const double* q) {
    roll_out_(joints_.data(), static_cast<int>(joints_.size()), cosine, sine, q, frames_.data());
  }

  const Frame& frame(int body) const { return frames_[static_cast<std::size_t>(body)]; }

  void clear_wrenches() {
    for (Wrench& wrench : wrenches_) wrench = Wrench{};
  }
  /// Add dL/du = force of a point u (base frame) that moves with a body.
  void add_force(int body, const Vec4& u, const Vec4& force) {
    add_wrench(body, force, cross3(u, force));
  }
  void add_wrench(int body, const Vec4& force, const Vec4& moment) {
    Wrench& wrench = wrenches_[static_cast<std::size_t>(body)];
    wrench.force += force;
    wrench.moment += moment;
  }

  /// dL/dq from the wrenches gathered, shape (n,). Consumes them.
  void reverse(double* dq, int dof) {
    for (int i = 0; i < dof; ++i) dq[i] = 0.0;
    for (std::size_t b = joints_.size() - 1; b > 0; --b) {
      const Joint& joint = joints_[b];
      const Wrench& wrench = wrenches_[b];
      dq[joint.dof] +=
          joint.multiplier * generalised_force(joint, frames_[b], wrench.force, wrench.moment);
      Wrench& parent = wrenches_[static_cast<std::size_t>(joint.parent)];
      parent.force += wrench.force;
      parent.moment += wrench.moment;
    }
  }

  /// Add to row, shape (n,), what a wrench on one body asks of the joints between it and the base:
  /// J^T w.
  void add_row(int body, const Vec4& force, const Vec4& moment, double* row) const {
    for (int b = body; b > 0; b = joints_[static_cast<std::size_t>(b)].parent) {
      const Joint& joint = joints_[static_cast<std::size_t>(b)];
      row[joint.dof] += joint.multiplier * generalised_force(joint, frame(b), force, moment);
    }
  }

  /// The same for one joint: what a wrench on all that it carries asks of it.
  void add_joint_row(int body, const Vec4& force, const Vec4& moment, double* row) const {
    const Joint& joint = joints_[static_cast<std::size_t>(body)];
    row[joint.dof] += joint.multiplier * generalised_force(joint, frame(body), force, moment);
  }

  /// What moves a body that is not the base.
  const RolloutJoint& joint(int body) const { return joints_[static_cast<std::size_t>(body)]; }

  /// Calls visit(dof, multiplier, prismatic, frame) for each joint between a body and the base, or
  /// another that carries it.
  template <class Visit>
  void for_each_joint(int body, Visit&& visit, int carrier = 0) const {
    for (int b = body; b > carrier; b = joints_[static_cast<std::size_t>(b)].parent) {
      const Joint& joint = joints_[static_cast<std::size_t>(b)];
      visit(joint.dof, joint.multiplier, joint.prismatic, frame(b));
    }
  }

 private:
  using Joint = RolloutJoint;
  struct Wrench {
    Vec4 force{}, moment{};
  };

  static double generalised_force(const Joint& joint, const Frame& frame, const Vec4& force,
                                  const Vec4& moment) {
    return joint.prismatic ? dot3(frame.z, force) : dot3(frame.z, moment - cross3(frame.p, force));
  }

  std::vector<Joint> joints_;
  std::vector<Frame> frames_;
  std::vector<Wrench> wrenches_;
  bool needs_angles_ = false;
  RollOutFunction roll_out_ = best_roll_out();
};

}  // namespace pdoik::detail
