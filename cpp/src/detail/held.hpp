#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "detail/hull_model.hpp"
#include "detail/shape_clearance.hpp"
#include "detail/solid.hpp"

namespace pdoik::detail {

/// A solid that a link carries.
struct HeldSolid {
  /// @param shape_in  In the link's frame.
  /// @throws std::invalid_argument  There is no such link, no joint moves it, or the shape makes no
  /// sense or is a half-space.
  HeldSolid(const Robot& robot, std::string link_in, Shape shape_in,
            std::vector<std::string> may_touch_in);

  /// Whether it may touch what has this name.
  bool may_touch_one(const std::string& name) const {
    return std::find(may_touch.begin(), may_touch.end(), name) != may_touch.end();
  }

  std::string link;
  int body;
  Shape shape;
  Solid solid;                         ///< in the body's frame
  std::vector<std::string> may_touch;  ///< links and shapes by name
};

/// What a robot holds, among a scene's shapes: which pairs may not touch.
class Held {
 public:
  using Solids = std::vector<std::shared_ptr<const HeldSolid>>;

  Held() = default;
  /// @param hulls  The model's. It outlives this.
  Held(Solids solids, const Robot& robot, const HullModel& hulls, const ShapePairs& shapes);

  int count() const { return static_cast<int>(solids_.size()); }
  const HeldSolid& operator[](int k) const { return *solids_[static_cast<std::size_t>(k)]; }
  const Solids& solids() const { return solids_; }
  /// @param hull  Its place in HullModel::all().
  bool heeds_hull(int k, int hull) const {
    return hulls_heeded_[static_cast<std::size_t>(k * hull_count_ + hull)];
  }
  bool heeds_shape(int k, int shape) const {
    return shapes_heeded_[static_cast<std::size_t>(k * shape_count_ + shape)];
  }
  /// Whether two are held by links that move against one another, and may not touch.
  bool heeds_held(int k, int other) const {
    return held_heeded_[static_cast<std::size_t>(k * count() + other)];
  }
  /// Balls about the solids, in their order: where to look for points.
  const HullModel& balls() const { return balls_; }

 private:
  Solids solids_;
  HullModel balls_;
  std::vector<bool> hulls_heeded_, shapes_heeded_, held_heeded_;
  int hull_count_ = 0, shape_count_ = 0;
};

}  // namespace pdoik::detail
