#include "paths/path_routes.hpp"

#include <algorithm>
#include <cmath>

#include "common/infinity.hpp"

namespace pdoik::detail {
namespace {

using Place = PathLayers::Place;
using Route = PathLayers::Route;

/// What a jump costs: more than any motion.
constexpr double kJump = 1e4;

/// The cheapest way to every node, from one layer to the next.
class RouteSearch {
 public:
  RouteSearch(const PathLayers& layers, Jumps jumps)
      : layers_(layers),
        jumps_(jumps == Jumps::Allowed),
        returns_(layers.is_closed() && !jumps_),
        best_(static_cast<std::size_t>(layers.count())) {}

  Route best(int from) {
    // A closed path ends where it began: a search for each beginning.
    if (!returns_) {
      search(from);
    } else {
      for (int only = std::max(from, 0); only < (from < 0 ? size(0) : from + 1); ++only)
        search(only);
    }
    return found_;
  }

 private:
  struct Best {
    double cost = kInfinity;
    Place from{-1, -1};
  };

  int size(int k) const { return static_cast<int>(layers_.layer(k).nodes.size()); }
  Best& at(int k, int i) { return best_[static_cast<std::size_t>(k)][static_cast<std::size_t>(i)]; }

  void search(int from) {
    for (int k = 0; k < layers_.count(); ++k)
      best_[static_cast<std::size_t>(k)].assign(static_cast<std::size_t>(size(k)), Best{});
    for (int i = 0; i < size(0); ++i) {
      if (from < 0 || i == from) at(0, i).cost = layers_.node({0, i}).cost;
    }
    Place farthest{-1, -1};  // the cheapest node of the last layer that is got to
    const auto note_farthest = [&](int k) {
      if (const int i = cheapest(k); i >= 0) farthest = {k, i};
    };
    note_farthest(0);
    for (int k = 1; k < layers_.count(); ++k) {
      lead_to(k);
      if (!jumps_) continue;
      if (cheapest(k) < 0) leap_to(k, farthest);
      jump_inside(k);
      note_farthest(k);
    }
    take_end(from);
    if (jumps_ && found_.empty() && farthest.layer >= 0) found_ = back_from(farthest);
  }

  /// The cheapest node of a layer that is got to, or less than 0.
  int cheapest(int k) {
    int found = -1;
    for (int i = 0; i < size(k); ++i) {
      if (at(k, i).cost < (found < 0 ? kInfinity : at(k, found).cost)) found = i;
    }
    return found;
  }

  void lead_to(int k) {
    const double ways = layers_.way_to(k);
    for (int j = 0; j < size(k); ++j) {
      const PathLayers::Node& there = layers_.node({k, j});
      for (int i = 0; i < size(k - 1); ++i) {
        const double before = at(k - 1, i).cost;
        if (!(before < at(k, j).cost) || !layers_.may_go({k - 1, i}, {k, j})) continue;
        const double cost =
            before + layers_.cost().of_motion(layers_.node({k - 1, i}).point.q, there.point.q) +
            ways * there.cost;
        if (cost < at(k, j).cost) at(k, j) = {cost, {k - 1, i}};
      }
    }
  }

  void leap_to(int k, const Place& from) {
    const double before = from.layer < 0 ? 0.0 : at(from.layer, from.node).cost;
    for (int j = 0; j < size(k); ++j) at(k, j) = {before + 2.0 * kJump, from};
  }

  void jump_inside(int k) {
    const int from = cheapest(k);
    for (int i = 0; from >= 0 && i < size(k); ++i) {
      const double cost =
          at(k, from).cost + kJump +
          layers_.cost().of_motion(layers_.node({k, from}).point.q, layers_.node({k, i}).point.q);
      if (cost < at(k, i).cost) at(k, i) = {cost, {k, from}};
    }
  }

  /// Take what is cheapest at the last layer, or of a closed path at where it began.
  void take_end(int from) {
    const int last = layers_.count() - 1;
    for (int j = 0; j < size(last); ++j) {
      if ((returns_ && j != from) || !(at(last, j).cost < least_)) continue;
      least_ = at(last, j).cost;
      found_ = back_from({last, j});
    }
  }

  Route back_from(Place place) {
    Route route;
    for (; place.layer >= 0; place = at(place.layer, place.node).from) route.push_back(place);
    std::reverse(route.begin(), route.end());
    return route;
  }

  const PathLayers& layers_;
  const bool jumps_, returns_;
  std::vector<std::vector<Best>> best_;
  double least_ = kInfinity;
  Route found_;
};

}  // namespace

Route best_route(const PathLayers& layers, Jumps jumps, int from) {
  return RouteSearch(layers, jumps).best(from);
}

std::vector<double> costs_of_beginnings(const PathLayers& layers) {
  std::vector<double> costs(layers.layer(layers.count() - 1).nodes.size(), 0.0), before;
  for (int k = layers.count() - 1; k > 0; --k) {
    const auto& nodes = layers.layer(k - 1).nodes;
    const double ways = layers.way_to(k);
    before.assign(nodes.size(), kInfinity);
    for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
      double& least = before[static_cast<std::size_t>(i)];
      for (int j = 0; j < static_cast<int>(costs.size()); ++j) {
        if (!layers.may_go({k - 1, i}, {k, j})) continue;
        const PathLayers::Node& there = layers.node({k, j});
        const double motion =
            layers.cost().of_motion(nodes[static_cast<std::size_t>(i)].point.q, there.point.q);
        least = std::min(least, costs[static_cast<std::size_t>(j)] + motion + ways * there.cost);
      }
    }
    std::swap(costs, before);
  }
  return costs;
}

int cut(const PathLayers& layers) {
  std::vector<char> reached(layers.layer(0).nodes.size(), 1), next;
  if (reached.empty()) return 0;
  for (int k = 1; k < layers.count(); ++k) {
    next.assign(layers.layer(k).nodes.size(), 0);
    for (int i = 0; i < static_cast<int>(reached.size()); ++i) {
      for (int j = 0; reached[static_cast<std::size_t>(i)] && j < static_cast<int>(next.size());
           ++j) {
        if (layers.may_go({k - 1, i}, {k, j})) next[static_cast<std::size_t>(j)] = 1;
      }
    }
    if (std::ranges::none_of(next, [](char c) { return c != 0; })) return k;
    reached = next;
  }
  return layers.count();
}

}  // namespace pdoik::detail
