#pragma once

#include "pdoik/options.hpp"
#include "pdoik/path.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// What a path is asked: throws std::invalid_argument that names the station.
void check_path(const PathRequest& request, const PathOptions& wanted, const Robot& robot,
                const Options& options);
/// The same of a move.
void check_motion(const MotionRequest& request, const MotionOptions& wanted, const Robot& robot,
                  const Options& options);

}  // namespace pdoik::detail
