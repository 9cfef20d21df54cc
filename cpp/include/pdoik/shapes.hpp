#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "pdoik/contact_rule.hpp"
#include "pdoik/shape.hpp"

namespace pdoik {

namespace detail {
struct ShapeSet;
}

/// Solids that the robot has to keep off, ready for distances. It does not change: any number of
/// solvers on any number of threads may share it.
class Shapes {
 public:
  /// None.
  Shapes();
  /// Take shapes in, of different names, and rules of contact: of these, and of whatever else is
  /// there where a solver takes them in.
  /// @throws std::invalid_argument  As check_shape and check_contact_rule; two shapes of one name.
  /// Whether there is what rules speak of says who takes them in.
  explicit Shapes(std::vector<Shape> shapes, std::vector<ContactRule> contacts = {});

  /// In the order that they were given.
  std::span<const Shape> shapes() const;
  /// The rules, in the order that they were given.
  std::span<const ContactRule> contacts() const;

 private:
  friend class Solver;
  friend class Tracker;
  explicit Shapes(std::shared_ptr<const detail::ShapeSet> set) : set_(std::move(set)) {}
  std::shared_ptr<const detail::ShapeSet> set_;
};

}  // namespace pdoik
