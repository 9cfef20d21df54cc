#include "detail/self_collision.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdoik::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double clamp_to_segment(double t) { return std::clamp(t, -1.0, 1.0); }

/// t1 of parallel segments: the middle of what lies beside the second one, or the end next to it.
double middle_of_overlap(double a, double b, double e, double along1) {
  const double centre = -along1 / a, reach = e / std::abs(b);  // of the second one, in units of t1
  return 0.5 * (clamp_to_segment(centre - reach) + clamp_to_segment(centre + reach));
}

}  // namespace

SegmentDistance segment_distance(const Vec4& c1, const Vec4& v1, const Vec4& c2, const Vec4& v2) {
  const Vec4 r = c1 - c2;
  const double a = dot3(v1, v1), b = dot3(v1, v2), e = dot3(v2, v2);
  const double along1 = dot3(v1, r), along2 = dot3(v2, r);
  double t1 = 0.0, t2 = 0.0;
  if (a > 0.0 && e > 0.0) {
    const Vec4 normal = cross3(v1, v2);
    const double square = dot3(normal, normal);
    t1 = square > 0.0 ? clamp_to_segment(-dot3(cross3(r, v2), normal) / square)
                      : middle_of_overlap(a, b, e, along1);
    const double free = (along2 + t1 * b) / e;
    t2 = clamp_to_segment(free);
    if (t2 != free) t1 = clamp_to_segment((t2 * b - along1) / a);
  } else if (a > 0.0) {
    t1 = clamp_to_segment(-along1 / a);
  } else if (e > 0.0) {
    t2 = clamp_to_segment(along2 / e);
  }
  const Vec4 gap = r + broadcast(t1) * v1 - broadcast(t2) * v2;
  return {std::sqrt(dot3(gap, gap)), t1, t2, gap};
}

namespace {

/// The bodies that a point moves with: its link's and, as long as it lies on the axis of a body's
/// joint, the body before. HullModel has settled it on the last of them.
bool moves_with(const Robot& robot, int link, int settled, int body) {
  for (int b = robot.body_of_link(link); b >= 0;
       b = robot.bodies()[static_cast<std::size_t>(b)].parent) {
    if (b == body) return true;
    if (b == settled) break;
  }
  return false;
}

/// Which links a hull sits on, and which bodies all of it moves with.
class Seat {
 public:
  Seat(const Robot& robot, const HullModel& model, const Hull& hull) : robot_(robot) {
    const Occupancy& occupancy = robot.occupancy();
    const auto source = static_cast<std::size_t>(hull.source);
    const std::size_t spheres = occupancy.spheres.size();
    given_a_ = robot.link_index(source < spheres ? occupancy.spheres[source].link
                                                 : occupancy.spheroids[source - spheres].link_a);
    given_b_ = source < spheres ? given_a_
                                : robot.link_index(occupancy.spheroids[source - spheres].link_b);
    settled_a_ = model.points[static_cast<std::size_t>(hull.a)].body;
    settled_b_ = model.points[static_cast<std::size_t>(hull.b)].body;
    first_ = given_a_;
    second_ = given_b_;
    for (int b = robot.body_of_link(given_a_); b >= 0 && !rigid_; b = parent(b)) {
      rigid_ = is_part_of(b);
      if (rigid_) first_ = second_ = link_on(b);
    }
  }

  /// Whether the foci are rigid to each other.
  bool rigid() const { return rigid_; }
  int first() const { return first_; }
  int second() const { return second_; }

  /// Whether all of the hull moves with a body.
  bool is_part_of(int body) const {
    return moves_with(robot_, given_a_, settled_a_, body) &&
           moves_with(robot_, given_b_, settled_b_, body);
  }
  bool is_rigid_to(const Seat& other) const {
    for (int b = 0; b < static_cast<int>(robot_.bodies().size()); ++b) {
      if (is_part_of(b) && other.is_part_of(b)) return true;
    }
    return false;
  }
  bool is_neighbour_of(const Seat& other) const {
    return any_links(other, [this](int mine, int theirs) {
      const int b = robot_.body_of_link(mine), c = robot_.body_of_link(theirs);
      return b == c || parent(b) == c || parent(c) == b;
    });
  }
  bool ignores(const Seat& other) const {
    return any_links(other, [this](int mine, int theirs) {
      const std::vector<std::string>& names = robot_.link_names();
      const std::string& one = names[static_cast<std::size_t>(mine)];
      const std::string& two = names[static_cast<std::size_t>(theirs)];
      const auto& ignored = robot_.ignored_pairs();
      return std::any_of(ignored.begin(), ignored.end(), [&](const LinkPair& pair) {
        return (pair.first == one && pair.second == two) ||
               (pair.first == two && pair.second == one);
      });
    });
  }

