#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "pdoik/timing.hpp"

namespace pdoik {
namespace {

/// By how much a constraint may be missed for rounding [-].
constexpr double kSquaresRounding = 1e-12;

/// p x + r y <= 1: what a limit asks of the squares at both ends of a cell. All hold at rest.
struct HalfPlane {
  double p, r;
};

/// The largest x for which there is a y, both between 0 and their bounds: constraint after
/// constraint, the best moves onto each one that it misses (Seidel, 1991).
class LargestStart {
 public:
  double find(const std::vector<HalfPlane>& planes, double most_x, double most_y) {
    planes_ = &planes;
    most_x_ = most_x;
    most_y_ = most_y;
    double x = most_x, y = most_y;
    for (std::size_t k = 0; k < planes.size(); ++k) {
      if (planes[k].p * x + planes[k].r * y <= 1.0 + kSquaresRounding) continue;
      if (!move_onto(k, x, y)) return 0.0;
    }
    return std::clamp(x, 0.0, most_x);
  }

 private:
  /// The best on the line of a constraint, inside the bounds and all constraints before it.
  bool move_onto(std::size_t k, double& x, double& y) {
    const auto [p, r] = (*planes_)[k];
    const double size = std::hypot(p, r), x0 = p / (size * size), y0 = r / (size * size);
    const double dx = -r / size, dy = p / size;
    low_ = -std::numeric_limits<double>::infinity();
    high_ = -low_;
    keep(-dx, x0);
    keep(dx, most_x_ - x0);
    keep(-dy, y0);
    keep(dy, most_y_ - y0);
    for (std::size_t j = 0; j < k; ++j)
      keep((*planes_)[j].p * dx + (*planes_)[j].r * dy,
           1.0 - (*planes_)[j].p * x0 - (*planes_)[j].r * y0);
    if (low_ > high_) {  // by rounding only: all hold at rest
      if (!(low_ <= high_ + kSquaresRounding * (1.0 + std::abs(low_)))) return false;
      high_ = low_;
    }
    const double t = dx > 0.0 || (dx == 0.0 && dy > 0.0) ? high_ : low_;
    if (!std::isfinite(t)) return false;
    x = x0 + t * dx;
    y = y0 + t * dy;
    return true;
  }

  /// slope t <= room.
  void keep(double slope, double room) {
    if (slope > 0.0)
      high_ = std::min(high_, room / slope);
    else if (slope < 0.0)
      low_ = std::max(low_, room / slope);
  }

  const std::vector<HalfPlane>* planes_ = nullptr;
  double most_x_ = 0.0, most_y_ = 0.0, low_ = 0.0, high_ = 0.0;
};

void check(const Eigen::VectorXd& s, const TimedMotion::Rows& a, const TimedMotion::Rows& b,
           const Eigen::VectorXd& most) {
  const Eigen::Index m = s.size();
  if (m < 2 || a.rows() != m || b.rows() != m || most.size() != m || a.cols() != b.cols())
    throw std::invalid_argument("s, a, b and most have " + std::to_string(m) + ", " +
                                std::to_string(a.rows()) + ", " + std::to_string(b.rows()) +
                                " and " + std::to_string(most.size()) +
                                " rows, expected as many, 2 or more");
  for (Eigen::Index k = 1; k < m; ++k) {
    if (!(s[k] > s[k - 1])) throw std::invalid_argument("s does not rise");
  }
}

}  // namespace

Eigen::VectorXd fastest_squares(const Eigen::VectorXd& s, const TimedMotion::Rows& a,
                                const TimedMotion::Rows& b, const Eigen::VectorXd& most) {
  check(s, a, b, most);
  const Eigen::Index last = s.size() - 1, count = a.cols();
  std::vector<HalfPlane> planes;
  // With u = (y - x) / (2 ds): what a constraint at either end of a cell asks of x and y.
  const auto find_planes = [&](Eigen::Index k) {
    planes.clear();
    const double twice = 2.0 * (s[k + 1] - s[k]);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double here = a(k, i) / twice, there = a(k + 1, i) / twice;
      for (const HalfPlane& plane :
           {HalfPlane{b(k, i) - here, here}, HalfPlane{-there, there + b(k + 1, i)}}) {
        planes.push_back(plane);
        planes.push_back({-plane.p, -plane.r});
      }
    }
  };
  // Backwards: the largest square from which the end can be reached at rest.
  Eigen::VectorXd x = Eigen::VectorXd::Zero(s.size());
  LargestStart start;
  for (Eigen::Index k = last - 1; k >= 0; --k) {
    find_planes(k);
    x[k] = start.find(planes, most[k], x[k + 1]);
  }
  // Forwards: the largest that is got to.
  x[0] = 0.0;
  for (Eigen::Index k = 0; k < last; ++k) {
    find_planes(k);
    double next = x[k + 1];
    for (const HalfPlane& plane : planes) {
      if (plane.r > 0.0) next = std::min(next, (1.0 - plane.p * x[k]) / plane.r);
    }
    x[k + 1] = std::max(0.0, next);
  }
  return x;
}

}  // namespace pdoik
