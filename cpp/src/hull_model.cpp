#include "detail/hull_model.hpp"

#include <cmath>

#include "detail/reach.hpp"

namespace pdoik::detail {
namespace {

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

}  // namespace

HullModel::HullModel(const Robot& robot, bool with_fixed) {
  const auto attach = [&](const std::string& link, const Eigen::Vector3d& xyz) {
    const int index = robot.link_index(link);
    return add_point(points,
                     settle(robot, robot.body_of_link(index), robot.T_body_link(index) * xyz));
  };
  int source = 0;
  const auto add = [&](int a, int b, double semi_major) {
    const AttachedPoint &one = points[static_cast<std::size_t>(a)],
                        &other = points[static_cast<std::size_t>(b)];
    const bool is_fixed = one.body == 0 && other.body == 0;
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

  if (!with_fixed) fixed.clear();

  double farthest = 0.0;
  int root = -1;
  for (const Hull& hull : moving) {
    for (const int k : {hull.a, hull.b}) {
      const AttachedPoint& point = points[static_cast<std::size_t>(k)];
      if (point.body == 0) continue;
      const Reach r = reach_of(robot, point.body, std::sqrt(dot3(point.local, point.local)));
      if (root >= 0 && r.root != root) return;  // several branches at the base: no common centre
      root = r.root;
      farthest = std::max(farthest, r.distance + 2.0 * hull.semi_major);
    }
  }
  if (root < 0) return;
  reach_centre = Reach{root}.centre(robot);
  reach = farthest * (1.0 + 1e-9);
}

}  // namespace pdoik::detail
