#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "common/frame.hpp"
#include "pdoik/shape.hpp"
#include "shapes/field_data.hpp"
#include "shapes/solid_distance.hpp"
#include "shapes/triangle.hpp"

namespace pdoik::detail {

/// A convex shape, a part of another, or a field of distances, made ready for distances.
class Solid {
 public:
  /// @param shape  One that check_shape lets by, neither a mesh of any form nor several boxes.
  explicit Solid(const Shape& shape);
  /// A part of a surface, of no thickness.
  /// @param triangles  One at least.
  /// @param is_closed  Whether what is behind them is inside.
  Solid(std::vector<Triangle> triangles, bool is_closed);

  SolidDistance distance(const Vec4& p) const;
  /// @param middle, half  The segment's points are middle + t half, -1 <= t <= 1.
  /// @param than  Where nothing is nearer than this, any number not below it may come back.
  SegmentSolidDistance distance(const Vec4& middle, const Vec4& half, double than) const;

  /// At most the distance of all within `radius` of p, which is at least 0.
  double bound(const Vec4& p, double radius) const {
    if (kind_ == Shape::Kind::HalfSpace) return dot3(T_.z, p - T_.p) - radius;
    if (is_field()) return distance(p).distance - steepest_ * radius;
    const Vec4 from = p - centre_;
    return std::sqrt(dot3(from, from)) - radius_ - radius;
  }

  /// At most the distance of all within `radius` of the segment middle + t half, -1 <= t <= 1: of a
  /// box and a cylinder by what lies between along its axes, of others by the ball around.
  double bound(const Vec4& middle, const Vec4& half, double radius) const {
    if (kind_ == Shape::Kind::HalfSpace) return bound(middle, std::sqrt(dot3(half, half)) + radius);
    if (is_field())
      return distance(middle).distance - steepest_ * std::sqrt(dot3(half, half)) - radius;
    if (kind_ != Shape::Kind::Box && kind_ != Shape::Kind::Cylinder)
      return distance_to_segment(centre_, middle, half) - radius_ - radius;
    const Vec4 from = middle - T_.p;
    const auto gap = [](double along, double wide, double half_edge) {
      return std::max(std::abs(along) - std::abs(wide) - half_edge, 0.0);
    };
    const double z = dot3(T_.z, from), hz = dot3(T_.z, half), x = dot3(T_.x, from),
                 hx = dot3(T_.x, half), y = dot3(T_.y, from), hy = dot3(T_.y, half);
    if (kind_ == Shape::Kind::Cylinder) {
      const double aside = gap(std::hypot(x, y), std::hypot(hx, hy), half_[0]);
      const double apart = std::hypot(aside, gap(z, hz, half_[1]));
      return apart > 0.0 ? apart - radius : -std::numeric_limits<double>::infinity();
    }
    const double gx = gap(x, hx, half_[0]), gy = gap(y, hy, half_[1]), gz = gap(z, hz, half_[2]);
    const double apart2 = gx * gx + gy * gy + gz * gz;
    return apart2 > 0.0 ? std::sqrt(apart2) - radius : -std::numeric_limits<double>::infinity();
  }

  /// What the distance of a point changes by at most as it moves, per length: 1 but of a field.
  double steepest() const { return steepest_; }

  const Vec4& centre() const { return centre_; }
  /// Of a mesh.
  const std::vector<Triangle>& faces() const { return faces_; }
  /// Whether it is a part of a surface, from which distances have no sign.
  bool is_surface() const { return kind_ == Shape::Kind::Mesh; }
  bool is_field() const { return kind_ == Shape::Kind::DistanceField; }
  /// Of a field, whose frame is `frame`.
  const FieldData& field() const { return *field_; }
  const Frame& frame() const { return T_; }
  /// The convex pieces that it is made of.
  int pieces() const { return is_surface() ? static_cast<int>(faces_.size()) : 1; }

  /// Of a ball about its centre that holds it; infinite for a half-space [m].
  double radius() const { return radius_; }
  bool is_half_space() const { return kind_ == Shape::Kind::HalfSpace; }
  /// Out of a half-space.
  const Vec4& normal() const { return T_.z; }

  /// The farthest point along a direction, of any length but 0, of what lies this much within the
  /// solid's surface: a ball's centre, a capsule's segment, all of the others; of a field of a box
  /// around it. Not of a half-space.
  Vec4 support(const Vec4& direction) const;
  /// The same of one of its pieces.
  Vec4 support_of(int piece, const Vec4& direction) const;
  /// What a ball or a capsule is within rounding() of: centre() and this much either side.
  Vec4 half_axis() const {
    return kind_ == Shape::Kind::Capsule ? broadcast(half_[1]) * T_.z : Vec4{};
  }
  double rounding() const {
    return kind_ == Shape::Kind::Sphere || kind_ == Shape::Kind::Capsule ? half_[0] : 0.0;
  }

 private:
  SolidDistance local_distance(const Vec4& p) const;
  SolidDistance mesh_distance(const Vec4& p) const;
  SegmentSolidDistance surface_distance(const Vec4& middle, const Vec4& half, double than) const;

  Shape::Kind kind_;
  Frame T_;        ///< its frame, or the base's for a mesh
  Vec4 half_{};    ///< half the edges; or radius and half length
  Vec4 centre_{};  ///< of a ball that holds it
  double radius_ = 0.0;
  std::vector<Triangle> faces_;
  std::vector<Vec4> vertices_;  ///< of a convex mesh
  bool is_closed_ = true;
  std::shared_ptr<const FieldData> field_;
  double steepest_ = 1.0;
};

}  // namespace pdoik::detail
