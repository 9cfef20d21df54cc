#include "problem/explain.hpp"

#include <cmath>
#include <sstream>

#include "kinematics/goal_of.hpp"
#include "obstacles/describe.hpp"

namespace pdoik::detail {
namespace {

using Kind = WorstConstraint::Kind;

std::string number(double value, const char* unit) {
  std::ostringstream text;
  text.precision(3);
  text << value << " " << unit;
  return text.str();
}
std::string length(double metres) {
  return std::abs(metres) < 1.0 ? number(1e3 * metres, "mm") : number(metres, "m");
}
std::string angle(double radians) { return number(radians, "rad"); }

std::string tip_name(const Model& model, int tip) {
  return model.robot.tip_links()[static_cast<std::size_t>(tip)];
}

/// Of goals that no answer comes near: by how much.
std::string beyond_reach(const Model& model, std::span<const Goal> goals) {
  for (const Goal& goal : goals) {
    const double by = model.beyond_reach(goal);
    if (by > 0.0)
      return "the target of " + tip_name(model, goal.tip) + " lies " + length(by) +
             " farther away than its links stretch";
  }
  return "no joint moves a tip that has a goal elsewhere";
}

/// Where fewer joints move a tip than its goal fixes degrees of freedom.
std::string too_few_joints(const Model& model, std::span<const Goal> goals) {
  for (const Goal& goal : goals) {
    if (goal.type != GoalType::Pose || goal.soft || goal.priority != Priority::Both ||
        model.has_joints_for({&goal, 1}))
      continue;
    const int link = model.robot.tips()[static_cast<std::size_t>(goal.tip)];
    return "; " + std::to_string(model.joints_of(model.robot.body_of_link(link))) +
           " joints move " + tip_name(model, goal.tip) +
           ", a pose fixes 6: let its position come first (priority), or give it slack";
  }
  return "";
}

std::string shortfall(const Model& model, const Scene& scene, std::span<const Goal> goals,
                      const Result& result) {
  const WorstConstraint& worst = result.worst;
  double position = model.options.position_tolerance, rotation = model.options.rotation_tolerance;
  for (const Goal& goal : goals) {
    if (goal.tip != worst.index) continue;
    position = position_tolerance(goal, model.options);
    rotation = rotation_tolerance(goal, model.options);
  }
  switch (worst.kind) {
    case Kind::None:
      return "nothing was asked";
    case Kind::Position:
      return tip_name(model, worst.index) + " is " + length(result.position_error) +
             " off its target, tolerance " + length(position);
    case Kind::Rotation:
      return tip_name(model, worst.index) + " is turned " + angle(result.rotation_error) +
             " off its target, tolerance " + angle(rotation);
    case Kind::Limit:
      return describe(worst, model.robot, scene) + " is passed by " +
             number(worst.violation, "rad or m");
    case Kind::Balance:
      return describe(worst, model.robot, scene) + " is missed by " + length(worst.violation);
    default:
      return describe(worst, model.robot, scene) + " is " + length(worst.violation) +
             " less than asked";
  }
}

}  // namespace

std::string explain(const Model& model, const Scene& scene, const Request& request,
                    const Result& result) {
  const bool is_one_of = !request.any_of.empty();
  const std::span<const Goal> goals = request.alternative(result.goal_index);
  const std::string which = is_one_of ? "goal " + std::to_string(result.goal_index + 1) + " of " +
                                            std::to_string(request.any_of.size()) + ": "
                                      : "";
  if (result.success) return which + "solved";
  switch (result.status) {
    case Status::Nearest:
      return which + "the position is met, the orientation is " + angle(result.rotation_error) +
             " off: the nearest that was found";
    case Status::OutOfReach:
      return which + beyond_reach(model, goals);
    case Status::TimeLimit:
      return which + shortfall(model, scene, goals, result) + ": the best in " +
             number(1e3 * model.options.max_time, "ms") + too_few_joints(model, goals);
    case Status::BaseCollision:
      return which + shortfall(model, scene, goals, result) + ", and no joint moves that";
    case Status::Blocked:
      return which + shortfall(model, scene, goals, result) +
             " in every posture found that meets the target";
    default:
      return which + shortfall(model, scene, goals, result) + ": the best of " +
             std::to_string(result.restarts + 1) + " starts" + too_few_joints(model, goals);
  }
}

std::string explain(const Model& model, const Scene& scene, const PathEnd& end) {
  const WorstConstraint& worst = end.beyond.worst;
  if (worst.kind != Kind::Position && worst.kind != Kind::Rotation)
    return describe(worst, model.robot, scene);
  // The goal is not met a step further: what holds the joints.
  std::string limits;
  const Eigen::VectorXd& q = end.beyond.q;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool is_at_limit = q[i] <= model.robot.lower()[i] || q[i] >= model.robot.upper()[i];
    if (is_at_limit && model.matters[static_cast<std::size_t>(i)])
      limits += (limits.empty() ? "limit of " : " and ") +
                model.robot.joint_names()[static_cast<std::size_t>(i)];
  }
  return limits.empty() ? "a singularity or the end of its reach" : limits;
}

std::string explain(const Model& model, const Scene& scene, const PathRequest& request,
                    const PathResult& result) {
  const std::string stations = std::to_string(request.stations.size()) + " stations";
  if (result.status == PathStatus::Whole) return "one motion meets all " + stations;
  std::string why = result.status == PathStatus::Impossible
                        ? "no motion can meet all " + stations
                        : "no motion was found that meets all " + stations;
  if (result.status == PathStatus::Pieces)
    why = result.pieces.size() == 1
              ? "one motion meets all " + stations + ", and does not end where it began"
              : std::to_string(result.pieces.size()) + " motions meet all " + stations +
                    ", one does not";
  if (!result.unsolved.empty()) {
    const PathEnd& first = result.ends.front();
    const auto k = static_cast<std::size_t>(result.unsolved.front());
    const Request one{.goals = request.stations[k]};
    return why + "; station " + std::to_string(k) + ": " + explain(model, scene, one, first.beyond);
  }
  if (result.ends.empty()) return why;
  const PathEnd& farthest = result.ends.front();
  std::ostringstream text;
  text.precision(5);
  text << why << "; the farthest gets to " << farthest.at << " and ends by ";
  for (std::size_t k = 0; k < result.ends.size(); ++k)
    text << (k == 0 ? "" : ", others by ") << explain(model, scene, result.ends[k]);
  return text.str();
}

}  // namespace pdoik::detail
