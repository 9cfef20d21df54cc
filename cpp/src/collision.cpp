#include "detail/collision.hpp"

#include <algorithm>
#include <cmath>

#include "detail/spheroid_distance.hpp"

namespace pdoik::detail {
namespace {

constexpr double kFarAway = 1e30;

/// Move a point that lies on its joint's axis to the body before it, as far as that goes.
AttachedPoint settle(const Robot& robot, int body, Eigen::Vector3d local) {
  while (body > 0) {
    const Body& joint = robot.bodies()[static_cast<std::size_t>(body)];
    if (joint.prismatic || local.head<2>().norm() > 1e-12) break;
    local = joint.T_parent_joint * local;
    body = joint.parent;
  }
  return {body, to_vec4(local)};
}

int add_point(std::vector<AttachedPoint>& points, const AttachedPoint& point) {
  for (std::size_t k = 0; k < points.size(); ++k) {
    const Vec4 gap = points[k].local - point.local;
    if (points[k].body == point.body && dot3(gap, gap) < 1e-24) return static_cast<int>(k);
  }
  points.push_back(point);
  return static_cast<int>(points.size()) - 1;
}

/// An upper bound on how far a point gets from the origin of the first moving body above it, and that body.
struct Reach {
  int root;
  double distance;
};

Reach reach_of(const Robot& robot, const AttachedPoint& point) {
  Reach reach{0, std::sqrt(dot3(point.local, point.local))};
  for (int b = point.body; b > 0;) {
    const Body& body = robot.bodies()[static_cast<std::size_t>(b)];
    if (body.prismatic) {
      const double low = body.multiplier * robot.lower()[body.dof] + body.offset;
      const double high = body.multiplier * robot.upper()[body.dof] + body.offset;
      reach.distance += std::max(std::abs(low), std::abs(high));
    }
    reach.root = b;
    b = body.parent;
    if (b > 0) reach.distance += body.T_parent_joint.translation().norm();
  }
  return reach;
}

}  // namespace

HullModel::HullModel(const Robot& robot) {
  const auto attach = [&](const std::string& link, const Eigen::Vector3d& xyz) {
    const int index = robot.link_index(link);
    return add_point(points, settle(robot, robot.body_of_link(index), robot.T_body_link(index) * xyz));
  };
  int source = 0;
  const auto add = [&](int a, int b, double semi_major) {
    const bool is_fixed = points[static_cast<std::size_t>(a)].body == 0 && points[static_cast<std::size_t>(b)].body == 0;
    (is_fixed ? fixed : moving).push_back({a, b, semi_major, source++});
  };
  for (const Sphere& sphere : robot.occupancy().spheres) {
    const int at = attach(sphere.link, sphere.center);
    add(at, at, sphere.radius);
  }
  for (const Spheroid& s : robot.occupancy().spheroids) {
    const int a = attach(s.link_a, s.focus_a), b = attach(s.link_b, s.focus_b);
    add(a, b, s.semi_major);
  }

  double farthest = 0.0;
  int root = -1;
  for (const Hull& hull : moving) {
    for (const int k : {hull.a, hull.b}) {
      const AttachedPoint& point = points[static_cast<std::size_t>(k)];
      if (point.body == 0) continue;
      const Reach r = reach_of(robot, point);
      if (root >= 0 && r.root != root) return;  // several branches at the base: no common centre
      root = r.root;
      farthest = std::max(farthest, r.distance + 2.0 * hull.semi_major);
    }
  }
  if (root < 0) return;
  reach_centre = robot.bodies()[static_cast<std::size_t>(root)].T_parent_joint.translation();
  reach = farthest * (1.0 + 1e-9);
}

void ObstacleSet::reserve(std::size_t count) {
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  for (std::vector<double>* v : {&x_, &y_, &z_, &radius_}) v->reserve(padded);
  index_.reserve(padded);
}

void ObstacleSet::resize(int count) {
  count_ = count;
  padded_ = (count + kLanes - 1) / kLanes * kLanes;
  const auto used = static_cast<std::size_t>(count), size = static_cast<std::size_t>(padded_);
  for (std::vector<double>* v : {&x_, &y_, &z_}) {
    v->resize(used);
    v->resize(size, kFarAway);
  }
  radius_.resize(used);
  radius_.resize(size, 0.0);
  index_.resize(used);
  index_.resize(size, -1);
  if (count == 0) any_radius_ = false;
}

void ObstacleSet::add(const Eigen::Vector3d& point, double radius, int original_index) {
  x_.push_back(point.x());
  y_.push_back(point.y());
  z_.push_back(point.z());
  radius_.push_back(radius);
  index_.push_back(original_index);
  any_radius_ = any_radius_ || radius != 0.0;
  ++count_;
}

void Scene::reserve(std::size_t count) {
  near.reserve(count);
  far.reserve(count);
}

void Scene::assign(const Points& points, double margin, const HullModel& hulls) {
  near.clear();
  far.clear();
  far_bound = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Vector3d o(points(i, 0), points(i, 1), points(i, 2));
    const double radius = (points.cols() > 3 ? points(i, 3) : 0.0) + margin;
    const double beyond = (o - hulls.reach_centre).norm() - radius - hulls.reach;
    if (beyond > 0.0) {
      far.add(o, radius, static_cast<int>(i));
      far_bound = std::min(far_bound, beyond);
    } else {
      near.add(o, radius, static_cast<int>(i));
    }
  }
  near.finish();
  far.finish();
  positions_of_fixed_.resize(hulls.points.size());
  for (std::size_t k = 0; k < hulls.points.size(); ++k) positions_of_fixed_[k] = hulls.points[k].local;
  fixed = least_clearance(hulls.fixed, positions_of_fixed_.data(), near);
  fixed = least_clearance(hulls.fixed, positions_of_fixed_.data(), far, fixed);
}

