#pragma once

#include <Eigen/Core>
#include <memory>
#include <utility>

namespace pdoik {

/// Capsules, one row each: ends a and b and radius [m], shape (K, 7).
using CapsuleRows = Eigen::Matrix<double, Eigen::Dynamic, 7, Eigen::RowMajor>;

/// How deep places are below the surface of a solid, on a grid; < 0 outside.
struct DepthGrid {
  Eigen::Vector3i shape;   ///< places along x, y, z
  Eigen::Vector3d origin;  ///< the first place [m]
  double edge = 0.0;       ///< between neighbours [m]
  Eigen::ArrayXf depth;    ///< z runs fastest, (shape.prod(),) [m]
};

/// Moves capsules so that they hold points of a solid and what sticks out of it is least.
///
/// Descends by Adam on an augmented Lagrangian of
///     min  integral over the union, outside the solid, of f(distance)
///     such that no point is outside the union,
/// f = 1 + (distance / worst)^6, which punishes what sticks out farthest. The integral's derivative
/// is cheap (Reynolds): where the union's free surface moves outwards by dn it grows by f dn dA.
/// Points and distances are in single precision; the same input gives the same result.
class ShrinkWrap {
 public:
  /// @param points  What is to be held, (P, 3) [m].
  /// @param worst  The distance from where f grows fast [m].
  /// @throws std::invalid_argument if the grid's depth has not as many entries as its shape says,
  /// an edge or worst is not positive, or something is NaN or infinite.
  ShrinkWrap(const DepthGrid& grid, const Eigen::Matrix<double, Eigen::Dynamic, 3>& points,
             double worst);
  ShrinkWrap(ShrinkWrap&&) noexcept;             ///< moved, not copied
  ShrinkWrap& operator=(ShrinkWrap&&) noexcept;  ///< moved, not copied
  ~ShrinkWrap();

  /// The capsules after so many steps, which leave points outside by some tenths of a millimetre.
  /// @throws std::invalid_argument if a capsule is not finite or a radius not positive, as what
  /// follows does.
  CapsuleRows move(const CapsuleRows& capsules, int steps) const;

  /// The integral's derivative by each capsule's (a, b, radius) [m^2], (K, 7), from 64 points on
  /// each, which `turn` in [0, 1) shifts.
  CapsuleRows outside_gradient(const CapsuleRows& capsules, double turn) const;

  /// The points' part of the Lagrangian, over all of them, and its gradient, (K, 7): of each,
  ///     ((max(0, multiplier + rho g))^2 - multiplier^2) / (2 rho),
  /// where g is how far it is outside the nearest capsule.
  std::pair<double, CapsuleRows> lack(const CapsuleRows& capsules, double multiplier,
                                      double rho) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> impl_;
};

}  // namespace pdoik
