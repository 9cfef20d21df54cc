#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "detail/solid.hpp"

namespace pdoik::detail {

/// What ends a visit of solids.
constexpr double kNoMore = -std::numeric_limits<double>::infinity();

/// Boxes around solids, and around those: what is far from a point is passed over together. What
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

  /// Visit every solid that may be within `reach` of a point, nearer boxes first, and a few more.
  /// Signed distances count: whose box the point is in is visited whatever the reach.
  /// @param visit  visit(solid) gives how far is asked from then on: as far, less, or kNoMore.
  template <class Visit>
  void near(const Vec4& p, double reach, Visit&& visit) const {
    for (const int solid : unbounded_) {
      reach = visit(solid);
      if (reach == kNoMore) return;
    }
    if (nodes_.empty()) return;
    struct Left {
      int node;
      double distance;
    };
    std::array<Left, kDeepest> left;
    std::size_t count = 0;
    left[count++] = {0, distance(0, p)};
    while (count > 0) {
      const auto [at, far] = left[--count];
      // Whoever is inside a box may be deep in what it holds.
      if (far > 0.0 && !(far < reach)) continue;
      const Node& node = nodes_[static_cast<std::size_t>(at)];
      for (int k = node.first; k < node.last; ++k) {
        reach = visit(order_[static_cast<std::size_t>(k)]);
        if (reach == kNoMore) return;
      }
      if (node.child < 0) continue;
      Left one{node.child, distance(node.child, p)},
          other{node.child + 1, distance(node.child + 1, p)};
      if (one.distance < other.distance) std::swap(one, other);
      left[count++] = one;
      left[count++] = other;
    }
  }

 private:
  /// More than a tree of 2^31 solids, halved each time, is deep.
  static constexpr std::size_t kDeepest = 64;

  /// A leaf has solids and no children; another has two, one after the other.
  struct Node {
    Vec4 low, high;
    int first = 0, last = 0;
    int child = -1;
  };
  double distance(int node, const Vec4& p) const {
    const Node& box = nodes_[static_cast<std::size_t>(node)];
    double square = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double off = std::max({box.low[i] - p[i], p[i] - box.high[i], 0.0});
      square += off * off;
    }
    return std::sqrt(square);
  }
  void fill(int node, int first, int last, const std::vector<Node>& boxes);

  std::vector<Node> nodes_;
  std::vector<int> order_, unbounded_;
};

}  // namespace pdoik::detail
