#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace pdoik {

/// The limited-memory BFGS minimiser.
struct LbfgsOptions {
  int memory = 10;           ///< pairs (s, y) kept, in [1, 1000]
  int max_iterations = 200;  ///< per minimisation, in [0, inf)
  int max_line_search = 20;  ///< trial steps per iteration, in [1, inf)
  /// Stop when the length of the gradient falls below this, in [0, inf].
  double gradient_tolerance = 1e-8;
  /// Stop when f falls by less than this share of it or of what it was before, in [0, inf].
  double relative_decrease = 1e-14;
  /// Length of the first step along the steepest descent where the gradient is longer, in (0, inf).
  double first_step = 1.0;
  /// Longest first trial of an iteration, in (0, inf].
  double max_step = std::numeric_limits<double>::infinity();
  double armijo = 1e-4;    ///< c1 of the Wolfe conditions, in (0, 1)
  double curvature = 0.9;  ///< c2 of the Wolfe conditions, in (armijo, 1)
};

/// Why a minimisation ended.
enum class LbfgsStatus {
  GradientSmall,     ///< the gradient tolerance is met
  DecreaseSmall,     ///< f no longer falls
  IterationLimit,    ///< max_iterations reached
  LineSearchFailed,  ///< no acceptable step along the steepest descent either
  Stopped,           ///< the caller's stop condition held (a deadline, say)
};

/// How a minimisation ended, and what it took.
struct LbfgsResult {
  LbfgsStatus status = LbfgsStatus::IterationLimit;  ///< why it ended
  double value = 0.0;                                ///< f at the point that is returned
  int iterations = 0;                                ///< steps taken
  int evaluations = 0;                               ///< of f and its gradient
};

/// Limited-memory BFGS (Nocedal and Wright, Numerical Optimization, Algorithms 7.4 and 7.5).
///
/// The direction comes from the two-loop recursion with initial scaling s.y / y.y. The step
/// satisfies the weak Wolfe conditions
///
///     f(x + t d) <= f(x) + c1 t g.d     and     g(x + t d).d >= c2 g.d,
///
/// found by bracketing and safeguarded cubic interpolation (Lewis and Overton's bracket, which also
/// copes with a kink). A pair enters the memory only when s.y > 1e-10 |s| |y|, so the matrix stays
/// positive definite. Knows nothing of robots. All memory is taken at construction; `minimize`
/// allocates nothing.
class Lbfgs {
 public:
  /// @param variables  Number of variables, at least 1.
  /// @throws std::invalid_argument naming the option that is out of range.
  explicit Lbfgs(Eigen::Index variables, const LbfgsOptions& options = {});

  /// Minimise from x, in place.
  /// @param evaluate  double(const VectorXd& x, VectorXd& gradient), f and its gradient at x.
  /// @param stop  bool(const VectorXd& x, double f), asked after every iteration; true ends the
  /// run. x holds the best point found whatever the status.
  /// @param cut  bool(), asked after every evaluation of a line search: true ends the run, and that
  /// evaluation is not used. For deadlines, where an iteration is too long to wait for.
  template <class Evaluate, class Stop, class Cut>
  LbfgsResult minimize(Evaluate&& evaluate, Eigen::VectorXd& x, Stop&& stop, Cut&& cut);
  /// The same without `cut`.
  template <class Evaluate, class Stop>
  LbfgsResult minimize(Evaluate&& evaluate, Eigen::VectorXd& x, Stop&& stop) {
    return minimize(evaluate, x, stop, [] { return false; });
  }
  /// The same to the end.
  template <class Evaluate>
  LbfgsResult minimize(Evaluate&& evaluate, Eigen::VectorXd& x) {
    return minimize(evaluate, x, [](const Eigen::VectorXd&, double) { return false; });
  }

  /// Those it was made with.
  const LbfgsOptions& options() const { return options_; }

 private:
  void reset() { stored_ = 0; }
  /// The full step once there is curvature, else one of length first_step; never beyond max_step.
  double first_trial() const {
    const double step = stored_ > 0 ? 1.0 : std::min(1.0, options_.first_step / g_.norm());
    return std::min(step, options_.max_step / d_.norm());
  }
  /// d <- -H g by the two-loop recursion.
  void direction();
  /// Keep (s, y) = (x_trial - x, g_trial - g) if its curvature is positive.
  void remember(const Eigen::VectorXd& x);
  enum class Search { Found, Failed, Cut };
  template <class Evaluate, class Cut>
  Search line_search(Evaluate& evaluate, const Eigen::VectorXd& x, double f, double first_step,
                     Cut& cut, LbfgsResult& result);

  LbfgsOptions options_;
  Eigen::MatrixXd S_, Y_;  // (n, memory), columns used as a ring
  Eigen::VectorXd inverse_sy_, alpha_;
  int stored_ = 0, next_ = 0;
  Eigen::VectorXd g_, d_, x_trial_, g_trial_;
  double f_trial_ = 0.0;
};

inline Lbfgs::Lbfgs(Eigen::Index variables, const LbfgsOptions& options) : options_(options) {
  if (variables < 1)
    throw std::invalid_argument("variables is " + std::to_string(variables) +
                                ", expected at least 1");
  if (options.memory < 1)
    throw std::invalid_argument("memory is " + std::to_string(options.memory) +
                                ", expected at least 1");
  if (!(0.0 < options.armijo && options.armijo < options.curvature && options.curvature < 1.0)) {
    throw std::invalid_argument("armijo and curvature must satisfy 0 < armijo < curvature < 1");
  }
  S_.setZero(variables, options.memory);
  Y_.setZero(variables, options.memory);
  inverse_sy_.setZero(options.memory);
  alpha_.setZero(options.memory);
  for (Eigen::VectorXd* v : {&g_, &d_, &x_trial_, &g_trial_}) v->setZero(variables);
}

