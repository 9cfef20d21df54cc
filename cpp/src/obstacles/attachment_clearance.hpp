#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "common/deadline.hpp"
#include "obstacles/attachments.hpp"
#include "obstacles/collision_state.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "shapes/convex_distance.hpp"

namespace pdoik::detail {

/// What an attached solid is near to.
struct AttachmentNear {
  WorstConstraint::Kind kind = WorstConstraint::Kind::None;  ///< of those of attachments
  int attached = -1;
  int other =
      -1;  ///< the point's id, the shape, the hull's place in the occupancy, the other attached
  /// Beyond what is wanted of the pair [m].
  double distance = std::numeric_limits<double>::infinity();
  int slot = 0;              ///< of the pair, the same from one configuration to another
  PointGradients gradients;  ///< the derivatives of minus the distance
};

/// Distances of what is attached to the robot from points, shapes, its own hulls and one another.
/// The state of one thread. Allocates at construction only.
class AttachmentClearance {
 public:
  /// All outlive it.
  AttachmentClearance(const Robot& robot, const HullModel& hulls, const Options& options,
                      const Attachments& attached);

  int count() const { return attachments_.count(); }
  /// The robot's.
  int hulls() const { return hull_capsules_.count(); }
  /// At most so many are found at once.
  /// @param parts  Of shapes that there are.
  int most(int parts) const {
    return count() * (1 + std::min(parts, kMostParts) + hull_capsules_.count() + count());
  }

  /// Where the bodies' frames and the robot's attached points are, which are read until the next.
  template <class FrameOf>
  void place(FrameOf&& frame_of, const Vec4* positions, const Frame* frames) {
    for (int k = 0; k < count(); ++k) place_solid(k, frame_of(attachments_[k].body));
    hull_capsules_.place(positions, frames);
  }
  /// One of them alone, where its body is.
  void place_solid(int k, const Frame& frame) {
    frames_[static_cast<std::size_t>(k)] = frame;
    balls_.place(static_cast<std::size_t>(k), transform(frame, attachments_[k].solid.centre()));
  }

  /// Calls visit(AttachmentNear) for the nearest point, and each part of shapes, hull and other
  /// that is attached, within a distance of what is wanted; of more than kMostParts some are left
  /// to the judge.
  /// @returns Whether it has looked at all
  /// before the deadline, which may be null.
  template <class Visit>
  bool find(const ObstacleView& points, const ShapePairs& shapes, double within,
            const Deadline* deadline, Visit&& visit) {
    constexpr int kBetweenLooks = 32;  // pairs of solids, which take longer than others
    int slot = 0;
    const auto report = [&](std::optional<AttachmentNear> near) {
      if (near) {
        near->slot = slot;
        visit(*near);
      }
      ++slot;
    };
    for (int k = 0; k < count(); ++k) {
      report(nearest_point(k, points, within));
      const int first = slot;
      bool is_late = false;
      int turn = 0, visited = 0;
      shapes_near(k, shapes, within, [&](int part) {
        is_late = passed_in(turn++, deadline, kBetweenLooks);
        if (is_late || visited == kMostParts) return kNoMore;
        slot = first + part;
        const std::optional<AttachmentNear> near = nearest_of_part(k, shapes, part, within);
        visited += near ? 1 : 0;
        report(near);
        return within;
      });
      if (is_late) return false;
      slot = first + shapes.parts();
      for (int hull = 0; hull < hull_capsules_.count(); ++hull)
        report(nearest_of_hull(k, hull, within));
      for (int other = 0; other < k; ++other) report(nearest_of_attached(k, other, within));
    }
    return true;
  }
  /// The nearest point to a solid, if within a distance; the same of a part of a shape, of a hull,
  /// and of what is attached to another link.
  std::optional<AttachmentNear> nearest_point(int k, const ObstacleView& points, double within);
  std::optional<AttachmentNear> nearest_of_part(int k, const ShapePairs& shapes, int part,
                                                double within) const;
  /// The same of the nearest of all shapes.
  std::optional<AttachmentNear> nearest_shape(int k, const ShapePairs& shapes, double within) const;
  std::optional<AttachmentNear> nearest_of_hull(int k, int hull, double within);
  std::optional<AttachmentNear> nearest_of_attached(int k, int other, double within) const;

 private:
  static constexpr int kMostParts = 64;

  /// Visit the parts of shapes that may be within a distance of a solid.
  template <class Visit>
  void shapes_near(int k, const ShapePairs& shapes, double within, Visit&& visit) const {
    const Solid& solid = attachments_[k].solid;
    const double size = solid.radius() + clearance_ + attachments_.most_shape_margin(k);
    shapes.near(transform(frame(k), solid.centre()), Vec4{}, size + within,
                [&](int part) { return size + visit(part); });
  }
  const Frame& frame(int k) const { return frames_[static_cast<std::size_t>(k)]; }

  const Attachments& attachments_;
  double clearance_, self_clearance_;
  CollisionState balls_;
  HullCapsules hull_capsules_;
  std::vector<Frame> frames_;  ///< of the bodies that they are attached to
};

}  // namespace pdoik::detail