Clearance Scene::clearance(const HullModel& hulls, const Vec4* positions) const {
  const Clearance least = least_clearance(hulls.moving, positions, near, fixed);
  if (least.distance <= far_bound) return least;
  return least_clearance(hulls.moving, positions, far, least);
}

Clearance least_clearance(const std::vector<Hull>& hulls, const Vec4* positions, const ObstacleSet& obstacles,
                          Clearance least) {
  for (const Hull& hull : hulls) {
    const Vec4& a = positions[hull.a];
    const Vec4& b = positions[hull.b];
    const Vec4 centre = broadcast(0.5) * (a + b);
    const Vec4 half = broadcast(0.5) * (b - a);
    const bool hollow = !(hull.semi_major * hull.semi_major > dot3(half, half));  // foci too far apart: empty
    for (int j = 0; j < obstacles.count(); ++j) {
      const Vec4 o = obstacles.point(j);
      const double radius = obstacles.radius(j);
      // The hull lies within semi_major of its centre; only a nearer obstacle can beat the least so far.
      const double bound = least.distance + hull.semi_major + radius;
      const Vec4 from = o - centre;
      if (bound > 0.0 && dot3(from, from) >= bound * bound) continue;
      const Vec4 to_a = o - a;
      double distance = std::sqrt(dot3(to_a, to_a)) - hull.semi_major;
      if (!hull.is_sphere()) {
        const Vec4 to_b = o - b;
        distance = 0.5 * (distance + hull.semi_major + std::sqrt(dot3(to_b, to_b))) - hull.semi_major;
        // The half sum of distances changes no faster than the point moves: a lower bound outside.
        if (distance - radius >= least.distance && distance > 0.0) continue;
        if (!hollow) {
          distance = spheroid_distance(to_vector3(o), to_vector3(a), to_vector3(b), hull.semi_major).distance;
        }
      }
      if (distance - radius < least.distance) {
        least = {distance - radius, hull.source, obstacles.original_index(j)};
      }
    }
  }
  return least;
}

}  // namespace pdoik::detail
