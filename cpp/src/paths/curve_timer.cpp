#include "paths/curve_timer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace pdoik::detail {
namespace {

constexpr double kLeastRate = 1e-9;  ///< of what moves to its limit, at turning points
/// Cells of each of the curve's polynomials, of all of it, and until it is at full speed.
constexpr int kCells = 8, kLeastCells = 200, kPerRamp = 8;
constexpr double kLeastCell = 1e-9;  ///< of all of it
constexpr double kGrade = 4.0;       ///< the largest ratio of a cell to the next
constexpr int kRegions = 100;     ///< besides the curve's polynomials: where limits may be smaller
constexpr int kTries = 10;        ///< with limits that are smaller by what was measured
constexpr double kExcess = 1e-4;  ///< of time, which is left to slowing all of it
/// Moments of each step at which the outcome is measured.
constexpr double kMoments[] = {0.01, 0.25, 0.5, 0.75, 0.99};
constexpr std::array<double, 4> kPowers{1.0, 2.0, 1.0, 1.0};  ///< of slowness, of each limit

/// Edges in order with more between them, so that no cell is so many times the next.
Eigen::VectorXd graded(std::vector<double> edges, double ratio) {
  std::ranges::sort(edges);
  const double least = 1e-11 * edges.back(), end = edges.back();
  std::vector<double> kept{0.0};
  for (const double edge : edges) {
    if (edge > kept.back() + least) kept.push_back(edge);
  }
  kept.back() = end;
  for (bool is_even = false; !is_even;) {
    is_even = true;
    std::vector<double> finer;
    for (std::size_t k = 0; k + 1 < kept.size(); ++k) {
      finer.push_back(kept[k]);
      const double cell = kept[k + 1] - kept[k];
      const double before = k > 0 ? kept[k] - kept[k - 1] : cell,
                   after = k + 2 < kept.size() ? kept[k + 2] - kept[k + 1] : cell;
      if (cell > ratio * before) finer.push_back(kept[k] + 2.0 * before);
      if (cell > ratio * after) finer.push_back(kept[k + 1] - 2.0 * after);
      is_even = is_even && cell <= ratio * std::min(before, after);
    }
    finer.push_back(kept.back());
    std::ranges::sort(finer);
    finer.erase(std::unique(finer.begin(), finer.end()), finer.end());
    kept = std::move(finer);
  }
  return Eigen::Map<Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size()));
}

}  // namespace

CurveTimer::CurveTimer(const Robot& robot, const RoundedCurve& curve, const TimingLimits& limits)
    : robot_(robot), curve_(curve), limits_(limits) {
  std::vector<double> edges(curve.breaks().begin(), curve.breaks().end());
  for (int k = 0; k <= kRegions; ++k) edges.push_back(curve.length() * k / kRegions);
  regions_ = graded(std::move(edges), std::numeric_limits<double>::infinity());
  shares_.assign(static_cast<std::size_t>(regions_.size()) - 1, {1.0, 1.0, 1.0, 1.0});
  for (int round = 0; round < kTries; ++round) {
    find_motion();
    const std::vector<Shares> used = measure();
    if (slowness_ <= 1.0 + kExcess) break;
    for (std::size_t k = 0; k < used.size(); ++k) {
      for (std::size_t i = 0; i < used[k].size(); ++i) shares_[k][i] /= used[k][i];
    }
  }
  time_ *= slowness_;
}

void CurveTimer::state(double t, double& s, Eigen::VectorXd& q, Eigen::VectorXd& dq,
                       Eigen::VectorXd& ddq) {
  const Eigen::Index k = cell_of(time_, t);
  const double width = time_[k + 1] - time_[k], in = std::clamp(t - time_[k], 0.0, width);
  const double first = std::sqrt(x_[k]) / slowness_, last = std::sqrt(x_[k + 1]) / slowness_;
  const double change = (last - first) / width, rate = first + change * in;
  s = std::min(s_[k] + (first + 0.5 * change * in) * in, s_[k + 1]);
  curve_.evaluate(s, 0, q);
  curve_.evaluate(s, 1, q1_);
  curve_.evaluate(s, 2, q2_);
  dq = rate * q1_;
  ddq = rate * rate * q2_ + change * q1_;
}

const CurveTimer::Shares& CurveTimer::share(double s) const {
  return shares_[static_cast<std::size_t>(cell_of(regions_, s))];
}

CurveTimer::Shares CurveTimer::least_share(double s) const {
  const double little = 1e-12 * curve_.length();
  Shares least = share(s - little);
  for (std::size_t i = 0; i < least.size(); ++i)
    least[i] = std::min(least[i], share(s + little)[i]);
  return least;
}

bool CurveTimer::has_tool() const {
  return std::isfinite(limits_.tool_speed) || std::isfinite(limits_.tool_turn);
}

