#include <gtest/gtest.h>

#include "binomial.hpp"
#include "solver_settings.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

TEST(SolverRepeats, gives_the_same_answer_whatever_it_solved_before) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  for_settings([&](const Options& options) {
    Random random(5);
    Solver used(robot, options);
    for (int k = 0; k < 12; ++k) {
      const Problem other = solvable_problem(robot, random, 40, 0.1),
                    problem = solvable_problem(robot, random, 15);
      used.set_obstacles(other.obstacles);
      used.solve(other.target);
      used.set_obstacles(problem.obstacles);
      const Result first = used.solve(problem.target), second = used.solve(problem.target);
      Solver fresh(robot, options);
      fresh.set_obstacles(problem.obstacles);
      const Result third = fresh.solve(problem.target);
      expect_same(first, second);
      expect_same(first, third);
    }
  });
}

TEST(SolverRepeats, forgets_the_points_when_there_are_none_any_more) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  for_settings([&](const Options& options) {
    Random random(8);
    Solver used(robot, options), fresh(robot, options);
    for (int k = 0; k < 20; ++k) {
      used.set_obstacles(random_obstacles(random, 40, 0.8, 0.2));  // some inside the arm
      used.solve(robot.fk(random_configuration(robot, random)));
      used.clear_obstacles();
      const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
      expect_same(used.solve(target), fresh.solve(target));
    }
  });
}

TEST(SolverRepeats, does_not_carry_bounds_of_turning_joints_from_one_start_to_the_next) {
  RobotDescription description;  // a turntable whose follower turns half as fast, then two slides
  description.links = {{.name = "a"}, {.name = "b"}, {.name = "c"}, {.name = "d"}};
  JointDescription follower = joint_between("b", "c", "follow", JointType::Continuous);
  follower.mimic = Mimic{"turn", 0.5, 0.0};
  follower.T_parent_child.translation().x() = 0.5;
  JointDescription slide = joint_between("c", "d", "slide", JointType::Prismatic, 0.0, 0.5);
  slide.axis = Eigen::Vector3d::UnitX();
  description.joints = {joint_between("a", "b", "turn", JointType::Continuous), follower, slide};
  const Robot robot(description);
  Random random(3);
  for (const InnerMethod inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    for (const Method method : {Method::Default, Method::Paper}) {
      SCOPED_TRACE(method == Method::Paper       ? "paper"
                   : inner == InnerMethod::Lbfgs ? "L-BFGS"
                                                 : "LM");
      const Options options = timeless(GoalType::Position, method, inner);
      Solver used(robot, options);
      int solved = 0;
      for (int k = 0; k < 30; ++k) {
        const Eigen::VectorXd q0 = Eigen::Vector2d(random.uniform(-20.0, 20.0), 0.2);
        const Eigen::Isometry3d target =
            robot.fk(Eigen::Vector2d(q0[0] + random.uniform(-3.0, 3.0), 0.3));
        const Result result = used.solve(target, q0),
                     fresh = Solver(robot, options).solve(target, q0);
        expect_same(result, fresh);
        EXPECT_LE(std::abs(result.q[0] - q0[0]), M_PI + 1e-9)
            << "joints without limits stay within half a turn";
        if (::testing::Test::HasFailure()) break;
        solved += result.success;
      }
      EXPECT_GE(solved, fewest_by_luck(30, method == Method::Paper ? 0.87 : 0.999));
    }
  }
}

TEST(SolverRepeats, solve_batch_gives_what_a_loop_gives_on_any_number_of_threads) {
  const Robot robot = with_hulls(Robot::builtin("iiwa14"));
  Random random(6);
  const ObstacleMatrix obstacles = random_obstacles(random, 20, 1.0, 0.03);
  std::vector<Eigen::Isometry3d> targets;
  std::vector<Eigen::VectorXd> starts;
  for (int k = 0; k < 40; ++k) {
    targets.push_back(robot.fk(random_configuration(robot, random)));
    starts.push_back(random_configuration(robot, random));
  }
  for_settings([&](Options options) {
    options.max_restarts = 10;
    Solver solver(robot, options);
    solver.set_obstacles(obstacles);
    for (const std::size_t given : {std::size_t{0}, std::size_t{1}, starts.size()}) {
      const std::span<const Eigen::VectorXd> q0(starts.data(), given);
      std::vector<Result> loop;
      for (std::size_t i = 0; i < targets.size(); ++i) {
        Result result;
        solver.solve(targets[i], given == 0 ? nullptr : &q0[given == 1 ? 0 : i], result);
        loop.push_back(result);
      }
      for (const int threads : {1, 2, 3, 0}) {
        SCOPED_TRACE(std::to_string(threads) + " threads, " + std::to_string(given) + " starts");
        const std::vector<Result> batch = solver.solve_batch(targets, q0, threads);
        ASSERT_EQ(batch.size(), loop.size());
        for (std::size_t i = 0; i < loop.size(); ++i) expect_same(batch[i], loop[i]);
      }
    }
  });
  EXPECT_TRUE(Solver(robot).solve_batch({}, {}, 3).empty());
}

