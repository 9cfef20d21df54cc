#pragma once

#include <Eigen/Core>
#include <span>

#include "pdoik/request.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// Where joints may be: within their limits, or where they are locked.
struct Bounds {
  Bounds(const Robot& robot, std::span<const Lock> locks)
      : lower(robot.lower()), upper(robot.upper()) {
    for (const Lock& lock : locks) lower[lock.joint] = upper[lock.joint] = lock.position;
  }
  Eigen::VectorXd lower, upper;
};

}  // namespace pdoik::detail
