#pragma once

/// Inlined everywhere, so that a kernel compiled for wider instructions shares no function with
/// code that is not, and how vectors are passed is moot.
#define PDOIK_INLINE inline __attribute__((always_inline))
#pragma GCC diagnostic ignored "-Wpsabi"

namespace pdoik::detail {

/// Four doubles that the compiler keeps in vector registers (two of them without AVX).
typedef double Vec4 __attribute__((vector_size(32)));

PDOIK_INLINE Vec4 broadcast(double v) { return Vec4{v, v, v, v}; }
PDOIK_INLINE double dot3(const Vec4& a, const Vec4& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
PDOIK_INLINE Vec4 cross3(const Vec4& a, const Vec4& b) {
  return Vec4{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0], 0.0};
}

}  // namespace pdoik::detail
