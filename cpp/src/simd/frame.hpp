#pragma once

#include "simd/vec4.hpp"

namespace pdoik::detail {

/// A rigid transform by columns: axes x, y, z and origin p, each padded to four. Its alignment is
/// spelt out because without AVX the compiler would choose 16, and kernels must see the same
/// layout.
struct alignas(32) Frame {
  Vec4 x, y, z, p;
};

PDOIK_INLINE Vec4 rotate(const Frame& T, const Vec4& v) {
  return T.x * broadcast(v[0]) + T.y * broadcast(v[1]) + T.z * broadcast(v[2]);
}
PDOIK_INLINE Vec4 transform(const Frame& T, const Vec4& v) { return rotate(T, v) + T.p; }
PDOIK_INLINE Frame compose(const Frame& A, const Frame& B) {
  return {rotate(A, B.x), rotate(A, B.y), rotate(A, B.z), transform(A, B.p)};
}

}  // namespace pdoik::detail
