#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace pdoik {

/// The least-squares minimiser, Levenberg and Marquardt's method.
struct LevenbergMarquardtOptions {
  int max_iterations = 60;  ///< linearisations per run, in [0, inf)
  /// lambda, relative to the largest diagonal entry of the Hessian, in (0, inf).
  double first_damping = 0.3;
  double damping_decrease = 0.2;  ///< factor after a step that went as predicted, in (0, 1]
  double damping_increase = 5.0;  ///< factor after a rejected step, in (1, inf)
  double max_damping = 1e6;       ///< beyond it the run has stalled, in (0, inf)
  /// The run has stalled when `stall_window` steps leave more of f than this, in (0, inf].
  double stall_ratio = 0.95;
  int stall_window = 4;  ///< see `stall_ratio`, in [1, inf)
};

/// Why a minimisation ended.
enum class LevenbergMarquardtStatus {
  Done,            ///< the problem says so
  Stalled,         ///< f falls too slowly to go on: a local minimum, most likely
  IterationLimit,  ///< max_iterations reached
  Stopped,         ///< the caller's stop condition held
};

/// How a minimisation ended, and what it took.
struct LevenbergMarquardtResult {
  LevenbergMarquardtStatus status = LevenbergMarquardtStatus::IterationLimit;  ///< why it ended
  double value = 0.0;   ///< f at the point that is returned
  int iterations = 0;   ///< linearisations
  int evaluations = 0;  ///< of f
};

namespace detail {

/// Solve (H + lambda I) d = -g over the free variables, d = 0 elsewhere, by an L D L^T
/// factorisation. False if the matrix is not positive definite. `L` is scratch of H's size.
inline bool solve_damped(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, double lambda,
                         const std::vector<int>& free, int count, Eigen::MatrixXd& L,
                         Eigen::VectorXd& d) {
  const auto at = [&](int i) { return free[static_cast<std::size_t>(i)]; };
  const Eigen::Index stride = L.rows();
  double* const l = L.data();  // by columns, the lower triangle
  double y[64], inverse_pivot[64];
  for (int j = 0; j < count; ++j) {
    for (int i = j; i < count; ++i) l[j * stride + i] = H(at(j), at(i));
    l[j * stride + j] += lambda;
    y[j] = -g[at(j)];
  }
  // Each column is taken from those after it: many short independent updates, where sums of
  // products would wait for one another.
  for (int k = 0; k < count; ++k) {
    double* const column = l + k * stride;
    if (!(column[k] > 0.0)) return false;
    inverse_pivot[k] = 1.0 / column[k];
    for (int j = k + 1; j < count; ++j) {
      const double factor = column[j] * inverse_pivot[k];
      double* const later = l + j * stride;
      for (int i = j; i < count; ++i) later[i] -= factor * column[i];
      y[j] -= factor * y[k];
    }
  }
  d.setZero();
  for (int k = count - 1; k >= 0; --k) {
    double sum = y[k];
    for (int i = k + 1; i < count; ++i) sum -= l[k * stride + i] * y[i];
    y[k] = sum * inverse_pivot[k];
    d[at(k)] = y[k];
  }
  return true;
}

}  // namespace detail

/// Least squares inside a box by Levenberg and Marquardt's method with an active set.
///
/// At x, variables at a bound whose gradient pushes outwards are held; the rest move by
/// (H + lambda I) d = -g with the Gauss-Newton Hessian H, the step is clamped to the box, and
/// lambda falls when f does and grows when it does not. Knows nothing of robots. At most 64
/// variables. All memory is taken at construction.
class LevenbergMarquardt {
 public:
  /// @throws std::invalid_argument unless 1 <= variables <= 64.
  explicit LevenbergMarquardt(Eigen::Index variables,
                              const LevenbergMarquardtOptions& options = {});

  /// Minimise from x, in place. A Problem provides
  ///
  ///     double evaluate(const VectorXd& x);         // f at x; the following calls speak of this x
  ///     bool done() const;                          // x is good enough
  ///     void linearise(MatrixXd& H, VectorXd& g);   // upper triangle of J^T J, and J^T r
  ///
  /// @param stop  bool(), asked before every iteration.
  template <class Problem, class Stop>
  LevenbergMarquardtResult minimize(Problem& problem, Eigen::VectorXd& x,
                                    const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                    Stop&& stop);

