#include "kinematics/closed_form.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

/// What is off by no more than this is as the geometry has it [rad] and [m], and what is by no more
/// than that is near enough to be led to a solution: a calibrated arm.
constexpr double kExact = 1e-7, kNear = 0.02;
/// A branch this far beyond a limit is none, but for rounding [rad].
constexpr double kOutside = 1e-6;
/// A cosine beyond 1 by this much counts as 1: at the edge of reach, where two branches are one.
constexpr double kEdge = 0.02;

Matrix turn(const Vector& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// The angle about an axis that takes one vector to another, as near as it can.
double angle_to(const Vector& axis, const Vector& from, const Vector& to) {
  return std::atan2(axis.dot(from.cross(to)), from.dot(to) - axis.dot(from) * axis.dot(to));
}

/// Angles for which a turned vector has a component along another: none, one or two.
struct UpToTwo {
  std::array<double, 2> angles{};
  int count = 0;
  const double* begin() const { return angles.data(); }
  const double* end() const { return angles.data() + count; }
};
UpToTwo component(const Vector& along, const Vector& axis, const Vector& turned, double wanted) {
  const double a = along.dot(turned) - along.dot(axis) * axis.dot(turned),
               b = along.dot(axis.cross(turned)), c = wanted - along.dot(axis) * axis.dot(turned),
               size = std::hypot(a, b);
  if (!(std::abs(c) <= (1.0 + kEdge) * size) || size == 0.0) return {};
  const double middle = std::atan2(b, a), half = std::acos(std::clamp(c / size, -1.0, 1.0));
  return {{middle - half, middle + half}, 2};
}

/// Where two lines are nearest to each other, in the middle of that, and how far apart they are.
/// @returns Whether they are not parallel.
bool meet(const Vector& p, const Vector& u, const Vector& q, const Vector& v, Vector& middle,
          double& apart) {
  const Vector normal = u.cross(v);
  const double square = normal.squaredNorm();
  if (square < 1e-6) return false;
  const Vector from = q - p;
  const Vector on_p = p + u * (from.cross(v).dot(normal) / square),
               on_q = q + v * (from.cross(u).dot(normal) / square);
  middle = 0.5 * (on_p + on_q);
  apart = (on_p - on_q).norm();
  return true;
}

}  // namespace

ClosedForm::ClosedForm(const Robot& robot, int tip) {
  const int link = robot.tips()[static_cast<std::size_t>(tip)];
  std::vector<int> chain;
  for (int b = robot.body_of_link(link); b > 0;
       b = robot.bodies()[static_cast<std::size_t>(b)].parent)
    chain.insert(chain.begin(), b);
  if (chain.size() != 6) return;
  // Other joints move nothing between the base and the tip.
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(Eigen::VectorXd::Zero(robot.dof()), T_base_body);
  for (std::size_t k = 0; k < 6; ++k) {
    const Body& body = robot.bodies()[static_cast<std::size_t>(chain[k])];
    if (body.prismatic || std::abs(body.multiplier) != 1.0) return;
    const Eigen::Isometry3d& T = T_base_body[static_cast<std::size_t>(chain[k])];
    dof_[k] = body.dof;
    axis_[k] = body.multiplier * T.linear().col(2);
    at_[k] = T.translation();
    for (std::size_t j = 0; j < k; ++j) {
      if (dof_[j] == dof_[k]) return;
    }
  }
  const Eigen::Isometry3d T_link =
      T_base_body[static_cast<std::size_t>(chain.back())] * robot.T_body_link(link);
  R_link_ = T_link.linear();
  if (!find_parallels() && !find_wrist()) return;
  from_last_ = T_link.translation() - at_[5];
}

bool ClosedForm::find_wrist() {
  Vector here, there;
  double apart = 0.0, aside = 0.0;
  if (!meet(at_[3], axis_[3], at_[4], axis_[4], here, apart) ||
      !meet(at_[4], axis_[4], at_[5], axis_[5], there, aside))
    return false;
  const double off =
      std::max({apart, aside, (here - there).norm(), axis_[1].cross(axis_[2]).norm()});
  if (off > kNear) return false;
  kind_ = Kind::SphericalWrist;
  is_exact_ = off <= kExact;
  at_[3] = at_[4] = at_[5] = here;
  return true;
}

bool ClosedForm::find_parallels() {
  Vector here;
  double apart = 0.0;
  if (!meet(at_[4], axis_[4], at_[5], axis_[5], here, apart)) return false;
  const double off =
      std::max({apart, axis_[1].cross(axis_[2]).norm(), axis_[1].cross(axis_[3]).norm()});
  if (off > kNear) return false;
  kind_ = Kind::ThreeParallel;
  is_exact_ = off <= kExact;
  at_[4] = at_[5] = here;
  return true;
}

