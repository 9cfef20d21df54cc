#include "paths/path_layers.hpp"

#include <algorithm>
#include <cmath>

#include "paths/path_routes.hpp"
#include "search/all_solutions.hpp"

namespace pdoik::detail {
namespace {

/// Solutions of a layer that are looked for at first, each time three times as many [-].
constexpr int kFirst = 36, kRounds = 3;
/// How many times as long as a solve a station may take.
constexpr double kPatience = 20.0;
/// What a layer holds, at most, before others that are led to it are no nodes of their own.
constexpr std::size_t kMostNodes = 160;
/// Joints go no farther than this for each way of the tool (PathGoals::way) [rad] or [m].
constexpr double kFarthestWay = 1.2;
/// Two solutions of one layer are the same if no joint is farther off than this [rad] or [m].
constexpr double kOneNode = 0.02;
/// Where goals leave joints free, what following the path leads to may be led to a node this far
/// off on the way [rad] or [m].
constexpr double kNear = 0.35;
/// So many ways between two layers are tried.
constexpr int kMostFailures = 100;

}  // namespace

PathLayers::PathLayers(PathStepper& stepper, Multistart& multistart, const PathRequest& request,
                       const PathCost& cost)
    : stepper_(stepper),
      multistart_(multistart),
      request_(request),
      cost_(cost),
      near_(stepper.workspace().model().is_redundant(request.stations.front()) ? kNear : kOneNode) {
  const PathGoals& goals = stepper.goals();
  const auto add_layer = [&](int station) { layers_.emplace_back().station = station; };
  add_layer(0);
  double ways = 0.0;
  for (int k = 1; k < goals.count(); ++k) {
    const double next = goals.way(k - 1, k);
    if (ways > 0.0 && ways + next > 1.0) {
      add_layer(k - 1);
      ways = 0.0;
    }
    ways += next;
  }
  add_layer(goals.count() - 1);
  if (layers_.size() == 2 && goals.count() > 2) {  // as good a place as any
    layers_.insert(layers_.begin() + 1, Layer{});
    layers_[1].station = goals.count() / 2;
  }

  const auto freeze = [&](Layer& layer, const Eigen::VectorXd* q) {
    if (q == nullptr) return;
    layer.frozen = layer.complete = true;
    PathPoint point;
    if (stepper_.stands(layer.station, *q, point))
      add(layer, std::move(point));
    else
      layer.best = stepper_.fault();
  };
  freeze(layers_.front(), request.start);
  if (!request.closed) freeze(layers_.back(), request.end);
  look_for(layers_.front());
  layers_.back().frozen = layers_.back().frozen || request.closed;
  close();
  lead();
}

void PathLayers::close() {
  if (!request_.closed) return;
  Layer& last = layers_.back();
  last.complete = layers_.front().complete;
  last.rounds = layers_.front().rounds;
  for (std::size_t k = last.nodes.size(); k < layers_.front().nodes.size(); ++k) {
    const Node& node = layers_.front().nodes[k];
    Node& same = last.nodes.emplace_back();
    same.point = node.point;
    same.point.at = last.station;
    same.cost = node.cost;
  }
}

Solutions PathLayers::solve(int station, int limit, Result& best) {
  Request request;
  request.goals = stepper_.goals().station(station);
  request.locks = request_.locks;
  if (request_.start != nullptr) request.q0 = request_.start;
  // Long enough for the clock not to decide what is found.
  Workspace& workspace = stepper_.workspace();
  workspace.give(std::min(kPatience * workspace.model().options.max_time,
                          std::max(stepper_.deadline().left(), 1e-3)));
  Solutions found = all_solutions(workspace, multistart_, request, {limit, 0.0}, best);
  workspace.give(0.0);
  workspace.watch(stepper_.deadline());
  return found;
}

void PathLayers::look_for(Layer& layer) {
  if (layer.frozen || stepper_.deadline().passed()) return;
  int limit = kFirst;
  for (int k = 0; k < layer.rounds; ++k) limit *= 3;
  ++layer.rounds;
  const Solutions found = solve(layer.station, limit, layer.best);
  layer.complete = found.complete;
  layer.has_more = !found.complete && static_cast<int>(found.results.size()) >= limit;
  for (const Result& each : found.results) {
    PathPoint point{static_cast<double>(layer.station), each.q, stepper_.sweep().room(each)};
    add(layer, std::move(point));
  }
}

void PathLayers::turn_at_limits(int at, PathPoint point) {
  if (own(at).frozen) return;
  const Model& model = stepper_.workspace().model();
  const Eigen::VectorXd& there = stepper_.fault().q;
  bool is_other = false;
  for (Eigen::Index i = 0; i < there.size(); ++i) {
    if (model.turns[static_cast<std::size_t>(i)] != Model::Turn::Whole) continue;
    const double lower = model.robot.lower()[i], upper = model.robot.upper()[i];
    const double turn = there[i] >= upper ? -2.0 * M_PI : there[i] <= lower ? 2.0 * M_PI : 0.0;
    const double turned = point.q[i] + turn;
    if (turn == 0.0 || turned < lower || turned > upper) continue;
    point.q[i] = turned;
    is_other = true;
  }
  if (is_other) add(own(at), std::move(point));
}

int PathLayers::find_alike(const Layer& layer, const Eigen::VectorXd& q) {
  for (std::size_t k = 0; k < layer.nodes.size(); ++k) {
    if ((layer.nodes[k].point.q - q).cwiseAbs().maxCoeff() < kOneNode) return static_cast<int>(k);
  }
  return -1;
}

int PathLayers::add(Layer& layer, PathPoint point) {
  if (const int known = find_alike(layer, point.q); known >= 0) return known;
  Node& node = layer.nodes.emplace_back();
  node.point = std::move(point);
  node.cost = cost_.of_place(stepper_, node.point);
  return static_cast<int>(layer.nodes.size()) - 1;
}

void PathLayers::lead(int from, int to) {
  Layer &here = own(from), &there = own(to);
  const bool on = to > from;
  const double far = kFarthestWay * std::max(1.0, way_to(std::max(from, to)));
  for (std::size_t k = 0; k < here.nodes.size(); ++k) {
    bool& done = on ? here.nodes[k].led_on : here.nodes[k].led_back;
    if (done) continue;
    done = true;
    PathPoint next;
    if (!stepper_.bring(there.station, here.nodes[k].point.q, far, next)) {
      if (there.nodes.empty()) there.best = stepper_.fault();
      turn_at_limits(from, here.nodes[k].point);
      continue;
    }
    Node& node = here.nodes[k];
    (on ? node.next : node.last) = next.q;
    if (there.frozen || there.nodes.size() >= kMostNodes) continue;
    const std::size_t before = there.nodes.size();
    const int found = add(there, std::move(next));
    if (there.nodes.size() == before) continue;
    // It came from there, and need not go back.
    Node& came = there.nodes[static_cast<std::size_t>(found)];
    (on ? came.led_back : came.led_on) = true;
    (on ? came.last : came.next) = node.point.q;
  }
}

bool PathLayers::are_joined(const Node& one, const Node& other, bool loosely) const {
  if (loosely && (one.point.q - other.point.q).cwiseAbs().maxCoeff() <= kFarthestWay) return true;
  const auto is_near = [&](const Eigen::VectorXd& led, const Eigen::VectorXd& q) {
    return led.size() > 0 && (led - q).cwiseAbs().maxCoeff() <= near_;
  };
  return is_near(one.next, other.point.q) || is_near(other.last, one.point.q);
}

void PathLayers::link(int from) {
  Layer &here = own(from), &there = own(from + 1);
  for (Node& node : here.nodes) {
    node.edges.resize(there.nodes.size(), None);
    for (std::size_t k = 0; k < there.nodes.size(); ++k) {
      if (node.edges[k] == None && are_joined(node, there.nodes[k], here.loose))
        node.edges[k] = Unknown;
    }
  }
}

void PathLayers::lead() {
  for (int k = 0; k + 1 < count(); ++k) lead(k, k + 1);
  for (int k = count() - 1; k > 0; --k) lead(k, k - 1);
  close();
  for (int k = 0; k + 1 < count(); ++k) link(k);
}

double PathLayers::way_to(int k) const {
  return stepper_.goals().way(layer(k - 1).station, layer(k).station);
}

bool PathLayers::may_go(const Place& one, const Place& other) const {
  const std::vector<Edge>& edges = node(one).edges;
  const auto k = static_cast<std::size_t>(other.node);
  return k < edges.size() && (edges[k] == Unknown || edges[k] == Good);
}

void PathLayers::note(const Place& one, const Place& other, Edge edge) {
  Layer& from = own(one.layer);
  from.nodes[static_cast<std::size_t>(one.node)].edges[static_cast<std::size_t>(other.node)] = edge;
  if (edge != Bad || ++from.failures < kMostFailures) return;
  // Others of what is so full of obstacles are as bad, most likely: a layer in the middle tells.
  for (Node& each : from.nodes) std::ranges::replace(each.edges, Unknown, Bad);
}

bool PathLayers::is_certain_at(int cut) const {
  const auto known = [&](int k) { return layers_[static_cast<std::size_t>(k)].complete; };
  if (cut == 0) return known(0);
  if (cut >= static_cast<int>(layers_.size())) return false;
  return known(cut) && (layers_[static_cast<std::size_t>(cut)].nodes.empty() || known(cut - 1));
}

bool PathLayers::has_gap() const {
  return std::ranges::any_of(layers_, [](const Layer& layer) {
    return layer.nodes.empty() && layer.rounds > 0 && layer.best.status != Status::TimeLimit;
  });
}

bool PathLayers::refine() {
  if (refine(cut(*this))) return true;
  // Other branches may get farther elsewhere: wherever the fewest motions leave the path.
  const Route route = best_route(*this, Jumps::Allowed);
  for (std::size_t k = 1; k < route.size(); ++k) {
    const Place &one = route[k - 1], &other = route[k];
    const bool jumps = one.layer == other.layer;
    if (!jumps && may_go(one, other)) continue;
    if (jumps && has_gap()) continue;  // there is no whole path, whatever else is found
    if (refine(other.layer) || (jumps && other.layer + 1 < count() && refine(other.layer + 1)))
      return true;
  }
  for (int k = route.empty() ? 1 : route.back().layer + 1; k < count(); ++k) {
    if (refine(k)) return true;
  }
  return false;
}

bool PathLayers::refine(int at) {
  // Of a closed path every layer is in reach, and none comes back to where it began: everywhere.
  const bool everywhere = at >= count();
  const int first = everywhere ? 0 : std::max(0, at - 1), last = everywhere ? count() - 1 : at;
  const auto wants_more = [&](const Layer& each) {
    return !each.frozen &&
           (each.rounds == 0 || (each.has_more && each.rounds < (everywhere ? 2 : kRounds)));
  };
  bool tried = false;
  for (int k = first; k <= last && !stepper_.deadline().passed(); ++k) {
    if (!wants_more(own(k))) continue;
    look_for(own(k));
    tried = true;
  }
  // Where a singularity is passed, following the path leads to another branch than ways between do.
  for (int k = first; k < last && !tried; ++k) {
    if (near_ > kOneNode || own(k).loose) continue;
    own(k).loose = true;
    tried = true;
  }
  if (!tried && !everywhere && at > 0) tried = split(at);
  if (stepper_.deadline().passed() || !tried) return false;
  close();
  lead();
  return true;
}

bool PathLayers::split(int at) {
  const int before = own(at - 1).station, after = own(at).station;
  if (after - before < 2) return false;
  Layer between;
  between.station = (before + after) / 2;
  look_for(between);
  layers_.insert(layers_.begin() + at, std::move(between));
  own(at - 1).loose = false;
  own(at - 1).failures = 0;
  for (Node& node : own(at - 1).nodes) {
    node.led_on = false;
    node.next.resize(0);
    node.edges.clear();
  }
  for (Node& node : own(at + 1).nodes) {
    node.led_back = false;
    node.last.resize(0);
  }
  return true;
}

}  // namespace pdoik::detail