  /// Those it was made with.
  const LevenbergMarquardtOptions& options() const { return options_; }

 private:
  int find_free(const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                const Eigen::VectorXd& upper);

  LevenbergMarquardtOptions options_;
  Eigen::MatrixXd H_, L_;
  Eigen::VectorXd g_, d_, trial_;
  std::vector<int> free_;
};

inline LevenbergMarquardt::LevenbergMarquardt(Eigen::Index variables,
                                              const LevenbergMarquardtOptions& options)
    : options_(options), free_(static_cast<std::size_t>(std::max<Eigen::Index>(variables, 1))) {
  if (variables < 1 || variables > 64) {
    throw std::invalid_argument("variables is " + std::to_string(variables) + ", expected 1 to 64");
  }
  H_.setZero(variables, variables);
  L_.setZero(variables, variables);
  for (Eigen::VectorXd* v : {&g_, &d_, &trial_}) v->setZero(variables);
}

inline int LevenbergMarquardt::find_free(const Eigen::VectorXd& x, const Eigen::VectorXd& lower,
                                         const Eigen::VectorXd& upper) {
  int count = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool held = (x[i] <= lower[i] && g_[i] >= 0.0) || (x[i] >= upper[i] && g_[i] <= 0.0);
    if (!held) free_[static_cast<std::size_t>(count++)] = static_cast<int>(i);
  }
  return count;
}

template <class Problem, class Stop>
LevenbergMarquardtResult LevenbergMarquardt::minimize(Problem& problem, Eigen::VectorXd& x,
                                                      const Eigen::VectorXd& lower,
                                                      const Eigen::VectorXd& upper, Stop&& stop) {
  LevenbergMarquardtResult result;
  x = x.cwiseMax(lower).cwiseMin(upper);
  double f = problem.evaluate(x);
  result.evaluations = 1;
  double lambda = -1.0, reference = f;
  int since_reference = 0;
  while (true) {
    result.value = f;
    if (problem.done()) {
      result.status = LevenbergMarquardtStatus::Done;
      return result;
    }
    if (result.iterations >= options_.max_iterations) {
      result.status = LevenbergMarquardtStatus::IterationLimit;
      return result;
    }
    problem.linearise(H_, g_);
    ++result.iterations;
    const double scale = H_.diagonal().maxCoeff();
    // No variable moves any residual, or one does beyond all numbers.
    if (!(scale > 0.0) || !std::isfinite(scale)) {
      result.status = LevenbergMarquardtStatus::Stalled;
      return result;
    }
    if (lambda < 0.0) lambda = options_.first_damping * scale;
    const int free_count = find_free(x, lower, upper);
    while (true) {
      if (stop()) {
        result.status = LevenbergMarquardtStatus::Stopped;
        return result;
      }
      if (free_count == 0 || lambda > options_.max_damping * scale) {
        result.status = LevenbergMarquardtStatus::Stalled;
        return result;
      }
      // Where numbers overflow, more damping may still give a step.
      if (detail::solve_damped(H_, g_, lambda, free_, free_count, L_, d_) && d_.allFinite()) {
        trial_ = (x + d_).cwiseMax(lower).cwiseMin(upper);
        const double f_trial = problem.evaluate(trial_);
        ++result.evaluations;
        if (f_trial < f) {
          x.swap(trial_);
          f = f_trial;
          lambda = std::max(lambda * options_.damping_decrease, 1e-12 * scale);
          break;
        }
      }
      lambda = std::max(lambda * options_.damping_increase, 1e-9 * scale);
    }
    if (++since_reference >= options_.stall_window) {
      if (f > options_.stall_ratio * reference && !problem.done()) {
        result.value = f;
        result.status = LevenbergMarquardtStatus::Stalled;
        return result;
      }
      reference = f;
      since_reference = 0;
    }
  }
}

}  // namespace pdoik
