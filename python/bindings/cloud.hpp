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
      : points_(PointsView::float64(std::nullopt, name)) {
    if (!obstacles) return;
    if (py::isinstance<ThinnedCloud>(obstacles->value))
      cloud_ = obstacles->value.cast<const ThinnedCloud&>().cloud;
    else
      points_ = PointsView::float64(ArrayLike{obstacles->value}, name);
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
  PointsView points_;
  std::optional<Cloud> cloud_;  ///< a handle
};

}  // namespace pdoik::python
