#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace pdoik::detail {

/// Euclidean distance from a point to the surface of a prolate spheroid, negative inside.
struct SpheroidDistance {
  double distance;
  Eigen::Vector3d nearest;  ///< the nearest surface point
};

/// Nearest point of the ellipse (x/a)^2 + (y/b)^2 = 1 to (px, py), a >= b > 0 and px, py >= 0.
///
/// Solves sum (e_i p_i / (t + e_i^2))^2 = 1 for the multiplier t by bisection-safeguarded Newton
/// (Eberly, "Distance from a point to an ellipse"), which converges from every point, the centre
/// included.
inline Eigen::Vector2d nearest_on_ellipse(double a, double b, double px, double py) {
  const double tiny = 1e-14 * a;
  if (py <= tiny) {
    const double reach = (a * a - b * b) / a;  // beyond it the vertex (a, 0) is nearest
    if (px >= reach) return {a, 0.0};
    const double x = px * a * a / (a * a - b * b);
    return {x, b * std::sqrt(std::max(0.0, 1.0 - (x / a) * (x / a)))};
  }
  // In s = t + b^2, which is small near the axis where t itself would lose all its digits.
  const double gap = (a - b) * (a + b);
  const auto value = [&](double s, double& slope) {
    const double ra = a * px / (s + gap), rb = b * py / s;
    slope = -2.0 * (ra * ra / (s + gap) + rb * rb / s);
    return ra * ra + rb * rb - 1.0;
  };
  double low = b * py;                       // value(low) >= 0
  double high = std::hypot(a * px, b * py);  // value(high) <= 0
  double s = std::clamp(b * b, low, high);   // the root for a point on the surface
  for (int i = 0; i < 100; ++i) {
    double slope;
    const double g = value(s, slope);
    (g > 0.0 ? low : high) = s;
    double next = s - g / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - s) <= 1e-16 * s) break;
    s = next;
  }
  return {a * a * px / (s + gap), b * b * py / s};
}

/// @param f1, f2  Foci [m].
/// @param semi_major  a, larger than half the distance of the foci [m].
inline SpheroidDistance spheroid_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& f1,
                                          const Eigen::Vector3d& f2, double semi_major) {
  const Eigen::Vector3d centre = 0.5 * (f1 + f2), half = 0.5 * (f2 - f1), from = point - centre;
  const double f = half.norm(), a = semi_major;
  const double b = std::sqrt(std::max((a - f) * (a + f), 0.0));
  const Eigen::Vector3d axis = f > 0.0 ? Eigen::Vector3d(half / f) : Eigen::Vector3d::UnitX();
  const double along = from.dot(axis);
  Eigen::Vector3d side = from - along * axis;
  double radial = side.norm();
  if (radial > 1e-300) {
    side /= radial;
  } else {
    side = axis.unitOrthogonal();
    radial = 0.0;
  }
  const Eigen::Vector2d q = nearest_on_ellipse(a, b, std::abs(along), radial);
  const double gap = std::hypot(std::abs(along) - q.x(), radial - q.y());
  const bool inside = (along / a) * (along / a) + (radial / b) * (radial / b) < 1.0;
  return {inside ? -gap : gap, centre + std::copysign(q.x(), along) * axis + q.y() * side};
}

}  // namespace pdoik::detail
