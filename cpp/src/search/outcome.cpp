#include "search/outcome.hpp"

#include "problem/goal_term.hpp"

namespace pdoik::detail {

std::optional<Status> why_hopeless(const Model& model, std::span<const Goal> goals,
                                   bool base_collides) {
  if (base_collides) return Status::BaseCollision;
  const Frame base = to_frame(Eigen::Isometry3d::Identity());
  for (const Goal& goal : goals) {
    if (model.beyond_reach(goal) > 0.0) return Status::OutOfReach;
    if (goal.relative_to >= 0 || goal.soft || goal.type == GoalType::CenterOfMass) continue;
    const int link = model.robot.tips()[static_cast<std::size_t>(goal.tip)];
    if (model.robot.body_of_link(link) > 0) continue;
    GoalTerm term(model.robot, model.options, goal);
    term.place(base);  // which no joint moves
    if (!term.is_met()) return Status::OutOfReach;
  }
  return std::nullopt;
}

void name_base_contact(const Scene& scene, const Options& options, Result& result) {
  if (result.status != Status::BaseCollision) return;
  using Kind = WorstConstraint::Kind;
  const Clearance& point = scene.fixed();  // radii include the clearance that is wanted
  const ShapeClearance& shape = scene.fixed_to_shapes();
  const double by_point = -point.distance, by_shape = options.clearance - shape.distance;
  result.worst = by_point > by_shape
                     ? WorstConstraint{Kind::Clearance, point.source, point.obstacle,
                                       by_point - options.clearance_tolerance}
                     : WorstConstraint{Kind::Shape, shape.source, shape.shape,
                                       by_shape - options.clearance_tolerance};
}

void begin_result(Result& result) {
  result.iterations = result.evaluations = result.restarts = result.late_evaluations = 0;
  result.success = result.holds = false;
  result.goal_index = 0;
}

void end_result(const std::optional<Status>& hopeless, const Deadline& deadline, double intake,
                Result& result) {
  result.status = result.success      ? Status::Solved
                  : result.holds      ? Status::Nearest
                  : hopeless          ? *hopeless
                  : deadline.struck() ? Status::TimeLimit
                                      : Status::Exhausted;
  result.time = deadline.elapsed();
  result.intake = intake;
}

}  // namespace pdoik::detail
