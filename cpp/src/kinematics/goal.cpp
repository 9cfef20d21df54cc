#include "pdoik/goal.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace pdoik {
namespace {

/// What is unbounded on one side is bounded this far away: farther than robots reach, and near
/// enough for distances to keep twelve digits [m].
constexpr double kFar = 1e3;

void check_bounds(const char* name, double lower, double upper, int axis) {
  if (lower <= upper) return;
  throw std::invalid_argument(std::string(name) + " about axis " + "xyz"[axis] + " goes from " +
                              std::to_string(lower) + " to " + std::to_string(upper) +
                              ", expected a lower bound that is at most the upper one");
}

}  // namespace

Goal& Goal::between(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    check_bounds("the region of positions", lower[i], upper[i], i);
    const bool below = std::isinf(lower[i]), above = std::isinf(upper[i]);
    const double low = below && !above ? upper[i] - kFar : lower[i],
                 high = above && !below ? lower[i] + kFar : upper[i];
    if (!(below && above)) middle[i] = 0.5 * (low + high);
    position_slack[i] = 0.5 * (high - low);
  }
  T_base_tip.translate(middle);
  return *this;
}

Goal& Goal::turned_between(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) {
  for (int i = 0; i < 3; ++i) {
    check_bounds("the region of rotations", lower[i], upper[i], i);
    if (std::isinf(lower[i]) || std::isinf(upper[i]))
      throw std::invalid_argument(
          "the region of rotations is infinite, expected angles: -pi and pi free an axis");
  }
  rotation_slack = 0.5 * (upper - lower);
  const Eigen::Vector3d middle = 0.5 * (lower + upper);
  const double angle = middle.norm();
  if (angle > 0.0) T_base_tip.rotate(Eigen::AngleAxisd(angle, middle / angle));
  return *this;
}

}  // namespace pdoik
