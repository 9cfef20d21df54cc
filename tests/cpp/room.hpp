#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "pdoik/solver.hpp"

namespace pdoik::testing {

/// The least room of a configuration inside limits before contact with anything [m].
inline double room(Solver& solver, const Eigen::VectorXd& q) {
  Goal anywhere;
  anywhere.type = GoalType::Position;
  anywhere.position_slack.setConstant(std::numeric_limits<double>::infinity());
  Result verdict;
  solver.judge({&anywhere, 1}, q, verdict);
  EXPECT_LE(verdict.limit_violation, 1e-12);
  return std::min(verdict.clearance, verdict.self_distance);
}

}  // namespace pdoik::testing