// With R_k the turn about the k-th axis and p_k the way from the point on it to the one on the
// next: R = R_1 ... R_6, and from the first point to the wrist R_1 (p_1 + R_2 (p_2 + R_3 (p_3 +
// ...))).

std::vector<ClosedForm::Angles> ClosedForm::by_wrist(const Matrix& R,
                                                     const Vector& to_wrist) const {
  std::vector<Angles> all;
  const Vector p1 = at_[1] - at_[0], p2 = at_[2] - at_[1], p3 = at_[3] - at_[2];
  // Turns about the second and third axes leave the component along them.
  for (const double q1 : component(axis_[1], -axis_[0], to_wrist, axis_[1].dot(p1 + p2 + p3))) {
    const Vector v = turn(axis_[0], -q1) * to_wrist - p1;
    const double along = 0.5 * (v.squaredNorm() - p2.squaredNorm() - p3.squaredNorm());
    for (const double q3 : component(p2, axis_[2], p3, along)) {
      const double q2 = angle_to(axis_[1], p2 + turn(axis_[2], q3) * p3, v);
      const Matrix hand =
          (turn(axis_[0], q1) * turn(axis_[1], q2) * turn(axis_[2], q3)).transpose() * R;
      const double between = axis_[3].dot(hand * axis_[5]);
      for (const double q5 : component(axis_[3], axis_[4], axis_[5], between)) {
        const double q4 = angle_to(axis_[3], turn(axis_[4], q5) * axis_[5], hand * axis_[5]);
        const Matrix last = (turn(axis_[3], q4) * turn(axis_[4], q5)).transpose() * hand;
        const Vector across = axis_[5].unitOrthogonal();
        all.push_back({q1, q2, q3, q4, q5, angle_to(axis_[5], across, last * across)});
      }
    }
  }
  return all;
}

std::vector<ClosedForm::Angles> ClosedForm::by_parallels(const Matrix& R,
                                                         const Vector& to_wrist) const {
  std::vector<Angles> all;
  const Vector p1 = at_[1] - at_[0], p2 = at_[2] - at_[1], p3 = at_[3] - at_[2],
               p4 = at_[4] - at_[3];
  const double s3 = axis_[2].dot(axis_[1]) > 0.0 ? 1.0 : -1.0,
               s4 = axis_[3].dot(axis_[1]) > 0.0 ? 1.0 : -1.0;
  for (const double q1 :
       component(axis_[1], -axis_[0], to_wrist, axis_[1].dot(p1 + p2 + p3 + p4))) {
    const Matrix hand = turn(axis_[0], -q1) * R;
    for (const double q5 : component(axis_[1], axis_[4], axis_[5], axis_[1].dot(hand * axis_[5]))) {
      const Matrix bend = turn(axis_[4], q5);
      const double q6 =
          angle_to(axis_[5], hand.transpose() * axis_[1], bend.transpose() * axis_[1]);
      const Vector across = axis_[1].unitOrthogonal();
      const Matrix three = hand * (bend * turn(axis_[5], q6)).transpose();
      const double all_three = angle_to(axis_[1], across, three * across);
      const Vector v = turn(axis_[0], -q1) * to_wrist - p1 - turn(axis_[1], all_three) * p4;
      const double along = 0.5 * (v.squaredNorm() - p2.squaredNorm() - p3.squaredNorm());
      for (const double q3 : component(p2, axis_[2], p3, along)) {
        const double q2 = angle_to(axis_[1], p2 + turn(axis_[2], q3) * p3, v);
        all.push_back({q1, q2, q3, s4 * (all_three - q2 - s3 * q3), q5, q6});
      }
    }
  }
  return all;
}

void ClosedForm::solve(const Eigen::Isometry3d& T_base_link, const Eigen::VectorXd& start,
                       const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                       std::vector<Eigen::VectorXd>& branches) const {
  const Matrix R = T_base_link.linear() * R_link_.transpose();
  const Vector to_wrist = T_base_link.translation() - R * from_last_ - at_[0];
  const std::vector<Angles> all =
      kind_ == Kind::SphericalWrist ? by_wrist(R, to_wrist) : by_parallels(R, to_wrist);
  for (const Angles& angles : all) {
    Eigen::VectorXd q = start;
    bool inside = true;
    for (std::size_t k = 0; k < 6; ++k) {
      const Eigen::Index i = dof_[k];
      double near = start[i] + std::remainder(angles[k] - start[i], 2.0 * M_PI);
      if (near < lower[i] - kOutside) near += 2.0 * M_PI;
      if (near > upper[i] + kOutside) near -= 2.0 * M_PI;
      inside = inside && near >= lower[i] - kOutside && near <= upper[i] + kOutside;
      q[i] = std::clamp(near, lower[i], upper[i]);
    }
    if (inside) branches.push_back(std::move(q));
  }
}

}  // namespace pdoik::detail
