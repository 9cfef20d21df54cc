#pragma once

#include <cmath>

namespace pdoik::testing {

/// The fewest successes among n that a guard should let pass where each has the chance p: fewer
/// come less than once in a thousand times by luck (the 0.1 % quantile of the binomial
/// distribution).
inline int fewest_by_luck(int n, double p) {
  double log_term = n * std::log1p(-p), below = 0.0;  // of P(X = 0)
  for (int k = 0; k < n; ++k) {
    below += std::exp(log_term);
    if (below >= 1e-3) return k;
    log_term += std::log(static_cast<double>(n - k) / (k + 1.0)) + std::log(p) - std::log1p(-p);
  }
  return n;
}

}  // namespace pdoik::testing
