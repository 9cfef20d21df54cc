#pragma once

#include "detail/bounds.hpp"
#include "detail/restarts.hpp"
#include "detail/workspace.hpp"
#include "pdoik/path.hpp"

namespace pdoik::detail {

/// A move to goals: see Solver::plan_motion. The obstacles are being read.
MotionResult plan_motion(Workspace& workspace, Restarts& restarts, const MotionRequest& request,
                         const MotionOptions& options, const Bounds& bounds);

}  // namespace pdoik::detail
