#pragma once

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// Why a link's mass and inertia cannot be those of a real body, or nothing.
inline std::string inertia_error(const LinkDescription& link) {
  const std::string what = "link '" + link.name + "': ";
  if (!std::isfinite(link.mass) || !link.inertia.allFinite() || !link.center_of_mass.allFinite()) {
    return what + "mass, centre of mass or inertia is not finite";
  }
  if (link.mass < 0.0) return what + "mass " + std::to_string(link.mass) + " kg is negative";
  if (link.mass == 0.0 && link.inertia.isZero()) return {};
  if (link.mass == 0.0) return what + "has an inertia but no mass";
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(link.inertia, Eigen::EigenvaluesOnly)
          .eigenvalues();
  const double slack = 1e-9 * std::max(1e-9, moments.cwiseAbs().maxCoeff());
  if (moments[0] < -slack) return what + "inertia is not physical: a principal moment is negative";
  if (moments[2] > moments[0] + moments[1] + slack) {
    return what +
           "inertia is not physical: the largest principal moment exceeds the sum of the others";
  }
  return {};
}

}  // namespace pdoik::detail
