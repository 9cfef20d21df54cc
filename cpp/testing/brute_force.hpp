#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pdoik/robot.hpp"

/// Distances and clearances by searching, without any of the library's formulas.
namespace pdoik::testing {

/// Signed distance from (x, y) to the ellipse with semi-axes a >= b: its quarter is sampled, then
/// the best interval is shrunk by golden sections.
inline double brute_force_ellipse_distance(double a, double b, double x, double y,
                                           int samples = 400) {
  const double px = std::abs(x), py = std::abs(y);
  const auto distance = [&](double t) {
    return std::hypot(px - a * std::cos(t), py - b * std::sin(t));
  };
  const double step = M_PI_2 / samples;
  int best = 0;
  for (int k = 1; k <= samples; ++k) {
    if (distance(k * step) < distance(best * step)) best = k;
  }
  double low = std::max(0, best - 1) * step, high = std::min(samples, best + 1) * step;
  double least = std::min(distance(low), distance(high));
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int k = 0; k < 60; ++k) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    least = std::min({least, distance(left), distance(right)});
    (distance(left) < distance(right) ? high : low) =
        distance(left) < distance(right) ? right : left;
  }
  return (px / a) * (px / a) + (py / b) * (py / b) < 1.0 ? -least : least;
}

/// Distance from a point to a prolate spheroid's surface, negative inside. Foci too far apart: an
/// empty hull, whose "distance" is by how much the half sum of distances exceeds semi_major.
inline double brute_force_spheroid_distance(const Eigen::Vector3d& o, const Eigen::Vector3d& f1,
                                            const Eigen::Vector3d& f2, double semi_major,
                                            int samples = 400) {
  const double f = 0.5 * (f2 - f1).norm();
  if (!(semi_major > f)) return 0.5 * ((o - f1).norm() + (o - f2).norm()) - semi_major;
  const Eigen::Vector3d from = o - 0.5 * (f1 + f2);
  if (f == 0.0) return from.norm() - semi_major;
  const double x = from.dot((f2 - f1).normalized());
  const double y = (from - x * (f2 - f1).normalized()).norm();
  return brute_force_ellipse_distance(semi_major, std::sqrt((semi_major - f) * (semi_major + f)), x,
                                      y, samples);
}

/// The distance from a point to a segment's nearest point.
inline double brute_force_segment_distance(const Eigen::Vector3d& o, const Eigen::Vector3d& a,
                                           const Eigen::Vector3d& b) {
  const double square = (b - a).squaredNorm();
  const double t = square > 0.0 ? std::clamp((o - a).dot(b - a) / square, 0.0, 1.0) : 0.0;
  return (o - a - t * (b - a)).norm();
}

/// Whether what is given on one link is told closer by the link's capsules.
inline bool has_capsules(const Robot& robot, const std::string& link) {
  const auto& capsules = robot.occupancy().capsules;
  return std::any_of(capsules.begin(), capsules.end(),
                     [&](const Capsule& capsule) { return capsule.link == link; });
}

/// The robot as its capsules have it, without pieces of its links.
inline Robot without_pieces(Robot robot) {
  Occupancy occupancy = robot.occupancy();
  occupancy.pieces.clear();
  robot.set_occupancy(occupancy);
  return robot;
}

/// The robot without its second and third level of hulls.
inline Robot without_capsules(Robot robot) {
  Occupancy occupancy = robot.occupancy();
  occupancy.capsules.clear();
  occupancy.pieces.clear();
  robot.set_occupancy(occupancy);
  return robot;
}

/// The least distance of any obstacle (rows x y z or x y z radius) to any hull, by Robot::fk.
template <class Obstacles>
double brute_force_clearance(const Robot& robot, const Eigen::VectorXd& q,
                             const Obstacles& obstacles, int samples = 400) {
  double least = std::numeric_limits<double>::infinity();
  const auto for_obstacles = [&](auto&& distance) {
    for (Eigen::Index j = 0; j < obstacles.rows(); ++j) {
      const Eigen::Vector3d o = obstacles.row(j).template head<3>().transpose();
      least = std::min(least, distance(o, obstacles.cols() > 3 ? obstacles(j, 3) : 0.0));
    }
  };
  for (const Capsule& capsule : robot.occupancy().capsules) {
    const Eigen::Isometry3d T = robot.fk(q, capsule.link);
    for_obstacles([&](const Eigen::Vector3d& o, double radius) {
      return brute_force_segment_distance(o, T * capsule.a, T * capsule.b) - capsule.radius -
             radius;
    });
  }
  for (const Sphere& sphere : robot.occupancy().spheres) {
    if (has_capsules(robot, sphere.link)) continue;
    const Eigen::Vector3d centre = robot.fk(q, sphere.link) * sphere.center;
    for_obstacles([&](const Eigen::Vector3d& o, double radius) {
      return (centre - o).norm() - sphere.radius - radius;
    });
  }
  for (const Spheroid& s : robot.occupancy().spheroids) {
    if (s.link_a == s.link_b && has_capsules(robot, s.link_a)) continue;
    const Eigen::Vector3d a = robot.fk(q, s.link_a) * s.focus_a,
                          b = robot.fk(q, s.link_b) * s.focus_b;
    for_obstacles([&](const Eigen::Vector3d& o, double radius) {
      const double bound =
          0.5 * ((o - a).norm() + (o - b).norm()) - s.semi_major;  // a lower bound outside
      if (bound > 0.0 && bound - radius > least) return bound - radius;
      return brute_force_spheroid_distance(o, a, b, s.semi_major, samples) - radius;
    });
  }
  return least;
}

}  // namespace pdoik::testing
