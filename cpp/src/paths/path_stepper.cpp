#include "paths/path_stepper.hpp"

#include <cmath>

#include "kinematics/goal_of.hpp"
#include "search/outcome.hpp"

namespace pdoik::detail {
namespace {

/// Joints that follow a path between two places are off the straight way between both, half way,
/// by no more than a share of how far they go, a little, and as far as a tool's way there may take
/// them out and back: for each of PathGoals::way [rad] or [m].
constexpr double kBend = 0.6, kLittle = 0.01, kSwing = 0.6;
/// A way is halved so often, beyond stations, before it counts as a jump.
constexpr int kHalvings = 8;
/// Where the tool is looked at on a straight way: what bends evenly is off by most in the middle.
constexpr double kLooks[] = {0.5, 0.25, 0.75};
/// Of what the tool may be off by between two rows, since it is looked at in three places only.
constexpr double kShare = 0.7;

}  // namespace

PathStepper::PathStepper(Workspace& workspace, PathGoals& goals, const PathOptions& options,
                         const Deadline& deadline, const Eigen::VectorXd& lower,
                         const Eigen::VectorXd& upper)
    : workspace_(workspace),
      goals_(goals),
      options_(options),
      deadline_(deadline),
      lower_(lower),
      upper_(upper),
      sweep_(workspace) {
  for (Eigen::VectorXd* each : {&verdict_.q, &fault_.q, &at_, &low_, &high_})
    each->setZero(lower.size());
}

bool PathStepper::fail(double at, const Result& why) {
  fault_at_ = at;
  fault_ = why;
  return false;
}

bool PathStepper::stands(double at, const Eigen::VectorXd& q, PathPoint& point) {
  workspace_.watch(deadline_);
  begin_result(verdict_);
  workspace_.judge(goals_.at(at), q, verdict_, Sweep::kLook);
  if (!verdict_.holds) return fail(at, verdict_);
  point.at = at;
  point.q = q;
  point.room = sweep_.room(verdict_);
  return true;
}

bool PathStepper::bring(double at, const Eigen::VectorXd& from, double step, PathPoint& point) {
  workspace_.watch(deadline_);
  if (deadline_.passed()) return fail(at, verdict_);
  const std::span<const Goal> asked = goals_.at(at);
  workspace_.problem.set_goals(asked);
  low_ = (from.array() - step).max(lower_.array());
  high_ = (from.array() + step).min(upper_.array());
  at_ = from.cwiseMax(low_).cwiseMin(high_);
  begin_result(verdict_);
  workspace_.least_squares.count_goals_alone();
  workspace_.minimise(workspace_.patient, at_, low_, high_, verdict_);
  workspace_.judge(asked, at_, verdict_, Sweep::kLook);
  const bool is_reached = workspace_.least_squares.reached();
  workspace_.least_squares.count_all_obstacles();
  if (!verdict_.holds && is_reached) {
    workspace_.minimise(workspace_.patient, at_, low_, high_, verdict_);
    workspace_.judge(asked, at_, verdict_, Sweep::kLook);
  }
  if (!verdict_.holds) return fail(at, verdict_);
  point.at = at;
  point.q = at_;
  point.room = sweep_.room(verdict_);
  return true;
}

bool PathStepper::is_on_path(const PathPoint& one, const PathPoint& other) {
  for (const double share : kLooks) {
    at_ = one.q + share * (other.q - one.q);
    workspace_.problem.set_goals(goals_.at(one.at + share * (other.at - one.at)));
    workspace_.least_squares.place(at_);
    for (GoalTerm& goal : workspace_.problem.goals) {
      goal.place(workspace_.problem.rollout);
      if (goal.position_distance() > kShare * options_.position_tolerance ||
          goal.rotation_distance() > kShare * options_.rotation_tolerance)
        return false;
    }
  }
  return true;
}

void PathStepper::add_straight(const PathPoint& one, const PathPoint& other,
                               std::vector<PathPoint>& points) {
  const double step = (other.q - one.q).cwiseAbs().maxCoeff();
  const int pieces = std::max(1, static_cast<int>(std::ceil(step / options_.max_joint_step)));
  for (int k = 1; k < pieces; ++k) {
    const double share = static_cast<double>(k) / pieces;
    PathPoint& point = points.emplace_back();
    point.at = one.at + share * (other.at - one.at);
    point.q = one.q + share * (other.q - one.q);
    point.room = sweep_.room_at(goals_.at(point.at), point.q);
  }
  points.push_back(other);
}

bool PathStepper::bridge(const PathPoint& one, const PathPoint& other,
                         std::vector<PathPoint>& points) {
  workspace_.watch(deadline_);
  return bridge(one, other, points, 0);
}

bool PathStepper::bridge(const PathPoint& one, const PathPoint& other,
                         std::vector<PathPoint>& points, int depth) {
  if (deadline_.passed()) return fail(one.at, verdict_);
  const double first = std::floor(one.at), last = std::ceil(other.at);
  double swing = 0.0;
  double middle = 0.5 * (one.at + other.at);
  if (last - first > 1.0) {  // stations are between
    middle = std::clamp(std::round(middle), first + 1.0, last - 1.0);
    swing = kSwing * goals_.way(static_cast<int>(first), static_cast<int>(last));
  } else {
    const bool on_path = is_on_path(one, other);
    if (on_path) {
      if (sweep_.is_clear_between(goals_.at(middle), one.q, other.q, one.room, other.room)) {
        add_straight(one, other, points);
        return true;
      }
      fail(middle, sweep_.fault());
    }
    if (depth == kHalvings) {
      if (!on_path) {
        workspace_.judge(goals_.at(middle), at_, verdict_, Sweep::kLook);
        fail(middle, verdict_);
      }
      return false;
    }
    ++depth;
  }
  PathPoint between;
  const double share = (middle - one.at) / (other.at - one.at),
               farthest = (other.q - one.q).cwiseAbs().maxCoeff();
  at_ = one.q + share * (other.q - one.q);
  const Eigen::VectorXd straight = at_;
  return bring(middle, straight, kBend * farthest + kLittle + swing, between) &&
         bridge(one, between, points, depth) && bridge(between, other, points, depth);
}

}  // namespace pdoik::detail
