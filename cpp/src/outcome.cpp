#include "detail/outcome.hpp"

#include "detail/goal_term.hpp"

namespace pdoik::detail {

std::optional<Status> why_hopeless(const Model& model, std::span<const Goal> goals,
                                   bool base_collides) {
  if (base_collides) return Status::BaseCollision;
  const Frame base = to_frame(Eigen::Isometry3d::Identity());
  for (const Goal& goal : goals) {
    if (model.is_out_of_reach(goal)) return Status::OutOfReach;
    GoalTerm term(model.robot, goal);
    if (term.body() > 0) continue;
    term.place(base);  // which no joint moves
    if (term.position_distance() > model.options.position_tolerance ||
        term.rotation_distance() > model.options.rotation_tolerance)
      return Status::OutOfReach;
  }
  return std::nullopt;
}

void begin_result(Result& result) {
  result.iterations = result.evaluations = result.restarts = result.late_evaluations = 0;
  result.success = false;
}

void end_result(const std::optional<Status>& hopeless, const Deadline& deadline, double intake,
                Result& result) {
  result.status = result.success      ? Status::Solved
                  : hopeless          ? *hopeless
                  : deadline.struck() ? Status::TimeLimit
                                      : Status::Exhausted;
  result.time = deadline.elapsed();
  result.intake = intake;
}

}  // namespace pdoik::detail
