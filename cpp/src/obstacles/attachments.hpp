#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hulls/hull_model.hpp"
#include "hulls/pair_margins.hpp"
#include "obstacles/shape_clearance.hpp"
#include "pdoik/attachment.hpp"
#include "shapes/solid.hpp"

namespace pdoik::detail {

/// Rules that came with an attachment, shared by all its solids.
using OwnRules = std::shared_ptr<const std::vector<ContactRule>>;

/// A solid that is attached to links.
struct AttachedSolid {
  /// @param links_in  It moves with the first.
  /// @param shape_in  In the first link's frame.
  /// @throws std::invalid_argument  There is no such link, one is named twice or no joint moves it,
  /// or the shape makes no sense or is a half-space.
  AttachedSolid(const Robot& robot, std::vector<std::string> links_in, Shape shape_in,
                OwnRules rules);

  /// Whether one of its links is on a body.
  bool is_attached_to(int body) const;
  /// Whether both are attached to one link.
  bool is_attached_with(const AttachedSolid& other) const;

  std::vector<std::string> links;
  std::vector<int> bodies;  ///< of the links
  int body;                 ///< of the first
  Shape shape;
  Solid solid;  ///< in the body's frame
  OwnRules rules;
};

/// What is attached to a robot, among a scene's shapes: how near each pair may come.
class Attachments {
 public:
  using Solids = std::vector<std::shared_ptr<const AttachedSolid>>;

  Attachments() = default;
  /// @param hulls  The model's. It outlives this.
  Attachments(Solids solids, const Robot& robot, const HullModel& hulls, const ShapePairs& shapes,
              const PairMargins& margins);

  int count() const { return static_cast<int>(solids_.size()); }
  const AttachedSolid& operator[](int k) const { return *solids_[static_cast<std::size_t>(k)]; }
  const Solids& solids() const { return solids_; }

  /// @name By how much farther than the options say one has to keep off another; minus infinity if
  /// contact does not count [m]
  /// @{

  /// @param hull  Its place in HullModel::all(). Nothing of what it is attached to counts.
  double hull_margin(int k, int hull) const {
    return hulls_[static_cast<std::size_t>(k * hull_count_ + hull)];
  }
  double shape_margin(int k, int shape) const {
    return shapes_[static_cast<std::size_t>(k * shape_count_ + shape)];
  }
  /// The most of any shape, and at least 0.
  double most_shape_margin(int k) const { return most_[static_cast<std::size_t>(k)]; }
  double point_margin(int k) const { return points_[static_cast<std::size_t>(k)]; }
  /// Of two that are attached to one link it does not count.
  double attached_margin(int k, int other) const {
    return others_[static_cast<std::size_t>(k * count() + other)];
  }
  /// @}

  /// Balls about the solids, in their order: where to look for points.
  const HullModel& balls() const { return balls_; }

 private:
  Solids solids_;
  HullModel balls_;
  std::vector<double> hulls_, shapes_, most_, points_, others_;
  int hull_count_ = 0, shape_count_ = 0;
};

}  // namespace pdoik::detail