inline void Lbfgs::direction() {
  d_ = -g_;
  if (stored_ == 0) return;
  const int m = options_.memory;
  for (int k = 1; k <= stored_; ++k) {
    const int i = (next_ - k + m) % m;
    alpha_[i] = inverse_sy_[i] * S_.col(i).dot(d_);
    d_ -= alpha_[i] * Y_.col(i);
  }
  const int newest = (next_ - 1 + m) % m;
  d_ *= 1.0 / (inverse_sy_[newest] * Y_.col(newest).squaredNorm());
  for (int k = stored_; k >= 1; --k) {
    const int i = (next_ - k + m) % m;
    d_ += (alpha_[i] - inverse_sy_[i] * Y_.col(i).dot(d_)) * S_.col(i);
  }
}

inline void Lbfgs::remember(const Eigen::VectorXd& x) {
  auto s = S_.col(next_);
  auto y = Y_.col(next_);
  s = x_trial_ - x;
  y = g_trial_ - g_;
  const double sy = s.dot(y);
  if (!(sy > 1e-10 * std::sqrt(s.squaredNorm() * y.squaredNorm()))) return;
  inverse_sy_[next_] = 1.0 / sy;
  next_ = (next_ + 1) % options_.memory;
  stored_ = std::min(stored_ + 1, options_.memory);
}

template <class Evaluate, class Cut>
Lbfgs::Search Lbfgs::line_search(Evaluate& evaluate, const Eigen::VectorXd& x, double f,
                                 double first_step, Cut& cut, LbfgsResult& result) {
  const double slope = g_.dot(d_);
  if (!(slope < 0.0)) return Search::Failed;
  double low = 0.0, f_low = f, slope_low = slope;
  double high = std::numeric_limits<double>::infinity(), f_high = 0.0, slope_high = 0.0;
  double t = first_step;
  for (int trial = 0; trial < options_.max_line_search; ++trial) {
    x_trial_.noalias() = x + t * d_;
    f_trial_ = evaluate(static_cast<const Eigen::VectorXd&>(x_trial_), g_trial_);
    ++result.evaluations;
    if (cut()) return Search::Cut;
    const double slope_t = g_trial_.dot(d_);
    if (!(f_trial_ <= f + options_.armijo * t * slope)) {  // also when f is not a number
      high = t, f_high = f_trial_, slope_high = slope_t;
    } else if (slope_t < options_.curvature * slope) {
      low = t, f_low = f_trial_, slope_low = slope_t;
    } else {
      return Search::Found;
    }
    if (std::isinf(high)) {
      t *= 2.0;
      continue;
    }
    // The cubic through both ends' values and slopes, kept inside the middle eight tenths of the
    // bracket.
    const double width = high - low;
    double step = 0.5;
    const double d1 = slope_low + slope_high - 3.0 * (f_high - f_low) / width;
    const double radicand = d1 * d1 - slope_low * slope_high;
    if (radicand >= 0.0) {
      const double d2 = std::sqrt(radicand);
      const double minimiser = 1.0 - (slope_high + d2 - d1) / (slope_high - slope_low + 2.0 * d2);
      if (std::isfinite(minimiser)) step = std::clamp(minimiser, 0.1, 0.9);
    }
    t = low + step * width;
  }
  // Out of trials: a point with enough decrease is taken even without the curvature condition.
  if (low == 0.0) return Search::Failed;
  x_trial_.noalias() = x + low * d_;
  f_trial_ = evaluate(static_cast<const Eigen::VectorXd&>(x_trial_), g_trial_);
  ++result.evaluations;
  if (cut()) return Search::Cut;
  return f_trial_ < f ? Search::Found : Search::Failed;
}

template <class Evaluate, class Stop, class Cut>
LbfgsResult Lbfgs::minimize(Evaluate&& evaluate, Eigen::VectorXd& x, Stop&& stop, Cut&& cut) {
  LbfgsResult result;
  reset();
  double f = evaluate(static_cast<const Eigen::VectorXd&>(x), g_);
  result.evaluations = 1;
  while (true) {
    result.value = f;
    if (stop(static_cast<const Eigen::VectorXd&>(x), f)) {
      result.status = LbfgsStatus::Stopped;
      return result;
    }
    if (g_.norm() < options_.gradient_tolerance) {
      result.status = LbfgsStatus::GradientSmall;
      return result;
    }
    if (result.iterations >= options_.max_iterations) {
      result.status = LbfgsStatus::IterationLimit;
      return result;
    }
    direction();
    const double first = first_trial();
    Search search = line_search(evaluate, x, f, first, cut, result);
    if (search == Search::Failed && stored_ > 0) {
      reset();  // forget the curvature and try the steepest descent once
      d_ = -g_;
      search = line_search(evaluate, x, f, first_trial(), cut, result);
    }
    if (search != Search::Found) {
      result.status = search == Search::Cut ? LbfgsStatus::Stopped : LbfgsStatus::LineSearchFailed;
      return result;
    }
    remember(x);
    const double decrease = f - f_trial_;
    x.swap(x_trial_);
    g_.swap(g_trial_);
    const double f_previous = f;
    f = f_trial_;
    ++result.iterations;
    if (decrease <= options_.relative_decrease * std::max(std::abs(f), std::abs(f_previous))) {
      result.value = f;
      result.status = stop(static_cast<const Eigen::VectorXd&>(x), f) ? LbfgsStatus::Stopped
                                                                      : LbfgsStatus::DecreaseSmall;
      return result;
    }
  }
}

}  // namespace pdoik
