#pragma once

#include <Eigen/Core>
#include <vector>

#include "obstacles/scene.hpp"
#include "pdoik/result.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// The distance of each obstacle of a scene at q; see Solver::clearances.
std::vector<ObstacleClearance> clearances(const Model& model, const Scene& scene,
                                          const Eigen::VectorXd& q);

}  // namespace pdoik::detail
