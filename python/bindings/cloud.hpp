#pragma once

#include <optional>
#include <string>

#include "arrays.hpp"
#include "pdoik/cloud.hpp"

namespace pdoik::python {

/// A cloud and how its points are thinned before it takes them in.
struct ThinnedCloud {
  Cloud cloud;
  std::optional<double> leaf;
  bool radii = false;
};

/// The obstacles of a call: None, an array or a Cloud. Made and destroyed with the GIL held.
class ObstaclesIn {
 public:
  ObstaclesIn(const std::optional<ObstaclesLike>& obstacles, const std::string& name)
      : points_(PointsView::float64(
            is_array(obstacles) ? std::optional(ArrayLike{obstacles->value}) : std::nullopt,
            name)) {
    if (obstacles && !is_array(obstacles))
      cloud_ = obstacles->value.cast<const ThinnedCloud&>().cloud;
  }

  /// Hand them to a Solver or a Tracker.
  template <class Taker>
  void give_to(Taker& taker) const {
    if (cloud_)
      taker.set_obstacles(*cloud_);
    else
      taker.set_obstacles(points_.in_double());
  }

 private:
  static bool is_array(const std::optional<ObstaclesLike>& obstacles) {
    return obstacles && !py::isinstance<ThinnedCloud>(obstacles->value);
  }

  PointsView points_;
  std::optional<Cloud> cloud_;  ///< a handle
};

}  // namespace pdoik::python
