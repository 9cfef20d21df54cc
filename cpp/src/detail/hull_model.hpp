#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "detail/frame.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// A point of the robot that distances are measured from: u_i of the paper, or any further one.
struct AttachedPoint {
  int body;
  Vec4 local;  ///< in the body's frame
};

/// A sphere (a == b, semi_major its radius) or a spheroid with foci at two attached points.
struct Hull {
  int a, b;
  double semi_major;
  int source;  ///< its place in the occupancy: spheres first, then spheroids
  bool is_sphere() const { return a == b; }
};

/// The robot's hulls on their attached points, each point once. Points on a joint's own axis belong
/// to the body before it, since that joint does not move them; hulls that no joint moves are kept
/// apart.
struct HullModel {
  /// @param with_fixed  Whether hulls that no joint moves are any.
  explicit HullModel(const Robot& robot, bool with_fixed = true);

  std::vector<AttachedPoint> points;
  std::vector<Hull> moving, fixed;
  /// No obstacle farther than this and twice its radius from `reach_centre` can touch a moving
  /// hull; infinite if unknown.
  Eigen::Vector3d reach_centre = Eigen::Vector3d::Zero();
  double reach = std::numeric_limits<double>::infinity();
};

}  // namespace pdoik::detail