 private:
  int parent(int body) const { return robot_.bodies()[static_cast<std::size_t>(body)].parent; }

  /// Of the links on a body, one that the hull was given on if there is one.
  int link_on(int body) const {
    for (const int link : {given_a_, given_b_}) {
      if (robot_.body_of_link(link) == body) return link;
    }
    int link = 0;
    while (robot_.body_of_link(link) != body) ++link;
    return link;
  }

  template <class Test>
  bool any_links(const Seat& other, Test&& test) const {
    return test(first_, other.first_) || test(first_, other.second_) ||
           test(second_, other.first_) || test(second_, other.second_);
  }

  const Robot& robot_;
  int given_a_, given_b_, settled_a_, settled_b_;
  int first_, second_;
  bool rigid_ = false;
};

}  // namespace

SelfCollision::SelfCollision(const Robot& robot, const HullModel& hulls, double margin)
    : margin_(margin) {
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(robot.mid_configuration(), T_base_body);
  const auto position = [&](int point) {
    const AttachedPoint& p = hulls.points[static_cast<std::size_t>(point)];
    return Eigen::Vector3d(T_base_body[static_cast<std::size_t>(p.body)] * to_vector3(p.local));
  };
  std::vector<Seat> seats;
  std::vector<int> sources;
  for (const std::vector<Hull>* group : {&hulls.moving, &hulls.fixed}) {
    for (const Hull& each : *group) {
      seats.emplace_back(robot, hulls, each);
      sources.push_back(each.source);
      const double A = each.semi_major, h = 0.5 * (position(each.b) - position(each.a)).norm();
      const double B = std::sqrt(std::max((A - h) * (A + h), 0.0));
      hulls_.push_back(
          {each.a, each.b, A, seats.back().rigid(), B, h / (A + B), Vec4{}, Capsule{}});
    }
  }
  for (std::size_t i = 0; i < seats.size(); ++i) {
    for (std::size_t j = i + 1; j < seats.size(); ++j) {
      const Seat &one = seats[i], &two = seats[j];
      if (one.is_neighbour_of(two) || one.is_rigid_to(two) || one.ignores(two)) continue;
      pairs_.push_back({{sources[i], sources[j]},
                        {one.first(), two.first()},
                        {static_cast<int>(i), static_cast<int>(j)},
                        hulls_[i].semi_major + hulls_[j].semi_major});
    }
  }
  near_.resize(pairs_.size());
}

void SelfCollision::place(const Vec4* positions) {
  near_count_ = 0;
  for (PlacedHull& hull : hulls_) {
    const Vec4 &a = positions[hull.a], &b = positions[hull.b];
    if (hull.a == hull.b) {
      hull.capsule = {a, Vec4{}, hull.semi_major};
      continue;
    }
    hull.between = broadcast(0.5) * (b - a);
    if (!hull.rigid) {
      const double A = hull.semi_major, h = std::sqrt(dot3(hull.between, hull.between));
      hull.minor = h < A ? std::sqrt((A - h) * (A + h)) : 0.0;
      hull.shape = h / (A + hull.minor);
    }
    const bool hollow = !(hull.minor > 0.0);
    hull.capsule = {hollow ? broadcast(kNaN) : broadcast(0.5) * (a + b),
                    broadcast(hull.shape) * hull.between, hull.minor};
  }
}

SegmentDistance SelfCollision::measure(const Pair& pair) const {
  const Capsule &one = hull(pair.hull[0]).capsule, &two = hull(pair.hull[1]).capsule;
  return segment_distance(one.middle, one.half, two.middle, two.half);
}

double SelfCollision::distance(int k) const {
  const Pair& p = pair(k);
  if (!middles_within(p, kInfinity)) return kInfinity;
  return measure(p).distance - hull(p.hull[0]).capsule.radius - hull(p.hull[1]).capsule.radius;
}

