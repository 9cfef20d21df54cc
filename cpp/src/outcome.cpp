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
