#pragma once

#include <vector>

#include "paths/path_cost.hpp"
#include "paths/path_stepper.hpp"
#include "search/multistart.hpp"

namespace pdoik::detail {

/// Solutions of some stations of a path, its layers, and which of them joints get between: the
/// graph that a path is searched in. Solutions are found for a layer, or led to it from one next to
/// it. Whether joints get from one to another is found out when a best route wants to know.
class PathLayers {
 public:
  PathLayers(PathStepper& stepper, Multistart& multistart, const PathRequest& request,
             const PathCost& cost);

  /// What is known of joints getting from a node to one of the next layer: nothing, as it is not
  /// where following the path from either leads, or whether they do.
  enum Edge : char { None, Unknown, Good, Bad };
  struct Node {
    PathPoint point;
    double cost = 0.0;  ///< of being there
    bool led_on = false, led_back = false;
    Eigen::VectorXd next, last;  ///< where following the path on, or back, leads; empty: nowhere
    std::vector<Edge> edges;     ///< to the nodes of the next layer, as many as were looked at
  };
  struct Layer {
    int station = 0;
    std::vector<Node> nodes;
    bool complete = false;  ///< whether all solutions are here
    bool frozen = false;    ///< whether no others are wanted: an end that is given
    int rounds = 0;         ///< how often solutions were looked for
    bool has_more = false;  ///< whether there were more than were wanted
    int failures = 0;       ///< edges to the next layer that were found bad
    bool loose = false;     ///< whether all that is not far may be joined with the next layer
    Result best;            ///< where there is none, what comes nearest
  };
  /// A node of the route: the k-th of a layer.
  struct Place {
    int layer, node;
  };
  using Route = std::vector<Place>;

  /// Note that joints do or do not get from one place to the next.
  void note(const Place& one, const Place& other, Edge edge);
  /// Whether they may, as far as is known.
  bool may_go(const Place& one, const Place& other) const;

  /// Where the last motion from a node of a layer, that is at a point, ended at a limit of a joint
  /// that has whole turns, let the same a turn farther from it be a node as well.
  void turn_at_limits(int at, PathPoint point);
  /// Look for more where routes are cut: solutions beside the cut, then a layer in the middle of
  /// it. @returns Whether there was anything left to try.
  bool refine();
  /// Whether no more can be known than is: all solutions beside the cut, and no station inside.
  bool is_certain_at(int cut) const;

  int count() const { return static_cast<int>(layers_.size()); }
  const Layer& layer(int k) const { return layers_[static_cast<std::size_t>(k)]; }
  const Node& node(const Place& place) const {
    return layer(place.layer).nodes[static_cast<std::size_t>(place.node)];
  }
  bool is_closed() const { return request_.closed; }
  const PathCost& cost() const { return cost_; }
  /// How far a layer is from the one before it: see PathGoals::way.
  double way_to(int layer) const;

  /// All solutions of a station that are wanted.
  Solutions solve(int station, int limit, Result& best);

 private:
  Layer& own(int k) { return layers_[static_cast<std::size_t>(k)]; }
  void look_for(Layer& layer);
  /// Let a closed path's last layer have the first one's nodes.
  void close();
  /// Lead all nodes on, and back.
  void lead();
  void lead(int from, int to);
  int add(Layer& layer, PathPoint point);
  static int find_alike(const Layer& layer, const Eigen::VectorXd& q);
  /// Whether some station has no solution, as far as is known.
  bool has_gap() const;
  /// Look for more before a layer.
  bool refine(int at);
  /// Put a layer in the middle before another. @returns Whether there is a station.
  bool split(int at);
  /// Bring the edges between a layer and the next up to date.
  void link(int from);
  bool are_joined(const Node& one, const Node& other, bool loosely) const;

  PathStepper& stepper_;
  Multistart& multistart_;
  const PathRequest& request_;
  const PathCost& cost_;
  double near_;  ///< what following the path leads to and a node may be apart [rad] or [m]
  std::vector<Layer> layers_;
};

}  // namespace pdoik::detail