SelfCollision::Least SelfCollision::least() const {
  // The most promising pair first: most of the others need no exact distance then.
  Least least;
  double lowest = kInfinity;
  for (int k = 0; k < pair_count(); ++k) {
    const Pair& p = pair(k);
    const Vec4 apart = hull(p.hull[0]).capsule.middle - hull(p.hull[1]).capsule.middle;
    const double promise = dot3(apart, apart) - p.semi_major * p.semi_major;
    if (promise < lowest) {
      lowest = promise;
      least.pair = k;
    }
  }
  if (least.pair < 0) return least;
  least.distance = distance(least.pair);
  for (int k = 0; k < pair_count(); ++k) {
    if (!middles_within(pair(k), pair(k).semi_major + least.distance)) continue;
    const double d = distance(k);
    if (d < least.distance) least = {d, k};
  }
  return least;
}

namespace {

/// A direction in which segments that cross come apart fastest: perpendicular to both. Where axes
/// cross the distance has a kink, and this is one of its slopes.
Vec4 way_out(const Vec4& v1, const Vec4& v2) {
  const double a = dot3(v1, v1), e = dot3(v2, v2);
  const Vec4 normal = cross3(v1, v2);
  const double length = std::sqrt(dot3(normal, normal));
  if (length > 1e-9 * std::sqrt(a * e)) return broadcast(1.0 / length) * normal;
  const Vec4& longer = a > e ? v1 : v2;
  if (!(dot3(longer, longer) > 0.0)) return Vec4{0.0, 0.0, 1.0, 0.0};
  const double x = std::abs(longer[0]), y = std::abs(longer[1]), z = std::abs(longer[2]);
  const Vec4 across = cross3(longer, x <= y && x <= z ? Vec4{1.0, 0.0, 0.0, 0.0}
                                     : y <= z         ? Vec4{0.0, 1.0, 0.0, 0.0}
                                                      : Vec4{0.0, 0.0, 1.0, 0.0});
  return broadcast(1.0 / std::sqrt(dot3(across, across))) * across;
}

}  // namespace

void SelfCollision::add_if_near(int k, double within) {
  const Pair& p = pair(k);
  const PlacedHull &one = hull(p.hull[0]), &two = hull(p.hull[1]);
  const SegmentDistance nearest = measure(p);
  const double c = one.capsule.radius + two.capsule.radius + margin_ - nearest.distance;
  if (!(c > -within)) return;
  const Vec4 away = nearest.distance > 1e-12 ? broadcast(1.0 / nearest.distance) * nearest.gap
                                             : way_out(one.capsule.half, two.capsule.half);
  Near& near = near_[static_cast<std::size_t>(near_count_++)];
  near.pair = k;
  near.c = c;
  pull(near, 0, one, nearest.t1, -away);
  pull(near, 1, two, nearest.t2, away);
}

void SelfCollision::pull(Near& near, int side, const PlacedHull& hull, double t,
                         const Vec4& force) const {
  const int i = 2 * side, j = i + 1;
  near.point[i] = hull.a;
  near.dc_dpoint[i] = force;
  near.point[j] = -1;
  near.dc_dpoint[j] = Vec4{};
  if (hull.a == hull.b) return;
  // The nearest point is m + t s g. By the envelope theorem t may be held.
  const double lean = t * hull.shape;
  near.point[j] = hull.b;
  near.dc_dpoint[i] = broadcast(0.5 * (1.0 - lean)) * force;
  near.dc_dpoint[j] = broadcast(0.5 * (1.0 + lean)) * force;
  if (hull.rigid) return;
  const double A = hull.semi_major, B = hull.minor, h = std::sqrt(dot3(hull.between, hull.between));
  if (!(h > 1e-12 * A)) return;  // the derivative with respect to h vanishes with it
  const double dc_dh = t * dot3(force, hull.between) * A / (B * (A + B)) - h / B;
  const Vec4 stretch = broadcast(0.5 * dc_dh / h) * hull.between;  // dh/db = g / 2h = -dh/da
  near.dc_dpoint[i] -= stretch;
  near.dc_dpoint[j] += stretch;
}

}  // namespace pdoik::detail
