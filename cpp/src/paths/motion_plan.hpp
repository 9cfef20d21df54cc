#pragma once

#include "pdoik/path.hpp"
#include "problem/bounds.hpp"
#include "search/multistart.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// A move to goals: see Solver::plan_motion. The obstacles are being read.
MotionResult plan_motion(Workspace& workspace, Multistart& multistart, const MotionRequest& request,
                         const MotionOptions& options, const Bounds& bounds);

}  // namespace pdoik::detail
