#include "paths/path_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <set>
#include <utility>

#include "paths/motion_search.hpp"
#include "paths/path_routes.hpp"
#include "paths/path_smoothing.hpp"

namespace pdoik::detail {
namespace {

/// What a search for one motion may take of the time: the rest is for saying where it breaks.
constexpr double kWholeShare = 0.7;
/// What a move between two pieces may take of the path's time, and no more than this [s].
constexpr double kMoveShare = 0.1, kLongestMove = 2.0;
/// Shortening is begun from so many other places of the first station, this far apart [rad] or [m].
constexpr std::size_t kOthers = 10;
constexpr double kElsewhere = 0.8;
/// Joints go no farther than this from one station to the next where a motion is followed to its
/// end [rad] or [m].
constexpr double kStation = 1.0;
/// So many ends are reported, at most, and stations looked at one by one.
constexpr std::size_t kMostEnds = 8;
constexpr int kMostStations = 64;

}  // namespace

PathSearch::PathSearch(Workspace& workspace, Multistart& multistart, const PathRequest& request,
                       const PathOptions& options, const Eigen::VectorXd& lower,
                       const Eigen::VectorXd& upper)
    : deadline_(options.max_time, workspace.interrupt),
      request_(request),
      options_(options),
      workspace_(workspace),
      lower_(lower),
      upper_(upper),
      goals_(request.stations, request.closed),
      stepper_(workspace, goals_, options, deadline_, lower, upper),
      cost_(workspace.model(), options.costs),
      layers_(stepper_, multistart, request, cost_) {}

PathResult PathSearch::run() {
  PathResult result;
  Points points;
  std::vector<Points> pieces;
  bool is_whole = find_whole(points);
  // What pieces run into is where to look for more.
  while (!is_whole && find_pieces(pieces) && !is_late_ && layers_.refine())
    is_whole = find_whole(points);
  if (is_whole) {
    result.status = PathStatus::Whole;
    take({points}, result);
  } else {
    if (options_.reconfigure && !pieces.empty()) {
      take(pieces, result);
      find_moves(pieces, result);
    }
    explain(result);
    is_late_ = is_late_ || deadline_.struck();
    result.complete = !is_late_ && is_impossible(result);
    result.status = covers_all(result) ? PathStatus::Pieces
                    : result.complete  ? PathStatus::Impossible
                    : is_late_         ? PathStatus::TimeLimit
                                       : PathStatus::NotFound;
  }
  result.time = deadline_.elapsed();
  return result;
}

bool PathSearch::covers_all(const PathResult& result) const {
  double next = 0.0;  // the first station that is not met yet
  for (const PathPiece& piece : result.pieces) {
    if (piece.from > next) return false;
    next = std::floor(piece.to) + 1.0;
  }
  return next >= goals_.count();
}

bool PathSearch::is_impossible(const PathResult& result) {
  if (!layers_.is_certain_at(cut(layers_))) return false;
  // What ends for no other reason may have been followed badly.
  const Model& model = workspace_.model();
  return !result.unsolved.empty() ||
         (!result.ends.empty() && std::ranges::all_of(result.ends, [&](const PathEnd& end) {
           const auto kind = end.beyond.worst.kind;
           if (kind != WorstConstraint::Kind::Position && kind != WorstConstraint::Kind::Rotation)
             return true;
           const Eigen::VectorXd& q = end.beyond.q;
           return (q.array() <= model.robot.lower().array()).any() ||
                  (q.array() >= model.robot.upper().array()).any();
         }));
}

void PathSearch::note_end(double reached, const Eigen::VectorXd& q) {
  PathEnd& end = ends_.emplace_back();
  end.at = reached;
  end.q = q;
  end.beyond = stepper_.fault();
}

bool PathSearch::go(const PathLayers::Place& one, const PathLayers::Place& other, Points& points) {
  const bool is_there = stepper_.bridge(layers_.node(one).point, layers_.node(other).point, points);
  if (deadline_.struck()) return false;
  layers_.note(one, other, is_there ? PathLayers::Good : PathLayers::Bad);
  if (!is_there) note_end(points.back().at, points.back().q);
  return is_there;
}

bool PathSearch::follow(const PathLayers::Route& route, Points& points) {
  points.assign(1, layers_.node(route.front()).point);
  for (std::size_t k = 1; k < route.size(); ++k) {
    if (go(route[k - 1], route[k], points)) continue;
    if (!deadline_.struck())
      layers_.turn_at_limits(route[k - 1].layer, layers_.node(route[k - 1]).point);
    return false;
  }
  return true;
}

bool PathSearch::join(const Points& route, Points& points) {
  points.assign(1, route.front());
  for (std::size_t k = 1; k < route.size(); ++k) {
    if (!stepper_.bridge(route[k - 1], route[k], points)) return false;
  }
  return true;
}

bool PathSearch::find_whole(Points& points) {
  for (;;) {
    const PathLayers::Route route = best_route(layers_, Jumps::None);
    if (deadline_.passed()) return false;
    is_late_ = deadline_.elapsed() > kWholeShare * options_.max_time;
    if (is_late_) return false;
    if (route.empty()) {
      if (!layers_.refine()) return false;
      continue;
    }
    if (!follow(route, points)) {
      if (deadline_.struck()) return false;
      continue;
    }
    shorten(route, points);
    return true;
  }
}

void PathSearch::shorten(const PathLayers::Route& route, Points& points) {
  const Kept kept{request_.start != nullptr || request_.closed,
                  request_.end != nullptr || request_.closed};
  struct Candidate {
    Points route;
    double cost;
    bool is_joined;  ///< as it was followed already
  };
  std::vector<Candidate> candidates;
  const auto consider = [&](const PathLayers::Route& from) {
    Points shorter;
    for (const PathLayers::Place& place : from) shorter.push_back(layers_.node(place).point);
    const bool is_shorter = smooth(stepper_, cost_, shorter, kept);
    const double cost = cost_.of_all(stepper_, shorter);
    candidates.push_back({std::move(shorter), cost, !is_shorter && candidates.empty()});
  };
  consider(route);
  // What is shortened ends in the nearest valley: others are begun elsewhere.
  const bool is_free = workspace_.model().is_redundant(request_.stations.front());
  std::vector<Eigen::VectorXd> begun{layers_.node(route.front()).point.q};
  const auto& first = layers_.layer(0).nodes;
  const std::vector<double> costs = costs_of_beginnings(layers_);
  std::vector<int> order(is_free ? first.size() : 0);
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int k) { return costs[static_cast<std::size_t>(k)]; });
  for (const int k : order) {
    const Eigen::VectorXd& q = first[static_cast<std::size_t>(k)].point.q;
    const bool is_other = std::ranges::all_of(begun, [&](const Eigen::VectorXd& other) {
      return (q - other).cwiseAbs().maxCoeff() > kElsewhere;
    });
    if (!is_other || begun.size() > kOthers || deadline_.passed()) continue;
    begun.push_back(q);
    if (const PathLayers::Route other = best_route(layers_, Jumps::None, k); !other.empty())
      consider(other);
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::cost);
  Points joined;
  for (const Candidate& each : candidates) {
    if (!each.is_joined && !join(each.route, joined)) continue;
    if (!each.is_joined) points = std::move(joined);
    return;
  }
}

