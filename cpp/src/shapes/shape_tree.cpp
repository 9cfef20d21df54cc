#include "shapes/shape_tree.hpp"

#include <algorithm>
#include <numeric>

#include "common/infinity.hpp"

namespace pdoik::detail {
namespace {

constexpr int kLeaf = 8;  ///< so many solids are looked at one by one

}  // namespace

ShapeTree::ShapeTree(const std::vector<Solid>& solids) {
  std::vector<Corners> corners(solids.size());
  std::vector<int> order;
  for (std::size_t k = 0; k < solids.size(); ++k) {
    const Solid& solid = solids[k];
    if (solid.is_half_space()) {
      unbounded_.push_back(static_cast<int>(k));
      continue;
    }
    order.push_back(static_cast<int>(k));
    for (int i = 0; i < 3; ++i) {
      Vec4 along{};
      along[i] = 1.0;
      corners[k].high[i] = solid.support(along)[i] + solid.rounding();
      corners[k].low[i] = solid.support(-along)[i] - solid.rounding();
    }
  }
  if (order.empty()) return;
  nodes_.reserve(2 * order.size());
  nodes_.emplace_back();
  fill(0, 0, static_cast<int>(order.size()), order, corners);
  for (const int k : order) {
    const Solid& solid = solids[static_cast<std::size_t>(k)];
    balls_.push_back({solid.centre(), solid.radius(), k});
  }
}

void ShapeTree::fill(int at, int first, int last, std::vector<int>& order,
                     const std::vector<Corners>& corners) {
  const auto box = [&](int k) -> const Corners& {
    return corners[static_cast<std::size_t>(order[static_cast<std::size_t>(k)])];
  };
  Vec4 low = broadcast(kInfinity), high = broadcast(-kInfinity), least = low, most = high;
  for (int k = first; k < last; ++k) {
    for (int i = 0; i < 3; ++i) {
      const double middle = box(k).low[i] + box(k).high[i];
      low[i] = std::min(low[i], box(k).low[i]);
      high[i] = std::max(high[i], box(k).high[i]);
      least[i] = std::min(least[i], middle);
      most[i] = std::max(most[i], middle);
    }
  }
  {
    Node& node = nodes_[static_cast<std::size_t>(at)];
    node.middle = broadcast(0.5) * (low + high);
    node.half = broadcast(0.5) * (high - low);
    node.radius = std::sqrt(dot3(node.half, node.half));
    if (last - first <= kLeaf) {
      node.first = first;
      node.last = last;
      return;
    }
    node.child = static_cast<int>(nodes_.size());
  }
  const int child = static_cast<int>(nodes_.size());
  int axis = 0;
  for (int i = 1; i < 3; ++i) {
    if (most[i] - least[i] > most[axis] - least[axis]) axis = i;
  }
  const int middle = first + (last - first) / 2;
  const auto place = [&](int solid) {
    const Corners& of = corners[static_cast<std::size_t>(solid)];
    return of.low[axis] + of.high[axis];
  };
  std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last,
                   [&](int one, int other) {
                     const double a = place(one), b = place(other);
                     return a < b || (a == b && one < other);
                   });
  nodes_.emplace_back();
  nodes_.emplace_back();
  fill(child, first, middle, order, corners);
  fill(child + 1, middle, last, order, corners);
}

}  // namespace pdoik::detail
