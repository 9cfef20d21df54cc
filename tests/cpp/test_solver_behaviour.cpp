#include <gtest/gtest.h>

#include "solver_settings.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

TEST(SolverBehaviour, joints_without_limits_stay_within_half_a_turn_of_the_start) {
  for_settings([&](const Options& options) {
    int solved = 0;
    for (int seed = 1; seed <= 40; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(static_cast<std::uint64_t>(seed));
      const Robot robot = random_robot(random, {.joints = 7, .continuous = 0.7});
      Solver solver(robot, options);
      Eigen::VectorXd q0 = random_configuration(robot, random);
      for (Eigen::Index i = 0; i < q0.size(); ++i) {
        if (std::isinf(robot.lower()[i])) q0[i] = random.uniform(-30.0, 30.0);
      }
      const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
      const Result result = solver.solve(target, q0);
      for (Eigen::Index i = 0; i < q0.size(); ++i) {
        EXPECT_TRUE(std::isfinite(robot.lower()[i]) ||
                    std::abs(result.q[i] - q0[i]) <= M_PI + 1e-12)
            << i;
      }
      EXPECT_TRUE(!result.success ||
                  position_error(robot, result.q, target) <= options.position_tolerance);
      solved += result.success;
    }
    EXPECT_GT(solved, 15);
  });
}

TEST(SolverBehaviour, ends_at_its_deadline_with_the_best_found_so_far_honestly_judged) {
  const Robot robot = with_hulls(Robot::builtin("ur10"));
  Random random(7);
  for_settings([&](Options options) {
    options.max_time = 1e-9;
    for (int k = 0; k < 20; ++k) {
      const Problem problem = solvable_problem(robot, random, 10);
      Solver solver(robot, options);
      solver.set_obstacles(problem.obstacles);
      const Result result = solver.solve(problem.target);
      EXPECT_EQ(result.status, Status::TimeLimit);
      EXPECT_FALSE(result.success);
      EXPECT_NEAR(result.position_error, position_error(robot, result.q, problem.target), 1e-10);
      EXPECT_NEAR(result.clearance, brute_force_clearance(robot, result.q, problem.obstacles, 100),
                  1e-9);
      EXPECT_EQ(result.restarts, 0);
      // A start that is a solution is one, however little time there is.
      const Result at_once = solver.solve(problem.target, problem.q);
      EXPECT_TRUE(at_once.success || options.method == Method::Paper ||
                  options.inner == InnerMethod::Lbfgs);
    }
  });
}

TEST(SolverBehaviour, a_start_that_is_a_solution_is_the_answer) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(8);
  for (int k = 0; k < 20; ++k) {
    const Problem problem = solvable_problem(robot, random, 10);
    Solver solver(robot, timeless());
    solver.set_obstacles(problem.obstacles);
    const Result result = solver.solve(problem.target, problem.q);
    EXPECT_TRUE(result.success);
    EXPECT_LT((result.q - problem.q).norm(), 1e-12);
    EXPECT_EQ(result.iterations, 0);
  }
}

TEST(SolverBehaviour, targets_out_of_reach_are_called_so_and_targets_in_reach_are_not) {
  for (const std::string& arm : arm_names()) {
    const Robot robot = Robot::builtin(arm);
    Random random(9);
    for_settings([&](Options options) {
      options.max_restarts = 3;
      Solver solver(robot, options);
      for (int k = 0; k < 10; ++k) {
        Eigen::Isometry3d target = random.pose(0.1);
        target.translation() += 5.0 * random.direction();
        const Result result = solver.solve(target);
        EXPECT_EQ(result.status, Status::OutOfReach);
        EXPECT_FALSE(result.success);
        EXPECT_NEAR(result.position_error, position_error(robot, result.q, target), 1e-10);
        EXPECT_NE(solver.solve(robot.fk(random_configuration(robot, random))).status,
                  Status::OutOfReach);
      }
    });
  }
}

TEST(SolverBehaviour, a_point_in_a_hull_that_no_joint_moves_is_a_base_collision) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  for_settings([&](Options options) {
    options.max_restarts = 3;
    Random random(10);
    Solver solver(robot, options);
    ObstacleMatrix obstacles(2, 3);
    obstacles << 0.01, 0.02, 0.0, 3.0, 3.0, 3.0;  // in the ball around the base's origin; far away
    solver.set_obstacles(obstacles);
    for (int k = 0; k < 10; ++k) {
      const Result result = solver.solve(robot.fk(random_configuration(robot, random)));
      EXPECT_EQ(result.status, Status::BaseCollision);
      EXPECT_FALSE(result.success);
      EXPECT_LT(result.clearance, 0.0);
    }
    obstacles.row(0) << 0.0, 0.0, -0.0700005;  // half a tolerance outside of it
    solver.set_obstacles(obstacles);
    EXPECT_NE(solver.solve(robot.fk(robot.mid_configuration())).status, Status::BaseCollision);
  });
}

}  // namespace
}  // namespace pdoik
