#pragma once

#include "pdoik/solver.hpp"
#include "search/multistart.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// The distinct solutions of a request, nearest to its start or posture first. The obstacles are
/// being read.
/// @param best  Where there is no solution: what comes nearest to one.
Solutions all_solutions(Workspace& workspace, Multistart& multistart, const Request& request,
                        const AllOptions& wanted, Result& best);

/// In how many ways whole turns leave a configuration inside limits.
int whole_turns(const Model& model, const Eigen::VectorXd& q);

}  // namespace pdoik::detail
