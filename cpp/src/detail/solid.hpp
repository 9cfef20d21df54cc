#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "detail/frame.hpp"
#include "pdoik/shape.hpp"

namespace pdoik::detail {

/// The signed distance of a point from a solid's surface, negative inside, and its derivative.
struct SolidDistance {
  double distance;
  Vec4 gradient;  ///< a unit vector, away from the solid
};

/// Where a segment comes nearest to a solid, or lies deepest in it by the signed distance of its
/// points: exact outside; inside, no less deep than a way out of the solid for each of its points.
struct SegmentSolidDistance {
  double distance;
  Vec4 point;     ///< on the segment
  Vec4 gradient;  ///< how the distance changes as the segment's body moves that point
};

/// A shape made ready for distances.
class Solid {
 public:
  /// @throws std::invalid_argument  As check_shape.
  explicit Solid(const Shape& shape);

  SolidDistance distance(const Vec4& p) const;
  /// @param middle, half  The segment's points are middle + t half, -1 <= t <= 1.
  /// @param than  Where nothing is nearer than this, any number not below it may come back.
  SegmentSolidDistance distance(const Vec4& middle, const Vec4& half, double than) const;

  /// At most the distance of all within `radius` of p.
  double bound(const Vec4& p, double radius) const {
    if (kind_ == Shape::Kind::HalfSpace) return dot3(T_.z, p - T_.p) - radius;
    const Vec4 from = p - centre_;
    return std::sqrt(dot3(from, from)) - radius_ - radius;
  }

  /// At most the distance of all within `radius` of the segment middle + t half, -1 <= t <= 1: of a
  /// box and a cylinder by what lies between along its axes.
  double bound(const Vec4& middle, const Vec4& half, double radius) const {
    if (kind_ != Shape::Kind::Box && kind_ != Shape::Kind::Cylinder)
      return bound(middle, std::sqrt(dot3(half, half)) + radius);
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

  const Vec4& centre() const { return centre_; }
  /// Of a ball about its centre that holds it; infinite for a half-space [m].
  double radius() const { return radius_; }
  bool is_half_space() const { return kind_ == Shape::Kind::HalfSpace; }
  /// Out of a half-space.
  const Vec4& normal() const { return T_.z; }

  /// The farthest point along a direction, of any length but 0, of what lies this much within the
  /// solid's surface: a ball's centre, a capsule's segment, all of the others. Not of a half-space.
  Vec4 support(const Vec4& direction) const;
  double rounding() const {
    return kind_ == Shape::Kind::Sphere || kind_ == Shape::Kind::Capsule ? half_[0] : 0.0;
  }

 private:
  struct Face {
    Vec4 a, ab, ac;  ///< a corner and two edges
    Vec4 normal;     ///< out of the solid, of length 1
    double offset;   ///< normal . a
    double ab2, abac, ac2, determinant;
  };
  SolidDistance local_distance(const Vec4& p) const;
  SolidDistance mesh_distance(const Vec4& p) const;

  Shape::Kind kind_;
  Frame T_;        ///< its frame, or the base's for a mesh
  Vec4 half_{};    ///< half the edges; or radius and half length
  Vec4 centre_{};  ///< of a ball that holds it
  double radius_ = 0.0;
  std::vector<Face> faces_;
  std::vector<Vec4> vertices_;  ///< of a mesh
};

}  // namespace pdoik::detail
