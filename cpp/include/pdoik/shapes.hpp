#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "pdoik/shape.hpp"

namespace pdoik {

namespace detail {
struct ShapeSet;
}

/// A link and a shape that may touch: the table that the base stands on, what the hand is to hold.
struct AllowedContact {
  std::string link;   ///< of the robot, with all of its hulls
  std::string shape;  ///< its name
  /// By at most this much [m]: their distance counts from there.
  double depth = std::numeric_limits<double>::infinity();
};

/// Solids that the robot has to keep off, ready for distances. It does not change: any number of
/// solvers on any number of threads may share it.
class Shapes {
 public:
  /// None.
  Shapes();
  /// Take shapes in, of different names, and what may touch them.
  /// @throws std::invalid_argument  As check_shape; two shapes of one name; an allowed contact with
  /// a shape that is not there or to a negative depth. Whether there is such a link says who takes
  /// them in.
  explicit Shapes(std::vector<Shape> shapes, std::vector<AllowedContact> allowed = {});

  /// In the order that they were given.
  std::span<const Shape> shapes() const;
  /// What may touch.
  std::span<const AllowedContact> allowed() const;

 private:
  friend class Solver;
  friend class Tracker;
  std::shared_ptr<const detail::ShapeSet> set_;
};

}  // namespace pdoik
