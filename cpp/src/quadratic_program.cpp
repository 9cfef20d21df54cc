#include "detail/quadratic_program.hpp"

#include <algorithm>
#include <limits>

namespace pdoik::detail {
namespace {

/// What is violated by less holds [units of the inequality].
constexpr double kHolds = 1e-12;
/// Of a normal's square, what must be left of it outside the others' span.
constexpr double kIndependent = 1e-12;
constexpr int kTurns = 20;  ///< at most, for each variable

}  // namespace

QuadraticProgram::QuadraticProgram(Eigen::Index n)
    : factor_(n), which_(static_cast<std::size_t>(n) + 1) {
  normals_.setZero(n, n + 1);
  gram_.setZero(n + 1, n + 1);
  factored_.setZero(n + 1, n + 1);
  for (Eigen::VectorXd* v : {&x_, &y_, &normal_, &direction_}) v->setZero(n);
  for (Eigen::VectorXd* v : {&change_, &pull_}) v->setZero(n + 1);
}

bool QuadraticProgram::factorise(const Eigen::MatrixXd& H) {
  factor_.compute(H);
  return factor_.info() == Eigen::Success;
}

double QuadraticProgram::worst(const Inequalities& within, int& which) const {
  double most = 0.0;
  const auto consider = [&](double violation, int index) {
    if (violation <= most) return;
    most = violation;
    which = index;
  };
  const int n = static_cast<int>(x_.size());
  for (int i = 0; i < within.count; ++i) consider(within.rows.col(i).dot(x_) - within.most[i], i);
  for (int i = 0; i < n; ++i) {
    consider(within.lower[i] - x_[i], within.count + i);
    consider(x_[i] - within.upper[i], within.count + n + i);
  }
  return most;
}

void QuadraticProgram::set_normal(const Inequalities& within, int which) {
  const int n = static_cast<int>(x_.size()), side = which - within.count;
  if (side < 0) {
    normal_ = within.rows.col(which);
  } else {
    normal_.setZero();
    normal_[side % n] = side < n ? -1.0 : 1.0;
  }
  factor_.matrixL().solveInPlace(normal_);
}

void QuadraticProgram::drop(int at) {
  for (int k = at; k + 1 < active_; ++k) {
    normals_.col(k) = normals_.col(k + 1);
    pull_[k] = pull_[k + 1];
    which_[static_cast<std::size_t>(k)] = which_[static_cast<std::size_t>(k) + 1];
    for (int i = 0; i <= k; ++i) gram_(k, i) = gram_(k + 1, i < at ? i : i + 1);
  }
  --active_;
}

bool QuadraticProgram::take_in(int which, double violation) {
  double pull = 0.0;
  while (true) {
    // By how much the active ones' pulls fall, and where y goes, as the new one pulls.
    auto change = change_.head(active_);
    direction_ = normal_;
    if (active_ > 0) {
      auto factor = factored_.topLeftCorner(active_, active_);
      factor = gram_.topLeftCorner(active_, active_);
      for (int k = 0; k < active_; ++k) change[k] = normals_.col(k).dot(normal_);
      Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(factor).solveInPlace(change);
      for (int k = 0; k < active_; ++k) direction_ -= change[k] * normals_.col(k);
    }
    const double left = direction_.squaredNorm();
    const bool free = active_ < x_.size() && left > kIndependent * normal_.squaredNorm();
    constexpr double kNever = std::numeric_limits<double>::infinity();
    double reached = free ? violation / left : kNever, released = kNever;
    int first = -1;
    for (int k = 0; k < active_; ++k) {
      if (change[k] <= 0.0 || pull_[k] >= released * change[k]) continue;
      released = pull_[k] / change[k];
      first = k;
    }
    const double go = std::min(reached, released);
    if (go == kNever) return false;  // what is asked contradicts itself
    pull_.head(active_) -= go * change;
    pull += go;
    if (free) {
      y_ -= go * direction_;
      violation -= go * left;
    }
    if (reached <= released) {
      normals_.col(active_) = normal_;
      for (int k = 0; k < active_; ++k) gram_(active_, k) = normals_.col(k).dot(normal_);
      gram_(active_, active_) = normal_.squaredNorm();
      pull_[active_] = pull;
      which_[static_cast<std::size_t>(active_++)] = which;
      return true;
    }
    drop(first);
  }
}

bool QuadraticProgram::solve(const Eigen::VectorXd& g, const Inequalities& within,
                             Eigen::VectorXd& x) {
  active_ = 0;
  y_ = -g;
  factor_.matrixL().solveInPlace(y_);
  for (int turn = 0; turn < kTurns * static_cast<int>(x_.size()); ++turn) {
    x_ = y_;
    factor_.matrixU().solveInPlace(x_);
    int which = -1;
    const double violation = worst(within, which);
    if (violation <= kHolds) {
      x = x_;
      return true;
    }
    const auto end = which_.begin() + active_;
    if (std::find(which_.begin(), end, which) != end) break;  // rounding: it is there already
    set_normal(within, which);
    if (!take_in(which, violation)) return false;
  }
  x = x_;
  int which = -1;
  return worst(within, which) <= 1e3 * kHolds;
}

}  // namespace pdoik::detail
