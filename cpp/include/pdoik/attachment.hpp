#pragma once

#include <string>
#include <vector>

#include "pdoik/contact_rule.hpp"
#include "pdoik/shape.hpp"

namespace pdoik {

/// Solids that are attached to links: an object in a hand, or one between two hands.
struct Attachment {
  /// The links that they are attached to: they move with the first. All of these, what is rigid to
  /// them and what comes after them, as fingers do, may touch them. That the others stay where they
  /// hold them is for goals to say, see Goal::relative_to.
  std::vector<std::string> links;
  std::vector<Shape> shapes;  ///< their poses are in the first link's frame
  /// Rules that count while they are attached, after those of a scene. They may speak of what is
  /// not there.
  std::vector<ContactRule> contacts = {};
};

}  // namespace pdoik
