#include "detail/shape_tree.hpp"

#include <algorithm>
#include <numeric>

#include "detail/infinity.hpp"

namespace pdoik::detail {
namespace {

constexpr int kLeaf = 8;  ///< so many solids are looked at one by one

}  // namespace

ShapeTree::ShapeTree(const std::vector<Solid>& solids) {
  std::vector<Node> boxes(solids.size());
  for (std::size_t k = 0; k < solids.size(); ++k) {
    const Solid& solid = solids[k];
    if (solid.is_half_space()) {
      unbounded_.push_back(static_cast<int>(k));
      continue;
    }
    order_.push_back(static_cast<int>(k));
    for (int i = 0; i < 3; ++i) {
      Vec4 along{};
      along[i] = 1.0;
      boxes[k].high[i] = solid.support(along)[i] + solid.rounding();
      boxes[k].low[i] = solid.support(-along)[i] - solid.rounding();
    }
  }
  if (order_.empty()) return;
  nodes_.reserve(2 * order_.size());
  nodes_.emplace_back();
  fill(0, 0, static_cast<int>(order_.size()), boxes);
}

void ShapeTree::fill(int at, int first, int last, const std::vector<Node>& boxes) {
  const auto box = [&](int k) -> const Node& {
    return boxes[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])];
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
    node.low = low;
    node.high = high;
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
    const Node& of = boxes[static_cast<std::size_t>(solid)];
    return of.low[axis] + of.high[axis];
  };
  std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + last,
                   [&](int one, int other) {
                     const double a = place(one), b = place(other);
                     return a < b || (a == b && one < other);
                   });
  nodes_.emplace_back();
  nodes_.emplace_back();
  fill(child, first, middle, boxes);
  fill(child + 1, middle, last, boxes);
}

}  // namespace pdoik::detail
