#pragma once

#include <algorithm>
#include <cmath>

namespace pdoik::detail {

/// By how much a hull must grow so that rounding in the coarse test misses nothing [m].
///
/// Single precision errs in (|d|^2 - A^2 + |h|^2) A^2 - (d.h)^2 by at most E, say; growing A by s
/// takes 2 A s (b^2 + 2 A s) from it at the tip, where it takes least. Either term alone gives an s
/// that suffices.
inline double coarse_slack(double A, double half_squared, double extent) {
  constexpr double kEpsilon = 4.0 * 6e-8;
  const double E = kEpsilon * A * A * A * (2.0 * A + extent);
  const double b2 = A * A - half_squared;
  const double thin = std::sqrt(E) / (2.0 * A);
  return 1e-6 * extent + (b2 > 0.0 ? std::min(thin, E / (2.0 * A * b2)) : thin);
}

/// Where a spheroid is deeper than some depth: within the spheroid whose semi-axes are shorter by
/// that much. (A ball of radius d fits into it about such a point, so that along any direction n
/// the point lies at least d inside the support |diag(a, b) n|, which is at most
/// |diag(a - d, b - d) n| + d.) Points with a radius r at that depth lie in it when its semi-major
/// axis is grown by r.
struct Core {
  double depth;  ///< at most what was asked: a spheroid has no core deeper than its semi-minor axis
  double foci;   ///< the core's half distance between foci, as a share of the spheroid's
};

/// @param half_squared  Half the distance between the foci, squared; zero for a sphere.
inline Core core_of(double semi_major, double half_squared, double depth) {
  const double minor2 = semi_major * semi_major - half_squared;
  if (!(minor2 > 0.0)) return {0.0, 1.0};
  const double minor = std::sqrt(minor2), d = std::min(depth, 0.99 * minor);
  return {d, std::sqrt(1.0 - 2.0 * d / (semi_major + minor))};
}

/// A spheroid about all that lies within a distance of another one.
struct Offset {
  double semi_major;
  double foci;  ///< half the distance between its foci, as a multiple of the other's
};

/// With semi-axes a' and b', where for some s > 0
///     a'^2 = a^2 (1 + g / s) + g (g + s)    and likewise b'.
/// Along a direction in which the spheroid's support is S, that of all within g is S + g, and
/// (S + g)^2 <= S^2 + g (S^2 / s + s) + g^2, which is the support of the new one, squared: equal
/// where S = s, so that it touches there.
///
/// @param half_squared  Half the distance between the foci, squared; zero for a sphere.
/// @param support  s; 0 for one that wastes little anywhere.
inline Offset offset_of(double semi_major, double half_squared, double g, double support) {
  const double minor2 = semi_major * semi_major - half_squared;
  if (!(half_squared > 0.0) || !(minor2 > 0.0) || !std::isfinite(g)) return {semi_major + g, 1.0};
  const double s = support > 0.0 ? support : std::sqrt(semi_major * std::sqrt(minor2));
  const double share = 1.0 + g / s;
  return {std::sqrt(semi_major * semi_major * share + g * (g + s)), std::sqrt(share)};
}

}  // namespace pdoik::detail
