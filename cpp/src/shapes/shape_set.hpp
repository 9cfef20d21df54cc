#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pdoik/shapes.hpp"
#include "shapes/shape_tree.hpp"
#include "shapes/solid.hpp"

namespace pdoik::detail {

/// What Shapes shares.
struct ShapeSet {
  ShapeSet() = default;
  /// @throws std::invalid_argument  As Shapes.
  explicit ShapeSet(std::vector<Shape> shapes, std::vector<ContactRule> contacts = {});

  std::vector<Shape> shapes;
  std::vector<std::string> names;  ///< of the shapes, as rules of contact know them
  std::vector<ContactRule> contacts;
  std::vector<Solid> parts;  ///< of all shapes, one after the other
  std::vector<int> owners;   ///< of the parts: their places in `shapes`
  ShapeTree tree;            ///< of the parts
  bool has_surfaces = false;
  double steepest = 1.0;  ///< what distances from them change by at most, per length
};

/// The one without any.
std::shared_ptr<const ShapeSet> no_shapes();

}  // namespace pdoik::detail
