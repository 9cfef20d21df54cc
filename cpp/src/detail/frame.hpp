#pragma once

#include <Eigen/Geometry>

// These functions are always inlined and never cross a library's border, so how they pass vectors
// is moot.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace pdoik::detail {

/// Four doubles that the compiler keeps in vector registers (two of them without AVX).
typedef double Vec4 __attribute__((vector_size(32)));

inline Vec4 broadcast(double v) { return Vec4{v, v, v, v}; }
inline double dot3(const Vec4& a, const Vec4& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec4 cross3(const Vec4& a, const Vec4& b) {
  return Vec4{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0};
}
inline Vec4 to_vec4(const Eigen::Vector3d& v) { return Vec4{v.x(), v.y(), v.z(), 0.0}; }
inline Eigen::Vector3d to_vector3(const Vec4& v) { return {v[0], v[1], v[2]}; }

/// A rigid transform by columns: axes x, y, z and origin p, each padded to four.
struct Frame {
  Vec4 x, y, z, p;
};

inline Frame to_frame(const Eigen::Isometry3d& T) {
  return {to_vec4(T.linear().col(0)), to_vec4(T.linear().col(1)), to_vec4(T.linear().col(2)),
          to_vec4(T.translation())};
}

inline Vec4 rotate(const Frame& T, const Vec4& v) {
  return T.x * broadcast(v[0]) + T.y * broadcast(v[1]) + T.z * broadcast(v[2]);
}
inline Vec4 transform(const Frame& T, const Vec4& v) { return rotate(T, v) + T.p; }

inline Frame compose(const Frame& A, const Frame& B) {
  return {rotate(A, B.x), rotate(A, B.y), rotate(A, B.z), transform(A, B.p)};
}

}  // namespace pdoik::detail
