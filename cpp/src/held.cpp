#include "detail/held.hpp"

#include <stdexcept>

#include "detail/frame.hpp"

namespace pdoik::detail {
namespace {

Shape in_body(const Robot& robot, const std::string& link, Shape shape) {
  check_shape(shape);
  if (shape.kind == Shape::Kind::HalfSpace)
    throw std::invalid_argument("'" + shape.name + "' is a half-space, which no link can hold");
  if (shape.kind == Shape::Kind::Mesh || shape.kind == Shape::Kind::Boxes ||
      shape.kind == Shape::Kind::DistanceField)
    throw std::invalid_argument("'" + shape.name +
                                "' is not convex: what a link holds is given as convex pieces");
  shape.T_base_shape = robot.T_body_link(robot.link_index(link)) * shape.T_base_shape;
  return shape;
}

}  // namespace

HeldSolid::HeldSolid(const Robot& robot, std::string link_in, Shape shape_in,
                     std::vector<std::string> may_touch_in)
    : link(std::move(link_in)),
      body(robot.body_of_link(robot.link_index(link))),
      shape(std::move(shape_in)),
      solid(in_body(robot, link, shape)),
      may_touch(std::move(may_touch_in)) {
  if (body == 0) {
    throw std::invalid_argument("no joint moves '" + link + "': what it holds is an obstacle");
  }
}

Held::Held(Solids solids, const Robot& robot, const HullModel& hulls, const ShapePairs& shapes)
    : solids_(std::move(solids)), shape_count_(shapes.count()) {
  const std::vector<Hull> all = hulls.all();
  hull_count_ = static_cast<int>(all.size());
  for (const auto& each : solids_) {
    const auto link_name = [&](int link) {
      return robot.link_names()[static_cast<std::size_t>(link)];
    };
    for (const Hull& hull : all) {
      const auto [a, b] = links_of(robot, hull);
      const bool is_own = moves_with(robot, hulls, hull, each->body) ||
                          (ends_with(robot, robot.body_of_link(a), each->body) &&
                           ends_with(robot, robot.body_of_link(b), each->body));
      hulls_heeded_.push_back(!is_own && !each->may_touch_one(link_name(a)) &&
                              !each->may_touch_one(link_name(b)));
    }
    for (int k = 0; k < shape_count_; ++k)
      shapes_heeded_.push_back(!each->may_touch_one(shapes.shape(k).name));
    const int at = static_cast<int>(balls_.points.size());
    balls_.points.push_back({each->body, each->solid.centre()});
    balls_.moving.push_back({at, at, each->solid.radius(), at});
    for (const auto& other : solids_) {
      held_heeded_.push_back(each->body != other->body && !each->may_touch_one(other->shape.name) &&
                             !other->may_touch_one(each->shape.name));
    }
  }
}

}  // namespace pdoik::detail
