#include "obstacles/attachments.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/frame.hpp"

namespace pdoik::detail {
namespace {

constexpr double kContactIgnored = -std::numeric_limits<double>::infinity();

Shape in_body(const Robot& robot, const std::string& link, Shape shape) {
  check_shape(shape);
  if (shape.kind == Shape::Kind::HalfSpace)
    throw std::invalid_argument("'" + shape.name +
                                "' is a half-space, which can be attached to no link");
  if (shape.kind == Shape::Kind::Mesh || shape.kind == Shape::Kind::Boxes ||
      shape.kind == Shape::Kind::DistanceField)
    throw std::invalid_argument("'" + shape.name +
                                "' is not convex: what a link holds is given as convex pieces");
  shape.T_base_shape = robot.T_body_link(robot.link_index(link)) * shape.T_base_shape;
  return shape;
}

/// The bodies of the links that a shape is to be attached to.
std::vector<int> bodies_of(const Robot& robot, const std::vector<std::string>& links,
                           const Shape& shape) {
  if (links.empty()) throw std::invalid_argument("no link is to hold '" + shape.name + "'");
  std::vector<int> bodies;
  for (const std::string& link : links) {
    if (std::ranges::count(links, link) > 1)
      throw std::invalid_argument("'" + link + "' is to hold '" + shape.name + "' twice");
    bodies.push_back(robot.body_of_link(robot.link_index(link)));
    if (bodies.back() == 0)
      throw std::invalid_argument("no joint moves '" + link + "': what it holds is an obstacle");
  }
  return bodies;
}

}  // namespace

AttachedSolid::AttachedSolid(const Robot& robot, std::vector<std::string> links_in, Shape shape_in,
                             OwnRules rules_in)
    : links(std::move(links_in)),
      bodies(bodies_of(robot, links, shape_in)),
      body(bodies.front()),
      shape(std::move(shape_in)),
      solid(in_body(robot, links.front(), shape)),
      rules(std::move(rules_in)) {}

bool AttachedSolid::is_attached_to(int of) const { return std::ranges::count(bodies, of) > 0; }

bool AttachedSolid::is_attached_with(const AttachedSolid& other) const {
  return std::ranges::any_of(bodies, [&](int of) { return other.is_attached_to(of); });
}

Attachments::Attachments(Solids solids, const Robot& robot, const HullModel& hulls,
                         const ShapePairs& shapes, const PairMargins& margins)
    : solids_(std::move(solids)), shape_count_(shapes.count()) {
  const std::vector<Hull> all = hulls.all();
  hull_count_ = static_cast<int>(all.size());
  for (int k = 0; k < count(); ++k) {
    const AttachedSolid& each = (*this)[k];
    const PairMargins::Mover own = margins.of_attached(k);
    for (const Hull& hull : all) {
      const auto [a, b] = seat_of(robot, hulls, hull);
      const bool is_own = std::ranges::any_of(each.bodies, [&](int body) {
        return moves_with(robot, hulls, hull, body) ||
               (ends_with(robot, robot.body_of_link(a), body) &&
                ends_with(robot, robot.body_of_link(b), body));
      });
      hulls_.push_back(is_own ? kContactIgnored : margins.between(own, {a, b}));
    }
    most_.push_back(0.0);
    for (int shape = 0; shape < shape_count_; ++shape) {
      shapes_.push_back(margins.to_shape(own, shape));
      most_.back() = std::max(most_.back(), shapes_.back());
    }
    points_.push_back(margins.to_points(own));
    for (int other = 0; other < count(); ++other) {
      others_.push_back(each.is_attached_with((*this)[other])
                            ? kContactIgnored
                            : margins.between(own, margins.of_attached(other)));
    }
    const int at = static_cast<int>(balls_.points.size());
    balls_.points.push_back({each.body, each.solid.centre()});
    balls_.moving.push_back({at, at, each.solid.radius(), at});
  }
}

}  // namespace pdoik::detail
