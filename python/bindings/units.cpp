#include "units.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bind.hpp"

namespace pdoik::python {
namespace {

/// A cell of some metres is a thousand times as large in millimetres, and no robot looks so far in
/// metres.
constexpr double kReaches = 100.0;

/// An upper bound on how far a tip gets from the base frame's origin [m].
double reach(const Robot& robot) {
  double farthest = 0.0;
  for (const int tip : robot.tips()) {
    double distance = robot.T_body_link(tip).translation().norm();
    for (int b = robot.body_of_link(tip); b > 0;) {
      const Body& body = robot.bodies()[static_cast<std::size_t>(b)];
      distance += body.T_parent_joint.translation().norm();
      if (body.prismatic && body.multiplier != 0.0) {
        distance += std::abs(body.offset) +
                    std::abs(body.multiplier) * std::max(std::abs(robot.lower()[body.dof]),
                                                         std::abs(robot.upper()[body.dof]));
      }
      b = body.parent;
    }
    farthest = std::max(farthest, distance);
  }
  return farthest;
}

double median_distance(const RowMatrix& points) {
  if (points.rows() == 0) return 0.0;
  Eigen::VectorXd distances = points.leftCols<3>().rowwise().norm() - points.col(3);
  auto* const middle = distances.data() + distances.size() / 2;
  if (!(distances.array() <= 1e6).all()) return 0.0;  // which whoever takes them refuses, as NaN
  std::nth_element(distances.data(), middle, distances.data() + distances.size());
  return *middle;
}

}  // namespace

void warn_of_units(const ObstaclesIn& obstacles, const Robot& robot, ToldOfUnits& told) {
  constexpr int kLooks = 33;
  if (told) return;
  const double away = median_distance(obstacles.sample(kLooks));
  if (!(away > 0.0)) return;
  const double reached = reach(robot);
  if (!(reached > 0.0) || !(away > kReaches * reached)) return;
  told = true;
  warn_of_obstacles(
      py::str("half of the obstacle points are more than {:.0f} m away, and the robot "
              "reaches {:.2g} m: are they in millimetres? They are taken as metres")
          .format(away, reached)
          .cast<std::string>());
}

}  // namespace pdoik::python