bool PathSearch::find_pieces(std::vector<Points>& pieces) {
  std::vector<Points> found;
  for (;;) {
    const PathLayers::Route route = best_route(layers_, Jumps::Allowed);
    if (route.empty() || deadline_.passed()) return false;
    found.assign(1, {layers_.node(route.front()).point});
    bool is_there = true;
    for (std::size_t k = 1; k < route.size() && is_there; ++k) {
      const PathLayers::Place &one = route[k - 1], &other = route[k];
      const bool is_jump = other.layer != one.layer + 1 || !layers_.may_go(one, other);
      if (is_jump) {
        found.push_back({layers_.node(other).point});
        continue;
      }
      is_there = go(one, other, found.back());
      if (deadline_.struck()) {
        if (pieces.empty()) pieces = std::move(found);  // which is what is known
        return false;
      }
    }
    if (is_there) break;
  }
  // A station of its own, if neighbours do not meet it.
  const auto is_met = [&](const Points& piece) {
    const auto holds = [&](const Points& other) {
      return other.size() > 1 && other.front().at <= piece.front().at &&
             piece.front().at <= other.back().at;
    };
    return piece.size() < 2 && std::ranges::any_of(found, holds);
  };
  pieces.clear();
  std::ranges::copy_if(found, std::back_inserter(pieces), std::not_fn(is_met));
  return true;
}

