#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <random>

#include "peer.h"

namespace pdoik::bench {

class Stopwatch {
 public:
  explicit Stopwatch(double limit) : limit_(limit) {}
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool expired() const { return elapsed() >= limit_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  double limit_;
};

/// Local searches one after the other, the same for every peer: the first from the given start, the
/// rest from configurations drawn uniformly within the limits, until one succeeds or the time is
/// up.
class Restarts {
 public:
  Restarts(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper, const PeerSetup& setup)
      : lower_(lower), upper_(upper), max_time_(setup.max_time), q_(lower), engine_(setup.seed) {}

  /// @param prepare  void(), before the first start.
  /// @param attempt  bool(VectorXd& q, const Stopwatch&, PeerAnswer&), from q to an answer in q; it
  /// counts its iterations and evaluations.
  template <class Prepare, class Attempt>
  void run(const PeerProblem& problem, PeerAnswer& answer, Prepare&& prepare, Attempt&& attempt) {
    const Stopwatch watch(max_time_);
    prepare();
    answer.success = answer.iterations = answer.evaluations = 0;
    q_ = 0.5 * (lower_ + upper_);
    if (problem.q0 != nullptr) q_ = Eigen::Map<const Eigen::VectorXd>(problem.q0, q_.size());
    for (answer.restarts = 0;; ++answer.restarts) {
      const bool found = attempt(q_, watch, answer);
      answer.time = watch.elapsed();
      const bool late = answer.time >= max_time_;
      if (found || late) {
        answer.success = found && !late;
        Eigen::Map<Eigen::VectorXd>(answer.q, q_.size()) = q_;
        return;
      }
      for (Eigen::Index i = 0; i < q_.size(); ++i)
        q_[i] = lower_[i] + uniform_(engine_) * (upper_[i] - lower_[i]);
    }
  }

 private:
  Eigen::VectorXd lower_, upper_;
  double max_time_;
  Eigen::VectorXd q_;
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

/// Turn each joint by whole turns to inside its limits, where there is such a turn.
/// @returns whether all are inside.
inline bool wrap_into_limits(Eigen::VectorXd& q, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper) {
  constexpr double kTurn = 2.0 * M_PI;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (q[i] < lower[i]) q[i] += kTurn * std::ceil((lower[i] - q[i]) / kTurn);
    if (q[i] > upper[i]) q[i] -= kTurn * std::ceil((q[i] - upper[i]) / kTurn);
    if (!(q[i] >= lower[i] && q[i] <= upper[i])) return false;
  }
  return true;
}

}  // namespace pdoik::bench
