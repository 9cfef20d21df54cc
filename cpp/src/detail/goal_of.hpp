#pragma once

#include "pdoik/options.hpp"

namespace pdoik::detail {

/// The goal of the options' type for a tip.
inline Goal goal_of(const Options& options, const Eigen::Isometry3d& T_base_tip, int tip = 0) {
  Goal goal;
  goal.tip = tip;
  goal.T_base_tip = T_base_tip;
  goal.type = options.goal;
  goal.axis = options.goal_axis;
  return goal;
}

}  // namespace pdoik::detail
