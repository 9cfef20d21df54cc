#pragma once

#include <limits>
#include <optional>
#include <string>

namespace pdoik {

/// How near two things may come to each other: links of the robot, shapes of a scene, what links
/// carry, and the points. All pairs of which no rule speaks keep Options::clearance, or
/// Options::self_clearance among links and what they carry.
///
///     ContactRule{"base", "table"}                contact does not count
///     ContactRule{"finger*", "cube", -0.005}      they may be 5 mm deep in each other
///     ContactRule{"box", "table", 0.0}            contact and no deeper
///     ContactRule{"hand", "*", 0.1}               0.1 m off all else
///     ContactRule{"hand", "glass", std::nullopt}  but as the options say off this
///
/// Each side is a name, or a pattern in which `*` stands for any characters and `?` for one. A name
/// also means the pieces of an object, NAME/1, NAME/2 and so on. Which side is which does not
/// matter. Of several rules that speak of a pair those with more exact names count before those
/// with patterns, as in MoveIt's allowed collision matrix entries do before defaults; of these the
/// last. Links that are joined, or that no joint moves against each other, are no pairs whatever
/// rules say; nor are two shapes.
struct ContactRule {
  /// What points are called.
  static constexpr const char* kPoints = "points";

  std::string one;    ///< a name or a pattern
  std::string other;  ///< the same
  /// Least distance that is wanted [m]; negative: how deep they may be in each other; minus
  /// infinity: contact does not count; none: as the options say, whatever other rules do.
  std::optional<double> clearance = -std::numeric_limits<double>::infinity();
  /// Whether there may be nothing of these names: for rules that come with a file, or for what
  /// comes and goes. Else that is an error.
  bool optional = false;

  /// Whether they say the same of the same names.
  bool operator==(const ContactRule&) const = default;
};

/// Says whether a rule may be used.
/// @throws std::invalid_argument  A name is empty, or the distance is NaN or beyond 1e6 m.
void check_contact_rule(const ContactRule& rule);

}  // namespace pdoik
