#pragma once

#include <Eigen/Core>

#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// An upper bound on how far something gets from the origin of the first moving body above it, and
/// that body; for what no joint moves, body 0.
struct Reach {
  int root = 0;
  double distance = 0.0;  ///< [m]; infinite beyond a sliding joint without limits
  double slides = 0.0;    ///< what of it is by joints that slide [m]

  /// The origin of the root, which no joint moves, in the base frame.
  Eigen::Vector3d centre(const Robot& robot) const {
    return robot.bodies()[static_cast<std::size_t>(root)].T_parent_joint.translation();
  }
};

/// @param offset  Its distance from the origin of the body that it is attached to [m].
Reach reach_of(const Robot& robot, int body, double offset);

/// How much larger or smaller than a usual arm a robot is: 1 for whatever reaches from 0.2 m to 3 m
/// with its farthest tip, and where that is not known for what slides, its reach over 1.2 m else.
double relative_size(const Robot& robot);

/// How far a sliding body gets from its place at position zero when its joint is between two
/// positions [m]; infinite if one of them is.
double farthest_slide(const Body& body, double lower, double upper);

}  // namespace pdoik::detail
