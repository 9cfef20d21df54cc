#include "obstacle_check.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pdoik/occupancy.hpp"

namespace pdoik::bench {

ObstacleCheck::ObstacleCheck(const char* occupancy_yaml,
                             const std::function<Carrier(const std::string& link)>& carrier) {
  if (occupancy_yaml == nullptr) return;
  const Occupancy occupancy = load_occupancy(occupancy_yaml);
  for (const Sphere& sphere : occupancy.spheres)
    add(carrier(sphere.link), sphere.center, sphere.center, sphere.radius);
  for (const Spheroid& spheroid : occupancy.spheroids) {
    if (spheroid.link_a != spheroid.link_b) {
      throw std::invalid_argument("a hull between " + spheroid.link_a + " and " + spheroid.link_b +
                                  ": this peer knows hulls on one link only");
    }
    add(carrier(spheroid.link_a), spheroid.focus_a, spheroid.focus_b, spheroid.semi_major);
  }
}

void ObstacleCheck::add(const Carrier& carrier, const Eigen::Vector3d& focus_a,
                        const Eigen::Vector3d& focus_b, double semi_major) {
  auto group = std::find_if(groups_.begin(), groups_.end(),
                            [&](const Group& each) { return each.frame == carrier.frame; });
  if (group == groups_.end()) group = groups_.insert(group, Group{carrier.frame});
  const double focal = 0.5 * (focus_b - focus_a).norm();
  const double semi_minor = std::sqrt(std::max(0.0, (semi_major - focal) * (semi_major + focal)));
  group->hulls.push_back(
      {carrier.T_frame_link * focus_a, carrier.T_frame_link * focus_b, semi_major, semi_minor});
  group->center.setZero();
  for (const Hull& hull : group->hulls) group->center += hull.center();
  group->center /= static_cast<double>(group->hulls.size());
  group->radius = 0.0;
  for (const Hull& hull : group->hulls) {
    const double away = (hull.center() - group->center).norm();
    group->radius = std::max(group->radius, away + hull.semi_major);
  }
}

void ObstacleCheck::set_points(const PeerProblem& problem) {
  const int count = problem.obstacles != nullptr ? problem.obstacle_count : 0;
  points_.resize(static_cast<std::size_t>(count));
  near_.resize(points_.size());
  const double* row = problem.obstacles;
  for (Point& point : points_) {
    point = {row[0], row[1], row[2], problem.obstacle_columns == 4 ? row[3] : 0.0};
    row += problem.obstacle_columns;
  }
}

std::size_t ObstacleCheck::gather(const Eigen::Vector3d& center, double radius) {
  std::size_t count = 0;
  for (const Point& point : points_) {
    near_[count] = point;  // without a branch, for there is no telling which
    count += point.reaches(center, radius) ? 1 : 0;
  }
  return count;
}

bool ObstacleCheck::touches(const Hull& hull, std::size_t count) const {
  const Eigen::Vector3d center = hull.center();
  for (std::size_t i = 0; i < count; ++i) {
    if (near_[i].reaches(center, hull.semi_major) && touches(hull, near_[i])) return true;
  }
  return false;
}

/// In a half plane of its axis the spheroid is the ellipse (x/a)^2 + (y/b)^2 = 1, and the nearest
/// point of it to (x, y) outside is at the root t > 0 of
///     F(t) = (a x / (t + a^2))^2 + (b y / (t + b^2))^2 - 1
/// (Eberly, "Distance from a point to an ellipse"). F falls and is convex, so that Newton's method
/// comes to the root from below, and the distance that belongs to t grows with t, so that it is a
/// lower bound on the way.
bool ObstacleCheck::touches(const Hull& hull, const Point& point) {
  const double a = hull.semi_major, b = hull.semi_minor;
  const Eigen::Vector3d o = point.position();
  const double half_sum = 0.5 * ((o - hull.focus_a).norm() + (o - hull.focus_b).norm());
  if (half_sum < a) return true;
  if (half_sum >= a + point.radius) return false;  // it grows no faster than the distance
  const Eigen::Vector3d axis = hull.focus_b - hull.focus_a, from = o - hull.center();
  const double length = axis.norm();
  const double x = length > 0.0 ? std::abs(from.dot(axis)) / length : 0.0;
  const double y = std::sqrt(std::max(0.0, from.squaredNorm() - x * x));
  double t = std::max({0.0, a * (x - a), b * (y - b)});  // F(t) >= 0
  for (int i = 0; i < 50; ++i) {
    const double u = a * x / (t + a * a), v = b * y / (t + b * b);
    if (t * std::hypot(u / a, v / b) >= point.radius) return false;
    const double slope = -2.0 * (u * u / (t + a * a) + v * v / (t + b * b));
    const double step = -(u * u + v * v - 1.0) / slope;
    t += step;
    if (!(step > 1e-12 * t)) break;
  }
  return t * std::hypot(x / (t + a * a), y / (t + b * b)) < point.radius;
}

}  // namespace pdoik::bench
