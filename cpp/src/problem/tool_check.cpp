#include "problem/tool_check.hpp"

#include <algorithm>

#include "kinematics/goal_of.hpp"
#include "obstacles/clearance.hpp"

namespace pdoik::detail {

ToolCheck::ToolCheck(const Model& model) : model_(model) {
  const Robot& robot = model.robot;
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(robot.mid_configuration(), T_base_body);
  for (const int tip : robot.tips()) {
    auto tool = std::make_unique<Tool>();
    tool->body = robot.body_of_link(tip);
    tool->from_body = robot.T_body_link(tip).translation().norm();
    const Eigen::Isometry3d T_tool_base =
        T_base_body[static_cast<std::size_t>(tool->body)].inverse();
    for (const Hull& hull : model.hulls.moving) {
      const auto is_carried = [&](int point) {
        return is_carried_by(robot, model.hulls.points[static_cast<std::size_t>(point)],
                             tool->body);
      };
      if (hull.has_capsules() ? hull.body != tool->body
                              : !is_carried(hull.a) || !is_carried(hull.b))
        continue;
      tool->hulls.push_back(hull);
      for (const int k : {hull.a, hull.b}) {
        const AttachedPoint& point = model.hulls.points[static_cast<std::size_t>(k)];
        tool->points.emplace_back(k, T_tool_base *
                                         T_base_body[static_cast<std::size_t>(point.body)] *
                                         to_vector3(point.local));
        const Eigen::Vector3d from =
            tool->points.back().second - robot.T_body_link(tip).translation();
        tool->arm = std::max(tool->arm, from.norm() + 2.0 * hull.semi_major + hull.excess);
      }
    }
    tool->state = std::make_unique<CollisionState>(model.hulls, tool->hulls);
    tool->state->reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
    tool->capsules =
        std::make_unique<HullCapsules>(robot, model.hulls, tool->hulls, model.options.clearance);
    tools_.push_back(std::move(tool));
  }
}

void ToolCheck::attach(const Scene& scene) {
  attachments_.reset();
  if (scene.attachments().count() > 0)
    attachments_.emplace(model_.robot, model_.hulls, model_.options, scene.attachments());
}

std::optional<WorstConstraint> ToolCheck::contact(std::span<const Goal> goals, const Scene& scene) {
  std::optional<WorstConstraint> worst;
  for (const Goal& goal : goals) {
    if (goal.type != GoalType::Pose || !has_place(goal) || has_slack(goal) ||
        goal.priority != Priority::Both)
      continue;
    Tool& tool = *tools_[static_cast<std::size_t>(goal.tip)];
    if (tool.hulls.empty() && !attachments_) continue;
    const auto found = contact(tool, goal, scene);
    if (found && (!worst || found->violation > worst->violation)) worst = found;
  }
  return worst;
}

std::optional<WorstConstraint> ToolCheck::contact(Tool& tool, const Goal& goal,
                                                  const Scene& scene) {
  using Kind = WorstConstraint::Kind;
  const Options& options = model_.options;
  const int tip = model_.robot.tips()[static_cast<std::size_t>(goal.tip)];
  const Eigen::Isometry3d T_base_tool =
      goal.T_base_tip * (model_.robot.T_body_link(tip) * goal.T_tip_tool).inverse();
  CollisionState& state = *tool.state;
  for (const auto& [point, local] : tool.points)
    state.place(static_cast<std::size_t>(point), to_vec4(T_base_tool * local));
  state.place_frame(tool.body, to_frame(T_base_tool));
  // Within its tolerances the tool may still come clear of this much.
  const double off = std::max(options.position_tolerance, goal.position_tolerance),
               turned = std::max(options.rotation_tolerance, goal.rotation_tolerance),
               length = goal.T_tip_tool.translation().norm();
  const double slack = options.clearance_tolerance + off + turned * (tool.arm + length);
  std::optional<WorstConstraint> worst;
  if (scene.within_reach() > 0) {
    const Clearance least = least_clearance_within(state, scene.obstacles(), 0.0, {-slack, -1, -1});
    if (least.source >= 0) {
      worst = {Kind::Clearance, least.source, least.obstacle,
               -least.distance - options.clearance_tolerance};
    }
  }
  if (scene.shapes().count() > 0) {
    tool.capsules->place(state.positions(), state.frames());
    const ShapeClearance least =
        least_clearance(*tool.capsules, scene.shapes(), options.clearance - slack);
    const double violation = options.clearance - least.distance - options.clearance_tolerance;
    if (least.shape >= 0 && (!worst || violation > worst->violation))
      worst = {Kind::Shape, least.source, least.shape, violation};
  }
  if (!attachments_) return worst;
  for (int k = 0; k < scene.attachments().count(); ++k) {
    const AttachedSolid& attached = scene.attachments()[k];
    if (attached.body != tool.body) continue;
    attachments_->place_solid(k, to_frame(T_base_tool));
    const double arm =
        std::sqrt(dot3(attached.solid.centre(), attached.solid.centre())) + attached.solid.radius();
    const double play = std::max(
        slack, options.clearance_tolerance + off + turned * (arm + tool.from_body + length));
    const auto add = [&](const std::optional<AttachmentNear>& near) {
      if (!near) return;
      const double violation = -near->distance - options.clearance_tolerance;
      if (!worst || violation > worst->violation)
        worst = {near->kind, near->attached, near->other, violation};
    };
    add(attachments_->nearest_point(k, scene.obstacles(), -play));
    add(attachments_->nearest_shape(k, scene.shapes(), -play));
  }
  return worst;
}

}  // namespace pdoik::detail
