#pragma once

#include <memory>
#include <string>
#include <vector>

#include "detail/hull_model.hpp"
#include "detail/pair_margins.hpp"
#include "detail/shape_clearance.hpp"
#include "detail/solid.hpp"
#include "pdoik/attachment.hpp"

namespace pdoik::detail {

/// Rules that came with an attachment, shared by all its solids.
using OwnRules = std::shared_ptr<const std::vector<ContactRule>>;

/// A solid that links carry.
struct HeldSolid {
  /// @param links_in  It moves with the first.
  /// @param shape_in  In the first link's frame.
  /// @throws std::invalid_argument  There is no such link, one is named twice or no joint moves it,
  /// or the shape makes no sense or is a half-space.
  HeldSolid(const Robot& robot, std::vector<std::string> links_in, Shape shape_in, OwnRules rules);

  /// Whether one of the links that hold it is on a body.
  bool is_held_by(int body) const;
  /// Whether any link holds both.
  bool is_held_with(const HeldSolid& other) const;

  std::vector<std::string> links;
  std::vector<int> bodies;  ///< of the links
  int body;                 ///< of the first
  Shape shape;
  Solid solid;  ///< in the body's frame
  OwnRules rules;
};

/// What a robot holds, among a scene's shapes: how near each pair may come.
class Held {
 public:
  using Solids = std::vector<std::shared_ptr<const HeldSolid>>;

  Held() = default;
  /// @param hulls  The model's. It outlives this.
  Held(Solids solids, const Robot& robot, const HullModel& hulls, const ShapePairs& shapes,
       const PairMargins& margins);

  int count() const { return static_cast<int>(solids_.size()); }
  const HeldSolid& operator[](int k) const { return *solids_[static_cast<std::size_t>(k)]; }
  const Solids& solids() const { return solids_; }

  /// @name By how much farther than the options say one has to keep off another; minus infinity if
  /// contact does not count [m]
  /// @{

  /// @param hull  Its place in HullModel::all(). Nothing of what holds it counts.
  double hull_margin(int k, int hull) const {
    return hulls_[static_cast<std::size_t>(k * hull_count_ + hull)];
  }
  double shape_margin(int k, int shape) const {
    return shapes_[static_cast<std::size_t>(k * shape_count_ + shape)];
  }
  /// The most of any shape, and at least 0.
  double most_shape_margin(int k) const { return most_[static_cast<std::size_t>(k)]; }
  double point_margin(int k) const { return points_[static_cast<std::size_t>(k)]; }
  /// Of two that one link holds it does not count.
  double held_margin(int k, int other) const {
    return held_[static_cast<std::size_t>(k * count() + other)];
  }
  /// @}

  /// Balls about the solids, in their order: where to look for points.
  const HullModel& balls() const { return balls_; }

 private:
  Solids solids_;
  HullModel balls_;
  std::vector<double> hulls_, shapes_, most_, points_, held_;
  int hull_count_ = 0, shape_count_ = 0;
};

}  // namespace pdoik::detail
