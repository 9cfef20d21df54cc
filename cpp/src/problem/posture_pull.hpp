#pragma once

#include <Eigen/Core>

namespace pdoik::detail {

/// What pulls each joint towards a posture: 1/2 sum over joints weight (q - q*)^2.
class PosturePull {
 public:
  /// Positions and weights [m^2/rad^2], both of shape (n,), kept by the caller; null for none.
  void set(const Eigen::VectorXd* positions, const Eigen::VectorXd* weights) {
    to_ = positions;
    weights_ = weights;
  }
  bool wanted() const { return to_ != nullptr; }

  /// At q, shape (n,).
  double value(const Eigen::VectorXd& q) const {
    double sum = 0.0;
    for (Eigen::Index i = 0; wanted() && i < q.size(); ++i) {
      const double off = q[i] - (*to_)[i];
      sum += (*weights_)[i] * off * off;
    }
    return 0.5 * sum;
  }
  /// Add its derivatives at q.
  void linearise(const Eigen::VectorXd& q, Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    for (Eigen::Index i = 0; wanted() && i < q.size(); ++i) {
      g[i] += (*weights_)[i] * (q[i] - (*to_)[i]);
      H(i, i) += (*weights_)[i];
    }
  }

 private:
  const Eigen::VectorXd *to_ = nullptr, *weights_ = nullptr;
};

}  // namespace pdoik::detail