void PathSearch::find_moves(const std::vector<Points>& pieces, PathResult& result) {
  std::vector<Eigen::VectorXd> moves;
  for (std::size_t k = 0; k + 1 < pieces.size(); ++k) {
    const double left = std::min({deadline_.left(), kMoveShare * options_.max_time, kLongestMove});
    if (left <= 0.0) break;
    const Deadline deadline(left, workspace_.interrupt);
    const PathPoint &from = pieces[k].back(), &to = pieces[k + 1].front();
    const std::span<const Goal> goals = goals_.at(from.at);
    MotionSearch search(workspace_, stepper_.sweep(), goals, lower_, upper_, deadline);
    int reached = 0;
    auto way = search.find(from.q, {to.q}, reached);
    if (!way) continue;
    search.shorten(*way, 0.2 * left);
    result.pieces[k].first_move = static_cast<int>(moves.size());
    moves.insert(moves.end(), way->begin(), way->end());
    result.pieces[k].last_move = static_cast<int>(moves.size()) - 1;
  }
  result.moves.resize(static_cast<Eigen::Index>(moves.size()), lower_.size());
  for (std::size_t k = 0; k < moves.size(); ++k)
    result.moves.row(static_cast<Eigen::Index>(k)) = moves[k];
}

bool PathSearch::has_solution(int station, Result& best) {
  const bool is_first = station == 0, is_last = station == goals_.count() - 1;
  const Eigen::VectorXd* given = is_first ? request_.start : is_last ? request_.end : nullptr;
  if (given == nullptr) return !layers_.solve(station, 1, best).results.empty();
  PathPoint point;
  if (stepper_.stands(station, *given, point)) return true;
  best = stepper_.fault();
  return false;
}

void PathSearch::follow_to_end(PathPoint at, int last) {
  PathPoint next;
  Points points;
  for (int k = static_cast<int>(at.at) + 1; k <= last; ++k) {
    points.clear();
    if (!stepper_.bring(k, at.q, kStation, next) || !stepper_.bridge(at, next, points)) {
      note_end(at.at, at.q);
      return;
    }
    at = next;
  }
}

