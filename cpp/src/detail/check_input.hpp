#pragma once

#include <span>
#include <string>

#include "detail/complaint.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

// What enters at the border. Functions named check_ throw std::invalid_argument that names the
// thing, what was expected and what came; those named accepts_ say so in a complaint, without an
// allocation or exception, and return whether there is none.

/// Lengths beyond this are refused: rounding would blur distances [m].
constexpr double kLargestNumber = 1e6;

/// Whether a transform is finite, and its 3x3 part a rotation to 1e-6.
bool is_rigid(const Eigen::Isometry3d& T);
/// 1 to 64 joints.
void check_robot(const Robot& robot);
/// What a solver or a tracker is made of.
void check_set_up(const Robot& robot, const Options& options);
/// One tip, for what takes a target without saying whose it is.
void check_one_tip(const Robot& robot);
/// Goals for tips that there are, which do not contradict one another; what the method cannot do is
/// refused.
bool accepts_goals(std::span<const Goal> goals, const Robot& robot, const Options& options,
                   Complaint& complaint);
void check_goals(std::span<const Goal> goals, const Robot& robot, const Options& options);
/// @param which  Which of a batch it is; less than 0 for none.
void check_request(const Request& request, const Robot& robot, const Options& options,
                   int which = -1);
void check_all(const Request& request, const AllOptions& wanted, const Options& options);
/// Rigid to 1e-6.
void check_target(const Eigen::Isometry3d& T, const std::string& name = "T_base_tip");
/// Bounds on a step, one per joint, none negative; infinity is fine.
void check_step(const Eigen::VectorXd& step, int dof, const std::string& name);
/// The same, and finite.
void check_weights(const Eigen::VectorXd& weights, int dof, const std::string& name);
void check_configuration(VectorIn q, int dof, const std::string& name);
/// Finite rows of three or four, none beyond 1e6 m, no radius negative.
/// For Obstacles and ObstaclesF.
template <class Rows>
bool accepts_obstacles(const Rows& points, Complaint& complaint, const char* name = "obstacles");
void check_obstacles(const Obstacles& points);
/// As many points as places can be counted for, at most.
void check_count(Eigen::Index points, const char* name);

}  // namespace pdoik::detail
