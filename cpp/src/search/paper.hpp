#pragma once

#include "pdoik/solver.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// Algorithm IK to the letter, from one start.
void solve_as_in_the_paper(Workspace& workspace, const Request& request, Result& result);

}  // namespace pdoik::detail
