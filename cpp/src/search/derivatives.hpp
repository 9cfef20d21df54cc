#pragma once

#include "search/workspace.hpp"

namespace pdoik::detail {

/// How q follows its goals' targets, as Solver::derivatives says. Allocates.
Derivatives derivatives(Workspace& workspace, std::span<const Goal> goals,
                        const Eigen::VectorXd& q);

/// Whether six joints at q move a goal's tip in fewer than six ways.
bool is_singular(Workspace& workspace, std::span<const Goal> goals, const Eigen::VectorXd& q);

}  // namespace pdoik::detail
