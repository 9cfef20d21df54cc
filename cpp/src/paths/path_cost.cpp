#include "paths/path_cost.hpp"

#include <algorithm>
#include <cmath>

#include "search/derivatives.hpp"

namespace pdoik::detail {

double PathCost::of_place(PathStepper& stepper, const PathPoint& point) const {
  if (!minds_places()) return 0.0;
  const auto near = [&](double distance) {
    const double share = std::max(0.0, 1.0 - std::max(0.0, distance) / costs_.room);
    return share * share;
  };
  double sum = 0.0;
  if (costs_.limits > 0.0) {
    double worst = 0.0;
    const Eigen::VectorXd &lower = model_.robot.lower(), &upper = model_.robot.upper();
    for (Eigen::Index i = 0; i < point.q.size(); ++i) {
      const double half = 0.5 * (upper[i] - lower[i]);
      if (!std::isfinite(half) || half <= 0.0) continue;
      worst = std::max(worst, std::abs(point.q[i] - 0.5 * (lower[i] + upper[i])) / half);
    }
    sum += costs_.limits * std::pow(worst, 4);
  }
  if (costs_.obstacles > 0.0)
    sum += costs_.obstacles * near(std::min(point.room.obstacles, point.room.self));
  if (costs_.singularities > 0.0) {
    const double distance =
        derivatives(stepper.workspace(), stepper.goals().at(point.at), point.q).singular_distance;
    stepper.workspace().watch(stepper.deadline());
    sum += costs_.singularities * near(distance);
  }
  return sum;
}

double PathCost::of_all(PathStepper& stepper, const std::vector<PathPoint>& points) const {
  double sum = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const PathPoint &last = points[k - 1], &point = points[k];
    sum += of_motion(last.q, point.q);
    if (minds_places())
      sum += stepper.goals().way(static_cast<int>(last.at), static_cast<int>(point.at)) *
             of_place(stepper, point);
  }
  return sum;
}

}  // namespace pdoik::detail
