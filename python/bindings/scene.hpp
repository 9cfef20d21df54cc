#pragma once

#include <algorithm>
#include <optional>

#include "cloud.hpp"
#include "pdoik/shapes.hpp"
#include "pdoik/tracker.hpp"

namespace pdoik::python {

/// Solids and points that are obstacles together.
struct SceneObject {
  Shapes shapes;
  std::optional<ThinnedCloud> cloud;
};

/// The obstacles of a call: None, an array, a Cloud, shapes or a Scene. Made and destroyed with the
/// GIL held.
class ObstaclesIn {
 public:
  ObstaclesIn(const std::optional<ObstaclesLike>& obstacles, const std::string& name)
      : points_(PointsView::float64(kind_of(obstacles) == Kind::Points
                                        ? std::optional(ArrayLike{obstacles->value})
                                        : std::nullopt,
                                    name)) {
    switch (kind_of(obstacles)) {
      case Kind::Cloud:
        cloud_ = obstacles->value.cast<const ThinnedCloud&>().cloud;
        break;
      case Kind::Scene: {
        const auto& scene = obstacles->value.cast<const SceneObject&>();
        shapes_ = scene.shapes;
        if (scene.cloud) cloud_ = scene.cloud->cloud;
        break;
      }
      case Kind::Shapes: {
        std::vector<Shape> shapes;
        for (const py::handle each : obstacles->value) shapes.push_back(each.cast<Shape>());
        shapes_ = Shapes(std::move(shapes));
        break;
      }
      case Kind::Points:
      case Kind::None:
        break;
    }
  }

  /// Some of the points, x y z radius, at most so many.
  RowMatrix sample(int most) const {
    if (cloud_) return cloud_->sample(most);
    const Obstacles all = points_.in_double();
    if (all.rows() == 0 || all.cols() < 3) return RowMatrix(0, 4);
    const Eigen::Index step = (all.rows() + most - 1) / most, count = (all.rows() - 1) / step + 1;
    RowMatrix some = RowMatrix::Zero(count, 4);
    const Eigen::Index columns = std::min<Eigen::Index>(all.cols(), 4);
    for (Eigen::Index k = 0; k < count; ++k)
      some.row(k).head(columns) = all.row(k * step).head(columns);
    return some;
  }

  /// Hand them to a Solver or a Tracker.
  template <class Taker>
  void give_to(Taker& taker) const {
    if (cloud_)
      taker.set_obstacles(*cloud_);
    else
      taker.set_obstacles(points_.in_double());
    taker.set_shapes(shapes_);
  }
  /// The same, with how fast they move, as (1, 3) or (N, 3).
  /// @throws std::invalid_argument  They are neither an array nor shapes; as Tracker::set_shapes.
  template <class Taker>
  void give_to(Taker& taker, const ObstacleVelocity& velocity) const {
    if (cloud_ || (points_.in_double().rows() == 0 && shapes_.shapes().empty())) {
      throw std::invalid_argument(
          "obstacle_velocity is for obstacles that are an array of points or a list of shapes");
    }
    if (shapes_.shapes().empty()) {
      taker.set_obstacles(points_.in_double(), velocity);
      taker.set_shapes(shapes_);
      return;
    }
    taker.set_shapes(shapes_, velocity);
    taker.set_obstacles(points_.in_double());
  }

 private:
  enum class Kind { None, Points, Cloud, Scene, Shapes };
  static Kind kind_of(const std::optional<ObstaclesLike>& obstacles) {
    if (!obstacles) return Kind::None;
    const py::object& value = obstacles->value;
    if (py::isinstance<ThinnedCloud>(value)) return Kind::Cloud;
    if (py::isinstance<SceneObject>(value)) return Kind::Scene;
    const bool listed = py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value);
    if (listed && py::len(value) > 0 && py::isinstance<Shape>(value[py::int_(0)]))
      return Kind::Shapes;
    return Kind::Points;
  }

  PointsView points_;
  std::optional<Cloud> cloud_;  ///< a handle
  Shapes shapes_;
};

}  // namespace pdoik::python
