#include "hulls/self_collision.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>

#include "common/infinity.hpp"
#include "shapes/convex_distance.hpp"

namespace pdoik::detail {
namespace {

constexpr double kRounding = 1e-12;  // [m]

/// Which links a hull sits on, and which bodies all of it moves with.
class Seat {
 public:
  Seat(const Robot& robot, const HullModel& model, const Hull& hull) : robot_(robot) {
    std::tie(given_a_, given_b_) = links_of(robot, hull);
    settled_a_ = model.points[static_cast<std::size_t>(hull.a)].body;
    settled_b_ = model.points[static_cast<std::size_t>(hull.b)].body;
    // Capsules move with their body, wherever on an axis that lies which says where to look.
    if (hull.has_capsules()) settled_a_ = settled_b_ = hull.body;
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
  double margin_to(const Seat& other, const PairMargins& margins) const {
    return margins.between({first_, second_}, {other.first_, other.second_});
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

SelfCollision::SelfCollision(const Robot& robot, const HullModel& model, double margin,
                             const PairMargins& margins)
    : capsules_(robot, model, model.all(), margin),
      margin_(margin),
      has_capsules_(!model.blocks.empty()) {
  std::vector<Seat> seats;
  const std::vector<Hull> hulls = model.all();
  for (const Hull& hull : hulls) seats.emplace_back(robot, model, hull);
  for (std::size_t i = 0; i < seats.size(); ++i) {
    for (std::size_t j = i + 1; j < seats.size(); ++j) {
      const Seat &one = seats[i], &two = seats[j];
      const double more = one.margin_to(two, margins);
      if (std::isinf(more) || one.is_neighbour_of(two) || one.is_rigid_to(two)) continue;
      const int a = static_cast<int>(i), b = static_cast<int>(j);
      pairs_.push_back({{hulls[i].source, hulls[j].source}, {one.first(), two.first()}, {a, b}});
      glances_.push_back({a, b, capsules_.semi_major(a) + capsules_.semi_major(b), more});
    }
  }
  near_.resize(pairs_.size());
  unsure_.reserve(pairs_.size());
  for (std::vector<Standing>& side : standing_) side.reserve(capsules_.most());
}

void SelfCollision::place(const Vec4* positions, const Frame* frames) {
  near_count_ = 0;
  capsules_.place(positions, frames);
}

namespace {

/// Those of some capsules that stand farther along a direction than `from`, and how far they do;
/// the farthest comes first.
/// @return  How far that one stands.
double stand_beyond(std::span<const PlacedCapsule> capsules, const Vec4& direction, double from,
                    std::vector<Standing>& out) {
  out.clear();
  for (const PlacedCapsule& capsule : capsules) {
    const double stands =
        dot3(capsule.middle, direction) + std::abs(dot3(capsule.half, direction)) + capsule.radius;
    if (!(stands > from)) continue;
    out.push_back({&capsule, stands});
    if (stands > out.front().stands) std::swap(out.front(), out.back());
  }
  return out.empty() ? -kInfinity : out.front().stands;
}

}  // namespace

SelfCollision::Nearest SelfCollision::nearest_of_many(const Glance& pair, double than) {
  const int one = pair.a, two = pair.b;
  // Capsules lie within the ones that hold their hulls, but for their excess.
  const double excess = capsules_.excess(one) + capsules_.excess(two) + kRounding;
  const PlacedCapsule &around_one = capsules_.around(one), &around_two = capsules_.around(two);
  const SegmentDistance outer =
      segment_distance(around_one.middle, around_one.half, around_two.middle, around_two.half);
  const double least = outer.distance - around_one.radius - around_two.radius - excess;
  if (!(least < than)) return {};

  // Along any direction two capsules are at least as far apart as what they stand out along it.
  const Vec4 apart = around_one.middle - around_two.middle;
  const Vec4& across = outer.distance > kRounding ? outer.gap : apart;
  const double length = std::sqrt(dot3(across, across));
  const Vec4 to_one = length > kRounding ? broadcast(1.0 / length) * across : Vec4{1, 0, 0, 0};
  const std::span<const PlacedCapsule> ones = capsules_.of(one), twos = capsules_.of(two);
  const double from = -than - kRounding;
  const double far_one = stand_beyond(ones, -to_one, -kInfinity, standing_[0]);
  const double far_two = stand_beyond(twos, to_one, from - far_one, standing_[1]);
  Nearest nearest;
  nearest.distance = than;
  for (const Standing& a : standing_[0]) {
    if (!(a.stands + far_two > -nearest.distance - kRounding)) continue;
    for (const Standing& b : standing_[1]) {
      if (!(a.stands + b.stands > -nearest.distance - kRounding)) continue;
      const Vec4 between = a.capsule->middle - b.capsule->middle;
      const double bound = nearest.distance + a.capsule->reach + b.capsule->reach;
      if (!(bound > 0.0) || dot3(between, between) >= bound * bound) continue;
      const SegmentDistance found =
          segment_distance(a.capsule->middle, a.capsule->half, b.capsule->middle, b.capsule->half);
      const double distance = found.distance - a.capsule->radius - b.capsule->radius;
      if (distance < nearest.distance) nearest = {distance, found, a.capsule, b.capsule};
    }
  }
  return nearest;
}

bool SelfCollision::needs_pieces(const Glance& pair, const Nearest& nearest) const {
  if (nearest.one == nullptr || nearest.distance < -(nearest.one->overhang + nearest.two->overhang))
    return false;
  const double apart = nearest.distance - pair.margin;
  return !capsules_.pieces_at(pair.a, apart).empty() && !capsules_.pieces_at(pair.b, apart).empty();
}

int SelfCollision::piece_about(int hull, const Vec4& point, double distance) const {
  const Vec4 local = to_local(capsules_.frame(hull), point);
  int about = -1;
  double least = kInfinity;
  for (const int k : capsules_.pieces_at(hull, distance)) {
    const Solid& piece = capsules_.piece(k);
    const Vec4 apart = local - piece.centre();
    const double off = dot3(apart, apart) / (piece.radius() * piece.radius());
    if (off >= least) continue;
    least = off;
    about = k;
  }
  return about;
}

void SelfCollision::look_at_pieces(const Glance& pair, double than, Wanted wanted,
                                   Nearest& nearest) {
  const HowDeep how_deep = wanted == Wanted::Any ? HowDeep::Unknown : HowDeep::Measured;
  const double apart = nearest.distance - pair.margin;
  // In the frame of the second one's body, which then stands still.
  const Frame& its = capsules_.frame(pair.b);
  const Frame relative = to_local(its, capsules_.frame(pair.a));
  ConvexDistance exact{than, {}, {}};
  bool is_any = false, is_first = true;
  const auto look = [&](int one, int two) {
    const Solid &moving = capsules_.piece(one), &still = capsules_.piece(two);
    // What separates the nearest, or what was looked at first, separates most of the others.
    if (!is_first && separation(moving, relative, still, exact.gradient) >= exact.distance) return;
    ++looks_;
    const ConvexDistance found = convex_distance(moving, relative, still, exact.distance, how_deep);
    if (found.distance < exact.distance) {
      exact = found;
      is_any = true;
    } else if (is_first) {
      exact.gradient = found.gradient;
    }
    is_first = false;
  };
  // First where their capsules are nearest.
  const Vec4 at_one = nearest.one->middle + broadcast(nearest.segments.t1) * nearest.one->half,
             at_two = nearest.two->middle + broadcast(nearest.segments.t2) * nearest.two->half;
  const int first_one = piece_about(pair.a, at_one, apart),
            first_two = piece_about(pair.b, at_two, apart);
  look(first_one, first_two);
  const auto is_told = [&] { return is_any && wanted == Wanted::Any; };
  for (const int one : capsules_.pieces_at(pair.a, apart)) {
    const Vec4 centre = transform(relative, capsules_.piece(one).centre());
    const double radius = capsules_.piece(one).radius();
    for (const int two : capsules_.pieces_at(pair.b, apart)) {
      if (is_told()) break;
      if (one == first_one && two == first_two) continue;
      if (capsules_.piece(two).bound(centre, radius) < exact.distance) look(one, two);
    }
  }
  if (!is_any) {
    nearest = {};
    return;
  }
  // Their capsules may be farther than pieces that reach into other hulls'.
  if (exact.distance <= nearest.distance) return;
  nearest.distance = exact.distance;
  nearest.by_pieces = true;
  nearest.point = transform(its, exact.point);
  nearest.away = rotate(its, exact.gradient);
}

bool SelfCollision::any_touches() {
  unsure_.clear();
  const Vec4* const middles = capsules_.middles();
  for (int k = 0; k < pair_count(); ++k) {
    const Glance& pair = glance(k);
    const double than = margin_ + pair.margin;
    if (!pair.is_within(middles, than)) continue;
    const Nearest found = nearest_of_capsules(pair, than);
    if (found.one == nullptr) continue;
    if (!needs_pieces(pair, found)) return true;
    unsure_.emplace_back(found.distance - than, k);
  }
  std::sort(unsure_.begin(), unsure_.end());
  return std::any_of(unsure_.begin(), unsure_.end(),
                     [&](const auto& each) { return is_nearer(each.second, 0.0); });
}

double SelfCollision::distance(int k) { return nearest(glance(k), kInfinity).distance; }

SelfCollision::Least SelfCollision::least() {
  // The most promising pair first: most of the others need no exact distance then.
  const Vec4* const middles = capsules_.middles();
  Least least;
  double lowest = kInfinity;
  for (int k = 0; k < pair_count(); ++k) {
    const Glance& pair = glance(k);
    const Vec4 apart = middles[pair.a] - middles[pair.b];
    const double size = pair.semi_major + pair.margin;
    const double promise = dot3(apart, apart) - size * size;
    if (promise < lowest) {
      lowest = promise;
      least.pair = k;
    }
  }
  const int promising = least.pair;
  if (promising < 0) return least;
  const auto try_pair = [&](int k) {
    const Nearest found = nearest(glance(k), least.distance + glance(k).margin);
    if (found.one == nullptr) return;
    least = {found.distance - glance(k).margin, k, {found.one->source, found.two->source}};
  };
  try_pair(promising);
  for (int k = 0; k < pair_count(); ++k)
    if (k != promising && glance(k).is_within(middles, least.distance + glance(k).margin))
      try_pair(k);
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
  const double margin = margin_ + glance(k).margin;
  const Nearest found = nearest(glance(k), margin + within);
  if (found.one == nullptr) return;
  if (found.by_pieces) {
    Near& near = near_[static_cast<std::size_t>(near_count_++)];
    near = {k, margin - found.distance, {}};
    capsules_.add_piece_gradient(pair(k).hull[0], found.point, -found.away, near.gradients);
    capsules_.add_piece_gradient(pair(k).hull[1], found.point, found.away, near.gradients);
    return;
  }
  const SegmentDistance& segments = found.segments;
  const Vec4 away = segments.distance > 1e-12 ? broadcast(1.0 / segments.distance) * segments.gap
                                              : way_out(found.one->half, found.two->half);
  Near& near = near_[static_cast<std::size_t>(near_count_++)];
  near.pair = k;
  near.c = margin - found.distance;
  near.gradients.count = 0;
  capsules_.add_gradient(pair(k).hull[0], *found.one, segments.t1, -away, near.gradients);
  capsules_.add_gradient(pair(k).hull[1], *found.two, segments.t2, away, near.gradients);
}

}  // namespace pdoik::detail
