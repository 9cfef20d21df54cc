#include "paths/rounded_curve.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pdoik::detail {
namespace {

constexpr int kMostHalvings = 60;  ///< of halving: any span is then below what numbers resolve
constexpr double kProbes[] = {0.0, 0.25, 0.5, 0.75};  ///< in each cell that corners and joins leave
constexpr double kKept = 0.98;  ///< of the deviation, for what lies between probes

std::vector<double> sorted_union(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
  std::vector<double> all(one.begin(), one.end());
  all.insert(all.end(), other.begin(), other.end());
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

Eigen::Index cell_of(const Eigen::VectorXd& edges, double value) {
  const auto above = std::upper_bound(edges.begin(), edges.end(), value);
  return std::clamp<Eigen::Index>(above - edges.begin() - 1, 0, edges.size() - 2);
}

void along(const TimedMotion::Rows& rows, const Eigen::VectorXd& s, double place,
           Eigen::VectorXd& value) {
  const Eigen::Index k = cell_of(s, place);
  const double share = std::clamp((place - s[k]) / (s[k + 1] - s[k]), 0.0, 1.0);
  value = rows.row(k).transpose() + share * (rows.row(k + 1) - rows.row(k)).transpose();
}

RoundedCurve::RoundedCurve(const Rows& rows, const Eigen::VectorXd& s, double deviation)
    : breaks_(2), start_(rows.row(0).transpose()) {
  breaks_ << s[0], s[s.size() - 1];
  Eigen::VectorXd is, ought;
  for (int round = 0; round < kMostHalvings; ++round) {
    take_controls(rows, s);
    const std::vector<double> cells = sorted_union(s, breaks_);
    std::vector<char> too_wide(static_cast<std::size_t>(breaks_.size()) - 1, 0);
    bool is_near = true;
    deviation_ = 0.0;
    for (std::size_t k = 0; k + 1 < cells.size(); ++k) {
      for (const double share : kProbes) {
        const double place = cells[k] + share * (cells[k + 1] - cells[k]);
        evaluate(place, 0, is);
        along(rows, s, place, ought);
        const double off = (is - ought).cwiseAbs().maxCoeff();
        deviation_ = std::max(deviation_, off);
        if (off <= kKept * deviation) continue;
        too_wide[static_cast<std::size_t>(cell_of(breaks_, place))] = 1;
        is_near = false;
      }
    }
    if (is_near) return;
    std::vector<double> finer;
    for (Eigen::Index k = 0; k < breaks_.size(); ++k) {
      finer.push_back(breaks_[k]);
      if (k + 1 < breaks_.size() && too_wide[static_cast<std::size_t>(k)])
        finer.push_back(0.5 * (breaks_[k] + breaks_[k + 1]));
    }
    breaks_ = Eigen::Map<Eigen::VectorXd>(finer.data(), static_cast<Eigen::Index>(finer.size()));
  }
  take_controls(rows, s);
}

double RoundedCurve::knot(Eigen::Index i) const {
  return breaks_[std::clamp<Eigen::Index>(i - 3, 0, breaks_.size() - 1)];
}

void RoundedCurve::take_controls(const Rows& rows, const Eigen::VectorXd& s) {
  controls_.resize(rows.cols(), breaks_.size() + 2);
  Eigen::VectorXd value;
  for (Eigen::Index i = 0; i < controls_.cols(); ++i) {
    along(rows, s, (knot(i + 1) + knot(i + 2) + knot(i + 3)) / 3.0, value);
    controls_.col(i) = value - start_;
  }
}

void RoundedCurve::evaluate(double s, int order, Eigen::VectorXd& value) const {
  const Eigen::Index k = cell_of(breaks_, s);
  Eigen::Matrix<double, Eigen::Dynamic, 4> d = controls_.middleCols<4>(k);
  for (int degree = 3; degree > 3 - order; --degree) {
    for (int j = 3; j > 3 - degree; --j) {
      const double width = knot(k + j + degree) - knot(k + j);
      d.col(j) = (degree / width) * (d.col(j) - d.col(j - 1)).eval();
    }
  }
  const int degree = 3 - order;  // de Boor's algorithm
  for (int r = 1; r <= degree; ++r) {
    for (int j = 3; j > 3 - degree + r - 1; --j) {
      const double low = knot(k + j), share = (s - low) / (knot(k + j + degree + 1 - r) - low);
      d.col(j) = ((1.0 - share) * d.col(j - 1) + share * d.col(j)).eval();
    }
  }
  value = d.col(3);
  if (order == 0) value += start_;
}

}  // namespace pdoik::detail
