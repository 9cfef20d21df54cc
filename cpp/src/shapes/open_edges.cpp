#include <algorithm>
#include <numeric>
#include <vector>

#include "pdoik/shape.hpp"

namespace pdoik {
namespace {

/// The same number for vertices at one place.
std::vector<int> merged(const std::vector<Eigen::Vector3d>& vertices) {
  std::vector<int> order(vertices.size()), numbers(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [&](int k) -> const Eigen::Vector3d& {
    return vertices[static_cast<std::size_t>(k)];
  };
  std::ranges::sort(order, [&](int one, int other) {
    return std::lexicographical_compare(at(one).data(), at(one).data() + 3, at(other).data(),
                                        at(other).data() + 3);
  });
  int first = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k == 0 || at(order[k]) != at(order[k - 1])) first = order[k];
    numbers[static_cast<std::size_t>(order[k])] = first;
  }
  return numbers;
}

}  // namespace

int open_edges(const Shape& mesh) {
  struct Edge {
    int low, high, way;
  };
  const std::vector<int> number = merged(mesh.vertices);
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const int from = number[static_cast<std::size_t>(triangle[i])],
                to = number[static_cast<std::size_t>(triangle[(i + 1) % 3])];
      if (from != to) edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  std::ranges::sort(edges, [](const Edge& one, const Edge& other) {
    return one.low < other.low || (one.low == other.low && one.high < other.high);
  });
  int open = 0;
  for (std::size_t k = 0; k < edges.size();) {
    int balance = 0;
    std::size_t next = k;
    for (; next < edges.size() && edges[next].low == edges[k].low &&
           edges[next].high == edges[k].high;
         ++next)
      balance += edges[next].way;
    open += balance != 0 ? 1 : 0;
    k = next;
  }
  return open;
}

}  // namespace pdoik