void PathSearch::explain(PathResult& result) {
  // Stations that no piece meets, and have no solution of their own.
  int looked_at = 0;
  double met = -1.0;
  Result best;
  const auto look_between = [&](double from, double to) {
    for (int k = static_cast<int>(std::floor(from)) + 1; k < to && !deadline_.passed(); ++k) {
      if (++looked_at > kMostStations) return;
      if (has_solution(k, best)) continue;
      const bool is_next = !result.unsolved.empty() && result.unsolved.back() == k - 1;
      result.unsolved.push_back(k % static_cast<int>(request_.stations.size()));
      if (!is_next) result.ends.push_back({static_cast<double>(k), best.q, best});
    }
  };
  for (const PathPiece& piece : result.pieces) {
    look_between(met, piece.from);
    met = piece.to;
  }
  const int end = cut(layers_);
  const int first = end == 0 ? 0 : layers_.layer(end - 1).station + 1,
            last = end >= layers_.count() ? -1 : layers_.layer(end).station;
  look_between(result.pieces.empty() ? first - 1.0 : met,
               result.pieces.empty() ? last + 1.0 : goals_.count());
  workspace_.watch(deadline_);
  if (!result.unsolved.empty()) return;
  // Follow each of those that get there as far as it gets.
  if (end > 0 && end < layers_.count()) {
    for (const PathLayers::Node& node : layers_.layer(end - 1).nodes) {
      if (deadline_.passed()) break;
      follow_to_end(node.point, last);
    }
  }
  // Those that get farthest, and of each reason one.
  std::ranges::stable_sort(ends_, [](const PathEnd& a, const PathEnd& b) { return a.at > b.at; });
  std::set<std::pair<int, int>> known;
  for (PathEnd& each : ends_) {
    const WorstConstraint& worst = each.beyond.worst;
    if ((end < layers_.count() && each.at < first - 1.0) || result.ends.size() >= kMostEnds) break;
    if (known.insert({static_cast<int>(worst.kind), worst.index}).second)
      result.ends.push_back(std::move(each));
  }
}

void PathSearch::take(const std::vector<Points>& pieces, PathResult& result) {
  Eigen::Index rows = 0;
  for (const Points& piece : pieces) rows += static_cast<Eigen::Index>(piece.size());
  result.q.resize(rows, lower_.size());
  result.at.resize(rows);
  Eigen::Index row = 0;
  Result verdict;
  for (const Points& piece : pieces) {
    PathPiece& reported = result.pieces.emplace_back();
    reported.first = static_cast<int>(row);
    reported.from = piece.front().at;
    reported.to = piece.back().at;
    Eigen::Index station = row;
    for (std::size_t k = 0; k < piece.size(); ++k, ++row) {
      const PathPoint& point = piece[k];
      result.q.row(row) = point.q;
      result.at[row] = point.at;
      if (k > 0) result.length += (point.q - piece[k - 1].q).norm();
      const Options& options = workspace_.model().options;
      double clearance = point.room.obstacles + options.clearance,
             off_itself = point.room.self + options.self_clearance;
      if (workspace_.scene().has_own_clearances()) {  // of which room tells less
        workspace_.judge(goals_.at(point.at), point.q, verdict, Sweep::kLook);
        clearance = verdict.clearance;
        off_itself = verdict.self_distance;
      }
      result.clearance = std::min(result.clearance, clearance);
      result.self_distance = std::min(result.self_distance, off_itself);
      if (point.at != std::floor(point.at)) continue;
      if (k > 0)
        result.largest_step = std::max(
            result.largest_step, (result.q.row(row) - result.q.row(station)).cwiseAbs().maxCoeff());
      station = row;
      workspace_.judge(goals_.at(point.at), point.q, verdict, 0.0);
      result.position_error = std::max(result.position_error, verdict.position_error);
      result.rotation_error = std::max(result.rotation_error, verdict.rotation_error);
    }
    reported.last = static_cast<int>(row) - 1;
  }
}

}  // namespace pdoik::detail

namespace pdoik {

const char* to_string(PathStatus status) {
  switch (status) {
    case PathStatus::Whole:
      return "whole";
    case PathStatus::Pieces:
      return "pieces";
    case PathStatus::Impossible:
      return "impossible";
    case PathStatus::NotFound:
      return "not_found";
    case PathStatus::TimeLimit:
      return "time_limit";
  }
  return "unknown";
}

const char* to_string(MotionStatus status) {
  switch (status) {
    case MotionStatus::Solved:
      return "solved";
    case MotionStatus::BlockedStart:
      return "blocked_start";
    case MotionStatus::BlockedGoal:
      return "blocked_goal";
    case MotionStatus::TimeLimit:
      return "time_limit";
  }
  return "unknown";
}

}  // namespace pdoik
