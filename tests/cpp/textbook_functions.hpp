#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>

#include "pdoik/lbfgs.hpp"
#include "random_robots.hpp"

/// Functions from the textbooks to minimise, with their gradients.
namespace pdoik::testing {

/// f(x) = 1/2 (x - x*).A (x - x*) with eigenvalues of A from 1 to `condition`: 0 at its minimum, so
/// that rounding of f does not hide the end of the descent.
struct Quadratic {
  Quadratic(Random& random, int n, double condition) : solution(random.vector(n, -1.0, 1.0)) {
    const Eigen::MatrixXd any =
        Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.uniform(-1.0, 1.0); });
    const Eigen::MatrixXd Q = Eigen::HouseholderQR<Eigen::MatrixXd>(any).householderQ();
    Eigen::VectorXd values(n);
    for (int i = 0; i < n; ++i)
      values[i] = std::pow(condition, n > 1 ? static_cast<double>(i) / (n - 1) : 0.0);
    A = Q * values.asDiagonal() * Q.transpose();
  }
  double operator()(const Eigen::VectorXd& x, Eigen::VectorXd& g) const {
    g = A * (x - solution);
    return 0.5 * (x - solution).dot(g);
  }
  Eigen::MatrixXd A;
  Eigen::VectorXd solution;
};

/// The extended Rosenbrock function, pair by pair; its minimum is at (1, ..., 1).
inline double rosenbrock(const Eigen::VectorXd& x, Eigen::VectorXd& g) {
  double f = 0.0;
  g.setZero(x.size());
  for (Eigen::Index i = 0; i + 1 < x.size(); i += 2) {
    const double r = x[i + 1] - x[i] * x[i], s = 1.0 - x[i];
    f += 100.0 * r * r + s * s;
    g[i] += -400.0 * x[i] * r - 2.0 * s;
    g[i + 1] += 200.0 * r;
  }
  return f;
}

/// Goes on until nothing is left to gain.
inline LbfgsOptions thorough() {
  LbfgsOptions options;
  options.max_iterations = 5000;
  options.relative_decrease = 0.0;
  return options;
}

}  // namespace pdoik::testing
