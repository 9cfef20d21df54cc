#include "common/quadratic_program.hpp"

#include <algorithm>
#include <limits>

namespace pdoik::detail {
namespace {

/// What is violated by less holds [units of the inequality].
constexpr double kHolds = 1e-12;
/// Of a normal's square, what must be left of it outside the others' span.
constexpr double kIndependent = 1e-16;
constexpr int kTurns = 20;  ///< at most, for each variable

}  // namespace

QuadraticProgram::QuadraticProgram(Eigen::Index n)
    : factor_(n), which_(static_cast<std::size_t>(n) + 1) {
  for (Eigen::MatrixXd* m : {&normals_, &basis_, &factor_of_normals_}) m->setZero(n, n + 1);
  for (Eigen::VectorXd* v : {&x_, &y_, &normal_, &kept_, &direction_}) v->setZero(n);
  for (Eigen::VectorXd* v : {&change_, &along_, &pull_}) v->setZero(n + 1);
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

void QuadraticProgram::split(int count) {
  direction_ = normal_;
  auto along = along_.head(count);
  along.setZero();
  // Twice: what is left is then square to the basis to rounding, however little it is.
  for (int pass = 0; pass < 2; ++pass) {
    for (int k = 0; k < count; ++k) {
      const double part = basis_.col(k).dot(direction_);
      along[k] += part;
      direction_ -= part * basis_.col(k);
    }
  }
}

void QuadraticProgram::add() {
  const double length = direction_.norm();
  normals_.col(active_) = normal_;
  basis_.col(active_) = direction_ / length;
  factor_of_normals_.col(active_).head(active_) = along_.head(active_);
  factor_of_normals_(active_, active_) = length;
}

void QuadraticProgram::drop(int at) {
  const int count = active_ - 1;
  for (int k = at; k < count; ++k) {
    pull_[k] = pull_[k + 1];
    which_[static_cast<std::size_t>(k)] = which_[static_cast<std::size_t>(k) + 1];
  }
  kept_ = normal_;
  for (active_ = at; active_ < count; ++active_) {
    normal_ = normals_.col(active_ + 1);
    split(active_);
    add();
  }
  normal_ = kept_;
}

bool QuadraticProgram::take_in(int which, double violation) {
  double pull = 0.0;
  while (true) {
    // By how much the active ones' pulls fall, and where y goes, as the new one pulls.
    split(active_);
    auto change = change_.head(active_);
    change = along_.head(active_);
    if (active_ > 0) {
      factor_of_normals_.topLeftCorner(active_, active_)
          .triangularView<Eigen::Upper>()
          .solveInPlace(change);
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
    if (!(go < kNever)) return false;  // what is asked contradicts itself, or is no number
    pull_.head(active_) -= go * change;
    pull += go;
    if (free) {
      y_ -= go * direction_;
      violation -= go * left;
    }
    if (reached <= released) {
      add();
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
