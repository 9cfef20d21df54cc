#pragma once

#include <Eigen/Core>
#include <string>

#include "pdoik/robot.hpp"

namespace pdoik {

/// A description whose robot stands somewhere in the world: a massless link `world_link` is joined
/// to base_link by a fixed joint `<world_link>_joint`. Built with base_link = world_link, the robot
/// takes targets and obstacles, and gives its centre of mass, in the world's frame:
///
///     Robot(mounted(load_urdf(path), "left_ankle_link", T_world_base), "world", tips)
///
/// @param base_link  Any link. The root becomes the world's child; any other link, which has a
/// parent already, its parent, which is the same robot seen from the world.
/// @throws std::invalid_argument  base_link is not there, world_link or its joint already is, or
/// T_world_base is not a rigid transform.
RobotDescription mounted(RobotDescription description, const std::string& base_link,
                         const Eigen::Isometry3d& T_world_base,
                         const std::string& world_link = "world");

/// How far a floating base may go: x, y, z [m], yaw, pitch, roll [rad].
struct FloatingBaseBounds {
  Eigen::Matrix<double, 6, 1> lower = Eigen::Matrix<double, 6, 1>::Zero();  ///< [m], [rad]
  Eigen::Matrix<double, 6, 1> upper = Eigen::Matrix<double, 6, 1>::Zero();  ///< [m], [rad]
};

/// A description whose robot may go anywhere within bounds: six joints base_x, base_y, base_z,
/// base_yaw, base_pitch, base_roll between a massless link `world_link` and base_link,
///
///     T_world_base = Tx(x) Ty(y) Tz(z) Rz(yaw) Ry(pitch) Rx(roll),
///
/// with massless links base_x_link ... base_pitch_link between them. Built with base_link =
/// world_link, they are the first six entries of q, in this order.
/// @param base_link  Any link, as for `mounted`.
/// @param bounds  Finite, and of the pitch within (-pi/2, pi/2): at its ends yaw and roll turn
/// about the same axis, and one direction of turning is lost.
/// @throws std::invalid_argument  bounds that are not finite, out of order or too wide, naming the
/// entry; base_link is not there, or a link or joint of these names already is.
RobotDescription with_floating_base(RobotDescription description, const std::string& base_link,
                                    const FloatingBaseBounds& bounds,
                                    const std::string& world_link = "world");

}  // namespace pdoik
