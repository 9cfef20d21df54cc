#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "shapes/solid.hpp"

namespace pdoik::detail {

/// What ends a visit of solids.
constexpr double kNoMore = -std::numeric_limits<double>::infinity();

/// Boxes around solids, and around those: what is far from a segment is passed over together. What
/// has no bounds, a half-space, is near everything.
class ShapeTree {
 public:
  ShapeTree() = default;
  explicit ShapeTree(const std::vector<Solid>& solids);

  /// How many of so many solids are looked at about a point: all of a few, of many a few more each
  /// time their number is doubled.
  static double usually_seen(int solids) {
    constexpr double kFew = 32.0, kMore = 4.0;
    return solids <= kFew ? solids : kFew + kMore * std::log2(solids / kFew);
  }

  /// Visit every solid that may be within `reach` of a segment's points, middle + t half with
  /// -1 <= t <= 1, nearer boxes first, and a few more. Signed distances count: of a negative reach
  /// those are left out that no point of the segment can be so deep in, by the balls around them.
  /// @param visit  visit(solid) gives how far is asked from then on: as far, less, or kNoMore.
  template <class Visit>
  void near(const Vec4& middle, const Vec4& half, double reach, Visit&& visit) const {
    for (const int solid : unbounded_) {
      reach = visit(solid);
      if (reach == kNoMore) return;
    }
    if (nodes_.empty()) return;
    struct Left {
      int node;
      double square;  ///< of how far its box is from that of the segment
    };
    std::array<Left, kDeepest> left;
    std::size_t count = 0;
    const Segment segment(middle, half);
    left[count++] = {0, segment.square_to(nodes_[0].middle, nodes_[0].half)};
    while (count > 0) {
      const auto [at, square] = left[--count];
      // What is inside a box may be deep in what that holds.
      if (square > 0.0 && !(reach > 0.0 && square < reach * reach)) continue;
      const Node& node = nodes_[static_cast<std::size_t>(at)];
      if (!segment.is_near(node.middle, node.radius + reach)) continue;
      for (int k = node.first; k < node.last; ++k) {
        const Ball& ball = balls_[static_cast<std::size_t>(k)];
        if (!segment.is_near(ball.middle, ball.radius + reach)) continue;
        reach = visit(ball.solid);
        if (reach == kNoMore) return;
      }
      if (node.child < 0) continue;
      const Node* const children = &nodes_[static_cast<std::size_t>(node.child)];
      Left one{node.child, segment.square_to(children[0].middle, children[0].half)},
          other{node.child + 1, segment.square_to(children[1].middle, children[1].half)};
      if (one.square < other.square) std::swap(one, other);
      left[count++] = one;
      left[count++] = other;
    }
  }

 private:
  /// More than a tree of 2^31 solids, halved each time, is deep.
  static constexpr std::size_t kDeepest = 64;

  /// A leaf has balls and no children; another has two, one after the other.
  struct Node {
    Vec4 middle, half;
    double radius = 0.0;  ///< of the ball around the box
    int first = 0, last = 0;
    int child = -1;
  };
  /// Around a solid.
  struct Ball {
    Vec4 middle;
    double radius;
    int solid;
  };
  struct Segment {
    Segment(const Vec4& middle_in, const Vec4& half_in)
        : middle(middle_in), half(half_in), wide(size_of(half_in)) {
      const double square = dot3(half, half);
      per_square = square > 0.0 ? 1.0 / square : 0.0;
    }
    /// The square of the distance between a box and the one around it.
    double square_to(const Vec4& box_middle, const Vec4& box_half) const {
      const Vec4 gap = size_of(middle - box_middle) - wide - box_half;
      const Vec4 apart = gap > 0.0 ? gap : Vec4{};
      return dot3(apart, apart);
    }
    /// Whether it comes nearer to a point than this.
    bool is_near(const Vec4& point, double within) const {
      const Vec4 from = middle - point;
      const double t = std::clamp(-dot3(from, half) * per_square, -1.0, 1.0);
      const Vec4 off = from + broadcast(t) * half;
      return within > 0.0 && dot3(off, off) < within * within;
    }
    Vec4 middle, half, wide;
    double per_square;
  };
  static Vec4 size_of(const Vec4& v) { return v < 0.0 ? -v : v; }

  /// Of a solid's box.
  struct Corners {
    Vec4 low, high;
  };
  void fill(int node, int first, int last, std::vector<int>& order,
            const std::vector<Corners>& corners);

  std::vector<Node> nodes_;
  std::vector<Ball> balls_;  ///< of the leaves, in their order
  std::vector<int> unbounded_;
};

}  // namespace pdoik::detail
