#pragma once

#include <span>

#include "common/input_error.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

// What a solver and a tracker are asked, checked as common/check_input.hpp says.

/// 1 to 64 joints.
void check_robot(const Robot& robot);
/// What a solver or a tracker is made of.
void check_set_up(const Robot& robot, const Options& options);
/// One tip, for what takes a target without saying whose it is.
void check_one_tip(const Robot& robot);
/// Goals for tips that there are, which do not contradict one another; what the method cannot do is
/// refused.
bool accepts_goals(std::span<const Goal> goals, const Robot& robot, const Options& options,
                   InputError& error);
void check_goals(std::span<const Goal> goals, const Robot& robot, const Options& options);
/// @param which  Which of a batch it is; less than 0 for none.
void check_request(const Request& request, const Robot& robot, const Options& options,
                   int which = -1);
void check_all(const Request& request, const AllOptions& wanted, const Options& options);

}  // namespace pdoik::detail
