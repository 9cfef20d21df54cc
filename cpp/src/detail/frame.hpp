#pragma once

#include <Eigen/Geometry>

#include "simd/frame.hpp"

namespace pdoik::detail {

inline Vec4 to_vec4(const Eigen::Vector3d& v) { return Vec4{v.x(), v.y(), v.z(), 0.0}; }
inline Eigen::Vector3d to_vector3(const Vec4& v) { return {v[0], v[1], v[2]}; }

inline Frame to_frame(const Eigen::Isometry3d& T) {
  return {to_vec4(T.linear().col(0)), to_vec4(T.linear().col(1)), to_vec4(T.linear().col(2)),
          to_vec4(T.translation())};
}

}  // namespace pdoik::detail
