#pragma once

#include <Eigen/Geometry>
#include <optional>

namespace pdoik::testing {

/// (f(x + h e_i) - f(x - h e_i)) / 2h for each i.
template <class Function>
Eigen::VectorXd central_gradient(Function&& f, Eigen::VectorXd x, double h) {
  Eigen::VectorXd gradient(x.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double middle = x[i];
    x[i] = middle + h;
    const double above = f(x);
    x[i] = middle - h;
    gradient[i] = (above - f(x)) / (2.0 * h);
    x[i] = middle;
  }
  return gradient;
}

/// The same for a function with kinks: nothing where two steps say different things.
template <class Function>
std::optional<Eigen::VectorXd> smooth_gradient(Function&& f, const Eigen::VectorXd& x) {
  const Eigen::VectorXd one = central_gradient(f, x, 1e-6), two = central_gradient(f, x, 1e-5);
  if ((one - two).cwiseAbs().maxCoeff() > 1e-4) return std::nullopt;
  return one;
}

/// The vector a of the antisymmetric part [a]x of M.
inline Eigen::Vector3d vee(const Eigen::Matrix3d& M) {
  return 0.5 * Eigen::Vector3d(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));
}

/// T moved by a small motion of everything about the base's origin: rotation vector w, then
/// translation v.
inline Eigen::Isometry3d moved(const Eigen::Isometry3d& T, const Eigen::Vector3d& w,
                               const Eigen::Vector3d& v) {
  const double angle = w.norm();
  const Eigen::Vector3d axis = angle > 0.0 ? Eigen::Vector3d(w / angle) : Eigen::Vector3d::UnitX();
  return Eigen::Translation3d(v) * Eigen::AngleAxisd(angle, axis) * T;
}

/// Largest difference between entries of two transforms.
inline double gap(const Eigen::Isometry3d& A, const Eigen::Isometry3d& B) {
  return (A.matrix() - B.matrix()).cwiseAbs().maxCoeff();
}

/// How far the 3x3 part is from a rotation.
inline double rigidity_gap(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

}  // namespace pdoik::testing
