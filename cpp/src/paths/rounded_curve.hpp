#pragma once

#include <Eigen/Core>

#include "pdoik/timing.hpp"

namespace pdoik::detail {

/// A polyline with its corners rounded: its variation diminishing cubic spline,
///     C(s) = sum_i f(xi_i) B_i(s),    xi_i = (t_i+1 + t_i+2 + t_i+3) / 3
/// which reproduces straight lines and stays in the convex hull of what it takes from the polyline
/// f (de Boor, A Practical Guide to Splines, ch. XI). Knots t are halved where C is off by more
/// than is allowed. Ends are met exactly.
class RoundedCurve {
 public:
  using Rows = TimedMotion::Rows;

  /// @param rows       Corners, shape (m, n).
  /// @param s          Where they are, rising from 0, shape (m,).
  /// @param deviation  Largest |C - f| of a joint, positive.
  RoundedCurve(const Rows& rows, const Eigen::VectorXd& s, double deviation);

  /// Its derivative of an order, 0 to 2, at a place, shape (n,).
  void evaluate(double s, int order, Eigen::VectorXd& value) const;

  double length() const { return breaks_[breaks_.size() - 1]; }
  /// Where its cubic polynomials join, from 0 to its length.
  const Eigen::VectorXd& breaks() const { return breaks_; }
  /// Largest from the polyline, of a joint.
  double deviation() const { return deviation_; }

 private:
  void take_controls(const Rows& rows, const Eigen::VectorXd& s);
  double knot(Eigen::Index i) const;

  Eigen::VectorXd breaks_;
  Eigen::VectorXd start_;
  Eigen::MatrixXd controls_;  ///< less the start, (n, breaks + 2)
  double deviation_ = 0.0;
};

/// The polyline through rows, each at its s, at another place.
void along(const TimedMotion::Rows& rows, const Eigen::VectorXd& s, double place,
           Eigen::VectorXd& value);

/// The last of rising values that is not above another, or 0, and never the very last.
Eigen::Index cell_of(const Eigen::VectorXd& edges, double value);

}  // namespace pdoik::detail
