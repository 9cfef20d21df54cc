#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pdoik/contact_rule.hpp"
#include "pdoik/robot.hpp"

namespace pdoik {

/// The pairs of links that an SRDF file, MoveIt's companion of a URDF, says need no test against
/// each other: its `<disable_collisions link1= link2=>`, in the file's order. They go to
/// Robot::set_ignored_pairs, which knows whether the robot has these links. In pdoik::io.
/// @param path_or_xml  A file's path, or the XML text itself (recognised by its leading '<').
/// @throws LoadError  unreadable file, malformed XML, missing attribute, xacro, or
/// `<disable_default_collisions>`, which means pairs with all links of a robot; names the file and
/// the element.
std::vector<LinkPair> load_srdf_pairs(const std::string& path_or_xml);
/// Those of links that a robot has: an SRDF may be of a description with more, such as fingers.
/// After them, of each `<disable_default_collisions link=>` its pairs with all links, but for those
/// of `<enable_collisions link1= link2=>`.
std::vector<LinkPair> load_srdf_pairs(const std::string& path_or_xml, const Robot& robot);
/// The same as rules of contact for a scene: of a link whose collisions are off by default with
/// shapes, points and what links carry as well. All are optional.
std::vector<ContactRule> load_srdf_contacts(const std::string& path_or_xml);

/// Pairs of links that touch in at least `share` of random configurations, as MoveIt's Setup
/// Assistant finds them: hulls of links that are close but not joined, whose overlap says nothing.
/// Touching is judged by the robot's occupancy as for self-collision, each hull in the capsule
/// around it. Links that are joined are no pair, and the robot's ignored pairs count like any
/// other. Ordered as link_names.
///
/// Only what is certain to be a property of the hulls should be ignored: a pair that always touches
/// would make every configuration a collision.
/// @param samples  Configurations, uniform within limits; [-pi, pi] [rad] or [-1, 1] [m] where
/// there are none. The same robot, number and seed give the same answer.
/// @throws std::invalid_argument  samples below 1, share not in (0, 1].
std::vector<LinkPair> pairs_always_touching(const Robot& robot, int samples = 2000,
                                            std::uint64_t seed = 0, double share = 0.95);

/// Pairs of links that touch at one configuration which is known to be free, such as the one the
/// robot rests in.
/// @param q  shape (n,), [rad] or [m].
/// @throws std::invalid_argument on a wrong length.
std::vector<LinkPair> pairs_touching_at(const Robot& robot, VectorIn q);

}  // namespace pdoik
