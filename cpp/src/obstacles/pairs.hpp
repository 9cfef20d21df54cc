#pragma once

#include <memory>
#include <vector>

#include "hulls/hull_model.hpp"
#include "hulls/pair_margins.hpp"
#include "obstacles/attachments.hpp"
#include "obstacles/shape_clearance.hpp"

namespace pdoik::detail {

/// A robot with what is attached to it, among a scene's shapes and points: what is kept off what,
/// each pair by its own margin.
struct Pairs {
  /// Of the robot alone.
  explicit Pairs(const PairMargins& of_links) : margins(of_links) {}
  /// @param fixed  The hulls that no joint moves, where they are.
  Pairs(const Robot& robot, const HullModel& hulls, std::shared_ptr<const ShapeSet> shapes,
        Attachments::Solids attached, PairMargins margins, HullCapsules& fixed);

  /// What hulls have of their own beside the margin that is wanted of all; null for nothing.
  const double* of_points() const { return points.empty() ? nullptr : points.data(); }

  PairMargins margins;
  ShapePairs shapes;
  Attachments attachments;
  std::vector<double> points;      ///< margins by the hull's place in the occupancy
  double most_point_margin = 0.0;  ///< of any hull, and at least 0
  /// The deepest shape in a hull that no joint moves.
  ShapeClearance fixed_to_shapes;
};

}  // namespace pdoik::detail
