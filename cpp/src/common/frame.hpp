#pragma once

#include <Eigen/Geometry>

#include "simd/frame.hpp"

namespace pdoik::detail {

inline Vec4 to_vec4(const Eigen::Vector3d& v) { return Vec4{v.x(), v.y(), v.z(), 0.0}; }
inline Eigen::Vector3d to_vector3(const Vec4& v) { return {v[0], v[1], v[2]}; }

/// A point in the frame's own coordinates.
PDOIK_INLINE Vec4 to_local(const Frame& T, const Vec4& p) {
  const Vec4 from = p - T.p;
  return Vec4{dot3(T.x, from), dot3(T.y, from), dot3(T.z, from), 0.0};
}

/// Another frame in the frame's own coordinates.
PDOIK_INLINE Frame to_local(const Frame& T, const Frame& other) {
  const auto turned = [&](const Vec4& v) {
    return Vec4{dot3(T.x, v), dot3(T.y, v), dot3(T.z, v), 0.0};
  };
  return {turned(other.x), turned(other.y), turned(other.z), to_local(T, other.p)};
}

inline Frame to_frame(const Eigen::Isometry3d& T) {
  return {to_vec4(T.linear().col(0)), to_vec4(T.linear().col(1)), to_vec4(T.linear().col(2)),
          to_vec4(T.translation())};
}

}  // namespace pdoik::detail