TEST(SolverRepeats, obstacles_out_of_reach_change_no_answer_but_may_be_the_nearest) {
  const Robot robot = with_hulls(Robot::builtin("iiwa14"));
  Random random(11);
  for_settings([&](const Options& options) {
    for (int k = 0; k < 10; ++k) {
      const Problem problem = solvable_problem(robot, random, k % 3);
      ObstacleMatrix more(problem.obstacles.rows() + 30, 3);
      more.topRows(problem.obstacles.rows()) = problem.obstacles;
      for (Eigen::Index i = problem.obstacles.rows(); i < more.rows(); ++i) {
        more.row(i) = (random.uniform(2.5, 100.0) * random.direction()).transpose();
      }
      Solver without(robot, options), with(robot, options);
      without.set_obstacles(problem.obstacles);
      with.set_obstacles(more);
      const Result a = without.solve(problem.target), b = with.solve(problem.target);
      EXPECT_EQ(a.q, b.q);
      EXPECT_EQ(a.iterations, b.iterations);
      EXPECT_NEAR(b.clearance, brute_force_clearance(robot, b.q, more, 100), 1e-9);
    }
  });
}

TEST(SolverRepeats, cleared_obstacles_are_gone_and_more_than_max_obstacles_fit) {
  const Robot robot = with_hulls(Robot::builtin("ur10"));
  Random random(12);
  Options options = timeless(GoalType::Position);
  options.max_obstacles = 4;
  Solver solver(robot, options), empty(robot, options);
  const Problem problem = solvable_problem(robot, random, 50);
  solver.set_obstacles(problem.obstacles);
  const Result among = solver.solve(problem.target);
  EXPECT_NEAR(among.clearance, brute_force_clearance(robot, among.q, problem.obstacles, 100), 1e-9);
  solver.clear_obstacles();
  expect_same(solver.solve(problem.target), empty.solve(problem.target));
  EXPECT_TRUE(std::isinf(solver.solve(problem.target).clearance));
}

TEST(SolverRepeats, copies_and_moved_solvers_answer_like_the_original) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(13);
  const Problem problem = solvable_problem(robot, random, 30, 0.05);
  Solver original(robot, timeless());
  original.set_obstacles(problem.obstacles);
  const Result expected = original.solve(problem.target);
  Solver copy(original);
  original.clear_obstacles();
  expect_same(copy.solve(problem.target), expected);
  Solver moved_to(std::move(copy));
  expect_same(moved_to.solve(problem.target), expected);
}

TEST(SolverRepeats, more_restarts_never_make_the_best_found_worse) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(15);
  int improved = 0;
  for (int k = 0; k < 15; ++k) {
    const Problem problem = solvable_problem(robot, random, 15);
    Eigen::Isometry3d target = problem.target;
    target.translation() *= 1.6;  // mostly a little out of reach, never solved
    double last = std::numeric_limits<double>::infinity();
    for (const int restarts : {0, 1, 2, 5, 10, 20}) {
      Options options = timeless();
      options.max_restarts = restarts;
      Solver solver(robot, options);
      solver.set_obstacles(problem.obstacles);
      const Result result = solver.solve(target);
      if (result.success) break;
      const double rotation = solver.options().rotation_weight * result.rotation_error;
      const double depth = std::max(0.0, -result.clearance);
      const double shortfall =
          result.position_error * result.position_error + rotation * rotation + depth * depth;
      EXPECT_LE(shortfall, last * (1.0 + 1e-12));
      improved += shortfall < 0.99 * last && restarts > 0;
      last = shortfall;
    }
  }
  EXPECT_GT(improved, 10);
}

TEST(SolverRepeats, the_seed_changes_the_restarts_and_nothing_else) {
  const Robot robot = Robot::builtin("panda");
  Random random(14);
  int differ = 0;
  for (int k = 0; k < 40; ++k) {
    const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
    Options options = timeless();
    const Result a = Solver(robot, options).solve(target);
    options.seed = 77;
    const Result b = Solver(robot, options).solve(target);
    EXPECT_TRUE(a.restarts > 0 || a.q == b.q);
    differ += a.q != b.q;
  }
  EXPECT_GT(differ, 0);
}

}  // namespace
}  // namespace pdoik