Eigen::Vector2d CurveTimer::tool_rates(const Eigen::VectorXd& q, const Eigen::VectorXd& dq) const {
  const Eigen::Matrix<double, 6, 1> twist = robot_.jacobian(q, limits_.tip) * dq;
  const Eigen::Vector3d arm = robot_.fk(q, limits_.tip).linear() * limits_.tool,
                        turn = twist.tail<3>();
  return {(twist.head<3>() + turn.cross(arm)).norm(), turn.norm()};
}

CurveTimer::Shares CurveTimer::use(const Eigen::VectorXd& q, const Eigen::VectorXd& dq,
                                   const Eigen::VectorXd& ddq) const {
  Shares used{dq.cwiseQuotient(limits_.max_speed).cwiseAbs().maxCoeff(),
              ddq.cwiseQuotient(limits_.max_acceleration).cwiseAbs().maxCoeff(), 0.0, 0.0};
  if (has_tool()) {
    const Eigen::Vector2d rates = tool_rates(q, dq);
    used[2] = rates[0] / limits_.tool_speed;
    used[3] = rates[1] / limits_.tool_turn;
  }
  return used;
}

/// Several cells in each of the curve's polynomials, and finer ones next to rests.
Eigen::VectorXd CurveTimer::grid() {
  const Eigen::VectorXd& breaks = curve_.breaks();
  const double length = curve_.length();
  std::vector<double> edges;
  for (Eigen::Index k = 0; k + 1 < breaks.size(); ++k) {
    const double span = breaks[k + 1] - breaks[k];
    const int parts = std::max(kCells, static_cast<int>(std::ceil(span * kLeastCells / length)));
    for (int i = 0; i < parts; ++i) edges.push_back(breaks[k] + span * i / parts);
  }
  for (const double end : {0.0, length}) {
    curve_.evaluate(end, 1, q1_);
    const double change = 1.0 / q1_.cwiseQuotient(limits_.max_acceleration).cwiseAbs().maxCoeff();
    const double ramp = 0.5 * ceiling(end) / change;
    const double cell = std::clamp(ramp / kPerRamp, kLeastCell * length, length / kLeastCells);
    edges.push_back(std::abs(end - cell));
  }
  edges.push_back(length);
  return graded(std::move(edges), kGrade);
}

double CurveTimer::ceiling(double s) {
  curve_.evaluate(s, 0, q_);
  curve_.evaluate(s, 1, q1_);
  const Shares allowed = least_share(s), used = use(q_, q1_, Eigen::VectorXd::Zero(q_.size()));
  double rate = kLeastRate;
  for (const std::size_t i : {0U, 2U, 3U}) rate = std::max(rate, used[i] / allowed[i]);
  return 1.0 / (rate * rate);
}

void CurveTimer::find_motion() {
  s_ = grid();
  const Eigen::Index count = s_.size(), n = limits_.max_speed.size();
  RoundedCurve::Rows a(count, n), b(count, n);
  Eigen::VectorXd most(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    most[k] = ceiling(s_[k]);
    const Eigen::VectorXd acceleration = least_share(s_[k])[1] * limits_.max_acceleration;
    curve_.evaluate(s_[k], 2, q2_);
    a.row(k) = q1_.cwiseQuotient(acceleration).transpose();
    b.row(k) = q2_.cwiseQuotient(acceleration).transpose();
  }
  x_ = fastest_squares(s_, a, b, most);
  time_.resize(count);
  time_[0] = 0.0;
  for (Eigen::Index k = 0; k + 1 < count; ++k) {
    const double both = std::sqrt(x_[k]) + std::sqrt(x_[k + 1]);
    if (!(both > 0.0))
      throw std::invalid_argument(
          "the path cannot be timed: it cannot be got "
          "along from rest to rest within the limits");
    time_[k + 1] = time_[k] + 2.0 * (s_[k + 1] - s_[k]) / both;
  }
  slowness_ = 1.0;
}

std::vector<CurveTimer::Shares> CurveTimer::measure() {
  std::vector<Shares> used(shares_.size(), {1.0, 1.0, 1.0, 1.0});
  double slowness = 1.0, s = 0.0;
  Eigen::VectorXd q, dq, ddq;
  for (Eigen::Index k = 0; k + 1 < time_.size(); ++k) {
    for (const double moment : kMoments) {
      state(time_[k] + moment * (time_[k + 1] - time_[k]), s, q, dq, ddq);
      const Shares now = use(q, dq, ddq);
      Shares& region = used[static_cast<std::size_t>(cell_of(regions_, s))];
      for (std::size_t i = 0; i < now.size(); ++i) {
        region[i] = std::max(region[i], now[i]);
        slowness = std::max(slowness, std::pow(now[i], 1.0 / kPowers[i]));
      }
    }
  }
  slowness_ = slowness;
  return used;
}

}  // namespace pdoik::detail
