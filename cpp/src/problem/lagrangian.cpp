#include "pdoik/lagrangian.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/check_input.hpp"
#include "obstacles/check_obstacles.hpp"
#include "obstacles/scene.hpp"
#include "pdoik/point_cloud.hpp"
#include "problem/check_options.hpp"
#include "problem/check_request.hpp"
#include "problem/lagrangian_problem.hpp"

namespace pdoik {
namespace {

void check_variables(const Eigen::VectorXd& x, Eigen::Index size) {
  if (x.size() == size) return;
  throw std::invalid_argument("x has " + std::to_string(x.size()) + " entries, expected " +
                              std::to_string(size));
}

JointLimitMap::Variables map_variables(Lagrangian::Variables variables) {
  return variables == Lagrangian::Variables::Slack ? JointLimitMap::Variables::Slack
                                                   : JointLimitMap::Variables::Positions;
}

}  // namespace

/// The solver's parts without its searches, kept at one address.
struct Lagrangian::Implementation {
  Implementation(const Robot& robot_in, const Options& options_in, Variables variables)
      : model(robot_in, options_in),
        scene(model.robot, model.hulls, model.options),
        problem(model, scene),
        map(model.robot, map_variables(variables)),
        form(map, problem) {
    Goal goal;  // until set_target or set_goals
    goal.type = model.options.goal;
    goal.axis = model.options.goal_axis;
    problem.goals.emplace_back(model.robot, model.options, goal);
    set_obstacles(Points(0, 3));
  }

  void set_obstacles(const Obstacles& points) {
    scene.assign(points);
    scene.read();
    problem.constraints.hulls.reserve(scene.obstacles()->padded());
    form.reserve(scene.obstacles()->padded());
    form.reset_multipliers();
  }

  detail::Model model;
  detail::Scene scene;
  detail::Problem problem;
  JointLimitMap map;
  detail::LagrangianProblem form;
};

Lagrangian::Lagrangian(const Robot& robot, const Options& options, Variables variables) {
  detail::check_options(options);
  detail::check_robot(robot);
  impl_ = std::make_unique<Implementation>(robot, options, variables);
}
Lagrangian::Lagrangian(Lagrangian&&) noexcept = default;
Lagrangian& Lagrangian::operator=(Lagrangian&&) noexcept = default;
Lagrangian::~Lagrangian() = default;

const Robot& Lagrangian::robot() const { return impl_->model.robot; }
const Options& Lagrangian::options() const { return impl_->model.options; }

void Lagrangian::set_target(const Eigen::Isometry3d& T_base_tip) {
  detail::check_one_tip(robot());
  detail::check_target(T_base_tip);
  impl_->problem.goals.front().set_target(T_base_tip);
  impl_->form.reset_multipliers();
}

void Lagrangian::set_goals(std::span<const Goal> goals) {
  Options points = options();  // its goals are points, which know no slack
  points.method = Method::Paper;
  detail::check_goals(goals, robot(), points);
  impl_->problem.set_goals(goals);
  impl_->form.reset_multipliers();
}

void Lagrangian::set_obstacles(const Obstacles& points) {
  detail::check_count(points.rows(), "obstacles");
  const Obstacles own = impl_->scene.copied(points);
  detail::check_obstacles(own);
  impl_->set_obstacles(own);
}

Eigen::Index Lagrangian::size() const { return impl_->map.size(); }

Eigen::VectorXd Lagrangian::variables(VectorIn q) const {
  detail::check_configuration(q, impl_->model.robot.dof(), "q");
  Eigen::VectorXd x(size());
  impl_->map.inverse(q, x, impl_->model.options.start_inset);
  return x;
}

Eigen::VectorXd Lagrangian::positions(const Eigen::VectorXd& x) const {
  check_variables(x, size());
  Eigen::VectorXd q(impl_->model.robot.dof());
  impl_->map.positions(x, q);
  return q;
}

double Lagrangian::lagrangian(const Eigen::VectorXd& x, const Penalty& penalty,
                              Eigen::VectorXd& gradient) {
  check_variables(x, size());
  gradient.resize(size());
  return impl_->form.lagrangian(x, penalty, gradient);
}

double Lagrangian::max_constraint(const Eigen::VectorXd& x) {
  check_variables(x, size());
  return impl_->form.max_constraint(x);
}

void Lagrangian::reset_multipliers() { impl_->form.reset_multipliers(); }

void Lagrangian::update_multipliers(const Eigen::VectorXd& x, const Penalty& penalty) {
  check_variables(x, size());
  impl_->form.update_multipliers(x, penalty);
}

double Lagrangian::last_position_error() const {
  double worst = 0.0;
  for (const auto& goal : impl_->problem.goals) worst = std::max(worst, goal.position_distance());
  return worst;
}

double Lagrangian::last_rotation_error() const {
  double worst = 0.0;
  for (const auto& goal : impl_->problem.goals) worst = std::max(worst, goal.rotation_distance());
  return worst;
}

double Lagrangian::last_max_constraint() const { return impl_->form.last_max_constraint(); }

}  // namespace pdoik
