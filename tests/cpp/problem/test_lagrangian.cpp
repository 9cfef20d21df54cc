#include <gtest/gtest.h>

#include <limits>

#include "finite_differences.hpp"
#include "pdoik/lagrangian.hpp"
#include "solver_settings.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;
using Variables = Lagrangian::Variables;

Options paper_options() {
  Options options;
  options.method = Method::Paper;
  options.goal = GoalType::Axis;
  options.max_time = std::numeric_limits<double>::infinity();
  return options;
}

TEST(Lagrangian, has_the_gradient_of_its_value_in_slack_and_in_positions) {
  Random random(1);
  const Robot robot = with_hulls(Robot::builtin("panda"));
  for (const Variables variables : {Variables::Slack, Variables::Positions}) {
    Lagrangian problem(robot, paper_options(), variables);
    int touching = 0;
    for (int k = 0; k < 30; ++k) {
      problem.set_target(robot.fk(random_configuration(robot, random)));
      problem.set_obstacles(random_obstacles(random, 30, 0.6, 0.1));
      const Penalty penalty{PenaltyForm::Smooth, 10.0};
      const Eigen::VectorXd x = problem.variables(random_configuration(robot, random));
      problem.update_multipliers(x, penalty);
      Eigen::VectorXd gradient, ignored;
      problem.lagrangian(x, penalty, gradient);
      touching += problem.last_max_constraint() > 0.0;
      const Eigen::VectorXd difference = central_gradient(
          [&](const Eigen::VectorXd& at) { return problem.lagrangian(at, penalty, ignored); }, x,
          1e-6);
      EXPECT_LT((gradient - difference).norm(), 1e-6 * (1.0 + gradient.norm()));
    }
    EXPECT_GT(touching, 10);
  }
}

TEST(Lagrangian, under_augmented_lagrangian_is_the_papers_method) {
  Random random(2);
  const Robot robot = with_hulls(Robot::builtin("ur10"));
  Options options = paper_options();
  options.position_tolerance = options.rotation_tolerance = 1e-300;  // no early stop
  Solver solver(robot, options);
  Lagrangian problem(robot, options);
  AugmentedLagrangianOptions outer = options.augmented_lagrangian;
  outer.form = PenaltyForm::Printed;
  AugmentedLagrangian minimiser(problem.size(), outer, options.lbfgs);
  for (int k = 0; k < 10; ++k) {
    const Problem task = solvable_problem(robot, random, 30);
    solver.set_obstacles(task.obstacles);
    problem.set_obstacles(task.obstacles);
    problem.set_target(task.target);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.size());
    const AugmentedLagrangianResult found = minimiser.minimize(problem, x);
    const Result result = solver.solve(task.target);
    EXPECT_EQ(result.q, problem.positions(x));
    EXPECT_EQ(result.iterations, found.iterations);
  }
}

TEST(Lagrangian, measures_the_errors_of_its_last_evaluation) {
  Random random(3);
  const Robot robot = with_hulls(Robot::builtin("iiwa14"));
  Lagrangian problem(robot, paper_options(), Variables::Positions);
  Solver solver(robot, paper_options());
  const Problem task = solvable_problem(robot, random, 40);
  problem.set_target(task.target);
  for (int k = 0; k < 10; ++k) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    Eigen::VectorXd gradient;
    problem.lagrangian(q, Penalty{}, gradient);
    Result judged;
    solver.judge(task.target, q, judged);
    EXPECT_NEAR(problem.last_position_error(), judged.position_error, 1e-12);
    EXPECT_NEAR(problem.last_rotation_error(), judged.rotation_error, 1e-9);
    EXPECT_EQ(problem.max_constraint(q), 0.0) << "no obstacles";
  }
}

TEST(Lagrangian, refuses_what_a_solver_refuses) {
  const Robot robot = Robot::builtin("panda");
  Lagrangian problem(robot);
  Eigen::Isometry3d bent = Eigen::Isometry3d::Identity();
  bent.linear() *= 1.1;
  EXPECT_THROW(problem.set_target(bent), std::invalid_argument);
  EXPECT_THROW(problem.set_obstacles(Eigen::MatrixXd::Zero(2, 5)), std::invalid_argument);
  EXPECT_THROW(problem.variables(Eigen::VectorXd::Zero(3)), std::invalid_argument);
  Options options;
  options.clearance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Lagrangian(robot, options), std::invalid_argument);
}

}  // namespace
}  // namespace pdoik
