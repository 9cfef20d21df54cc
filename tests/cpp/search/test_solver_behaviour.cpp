#include <gtest/gtest.h>

#include "binomial.hpp"
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
    EXPECT_GE(solved, fewest_by_luck(40, options.method == Method::Paper ? 0.7 : 0.999));
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

TEST(SolverBehaviour, a_point_in_a_hull_that_no_joint_moves_may_be_let_pass) {
  const Robot robot = Robot::builtin("panda");
  Options options;
  options.base_collision = false;
  options.self_collision = false;
  Solver solver(robot, options);
  ObstacleMatrix points(2, 3);
  points << 0.0, 0.0, 0.05, 0.5, 0.5, 0.9;  // in the foot, and somewhere
  Random random(4);
  int solved = 0;
  for (int k = 0; k < 20; ++k) {
    const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
    solver.set_obstacles(points.bottomRows(1));
    const Result without = solver.solve(target);
    solver.set_obstacles(points);
    const Result with = solver.solve(target);
    EXPECT_EQ(with.q, without.q);
    EXPECT_EQ(with.success, without.success);
    EXPECT_EQ(with.clearance > 0.0, with.success) << "that of the hulls that count";
    solved += with.success;
    // What moves is still held off: deep in the flange, deeper than its capsules stand beyond it.
    solver.set_obstacles((target * Eigen::Vector3d(0.0, 0.0, -0.05)).transpose());
    EXPECT_FALSE(solver.solve(target).success);
  }
  EXPECT_GE(solved, fewest_by_luck(20, 0.999));
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

TEST(SolverBehaviour, with_a_start_given_answers_stay_near_it_where_they_can) {
  // The known configuration lies a little beside the start, a point in the start's way.
  const Robot robot = without_capsules(Robot::builtin("iiwa14"));
  Random random(12);
  Options options;
  options.goal = GoalType::Axis;
  options.max_time = std::numeric_limits<double>::infinity();
  Solver solver(robot, options);
  double with_start = 0.0, without = 0.0;
  int counted = 0;
  for (int k = 0; k < 60; ++k) {
    const Eigen::VectorXd q0 = random_configuration(robot, random);
    const Eigen::Isometry3d target = robot.fk(q0);
    ObstacleMatrix point(1, 4);
    const Spheroid& hull = robot.occupancy().spheroids[8];
    point << (robot.fk(q0, hull.link_a) * hull.focus_a).transpose() +
                 Eigen::RowVector3d(0.09, 0, 0),
        0.02;
    solver.set_obstacles(point);
    const Result near = solver.solve(target, q0), any = solver.solve(target);
    if (!near.success || !any.success) continue;
    ++counted;
    with_start += (near.q - q0).cwiseAbs().maxCoeff();
    without += (any.q - q0).cwiseAbs().maxCoeff();
  }
  EXPECT_GT(counted, 40);
  EXPECT_LT(with_start, 0.4 * without);
}

TEST(SolverBehaviour, joints_that_move_neither_tip_nor_hull_stay_where_they_start) {
  RobotDescription description;  // two arms at one base; only one of them is asked for
  description.links = {{.name = "base"}};
  for (const std::string side : {"left", "right"}) {
    for (int i = 0; i < 4; ++i) {
      const std::string child = side + std::to_string(i);
      const std::string parent = i == 0 ? "base" : side + std::to_string(i - 1);
      JointDescription joint =
          joint_between(parent, child, child + "_joint", JointType::Revolute, -2.0, 2.5);
      joint.axis = i % 2 == 0 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
      joint.T_parent_child.translation().x() = 0.3;
      description.links.push_back({.name = child});
      description.joints.push_back(joint);
    }
  }
  const Robot robot(description, "base", {"right3"});
  int restarts = 0;
  for_settings([&](const Options& all) {
    Options options = all;
    options.goal = GoalType::Position;
    options.max_restarts = 5;
    Random random(16);
    Solver solver(robot, options);
    for (int k = 0; k < 20; ++k) {
      Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
      if (k % 2 == 0) target.translation() *= 3.0;  // out of reach: restarts
      const Eigen::VectorXd q0 = random_configuration(robot, random, 0.05);
      const Result result = solver.solve(target, q0);
      restarts += result.restarts;
      EXPECT_LT((result.q - q0).head(4).lpNorm<Eigen::Infinity>(), 1e-12) << "the left arm moved";
      EXPECT_GT((result.q - q0).tail(4).norm(), 1e-6);
    }
  });
  EXPECT_GT(restarts, 50);
}

TEST(SolverBehaviour, arms_of_any_size_are_solved_alike) {
  // One arm of six joints, from a millimetre's reach to a kilometre's.
  const auto arm = [](double size) {
    std::vector<DhRow> rows;
    for (int i = 0; i < 6; ++i) {
      rows.push_back({.alpha = i == 0 ? 0.0 : (i % 2 == 1 ? M_PI_2 : -M_PI_2),
                      .a = i % 2 == 1 ? 0.2 * size : 0.0,
                      .d = 0.1 * size,
                      .lower = -2.5,
                      .upper = 2.5});
    }
    return Robot::from_dh(rows);
  };
  for (const InnerMethod inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    for (const double size : {1e-3, 1e-2, 1.0, 1e2, 1e3}) {
      const Robot robot = arm(size);
      Options options = timeless();
      options.inner = inner;
      options.max_restarts = 20;
      options.position_tolerance = 1e-5 * size;
      Solver solver(robot, options);
      Random random(4);
      int solved = 0;
      for (int k = 0; k < 30; ++k)
        solved += solver.solve(robot.fk(random_configuration(robot, random))).success;
      EXPECT_GE(solved, 29) << size << (inner == InnerMethod::Lbfgs ? " by L-BFGS" : "");
    }
  }
}

TEST(SolverBehaviour, lengths_by_the_robots_size_are_as_ever_for_usual_arms_and_as_told_if_told) {
  for (const std::string& name : arm_names()) {
    const Options sized = Options{}.sized_for(Robot::builtin(name));
    EXPECT_EQ(sized.rotation_weight, 0.3) << name;
    EXPECT_EQ(sized.point_distance, 0.5) << name;
  }
  for (const double reach : {0.19, 0.21, 2.9, 3.1}) {
    DhRow turn{.lower = -1.0, .upper = 1.0};
    Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
    tool.translation().x() = reach;
    const Robot robot = Robot::from_dh({turn}, tool);
    const double expected = reach > 0.2 && reach < 3.0 ? 0.3 : 0.25 * reach;
    EXPECT_NEAR(Options{}.sized_for(robot).rotation_weight, expected, 1e-12) << reach;
    Options told;
    told.rotation_weight = 0.7;
    told.point_distance = 0.1;
    EXPECT_EQ(told.sized_for(robot).rotation_weight, 0.7);
    EXPECT_EQ(told.sized_for(robot).point_distance, 0.1);
  }
  // How far a rail or a floating base goes makes an arm no larger, a stage that slides no smaller.
  for (const double rail : {0.1, 50.0, std::numeric_limits<double>::infinity()}) {
    DhRow slide{.lower = -rail, .upper = rail, .prismatic = true}, turn{};
    Eigen::Isometry3d tool = Eigen::Isometry3d::Identity();
    tool.translation().x() = 0.15;
    EXPECT_EQ(Options{}.sized_for(Robot::from_dh({slide, turn}, tool)).rotation_weight, 0.3);
  }
}

TEST(SolverBehaviour, a_base_collision_names_what_the_base_is_in_however_deep_another_hull_is) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  for_settings([&](Options options) {
    options.max_restarts = 3;
    Solver solver(robot, options);
    const Eigen::VectorXd q = robot.mid_configuration();
    ObstacleMatrix obstacles(2, 3);
    obstacles.row(0) = robot.fk(q).translation().transpose();  // in the hand
    obstacles.row(1) << 0.0, 0.0, -0.0698;  // just in the ball around the base's origin
    solver.set_obstacles(obstacles);
    const Result result = solver.solve(robot.fk(q), q);
    ASSERT_EQ(result.status, Status::BaseCollision);
    EXPECT_EQ(result.worst.kind, WorstConstraint::Kind::Clearance);
    EXPECT_EQ(result.worst.obstacle, 1) << solver.describe(result.worst);
    EXPECT_GT(result.worst.violation, 0.0);
    EXPECT_LT(result.worst.violation, 1e-3);
  });
}

TEST(SolverBehaviour, answers_are_no_whole_turn_farther_than_they_must_be) {
  const Robot robot = Robot::builtin("ur10");  // limits of two turns
  Solver solver(robot, timeless());
  Random random(5);
  int solved = 0;
  for (int k = 0; k < 100; ++k) {
    const Eigen::VectorXd q0 = random_configuration(robot, random);
    const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
    const Result near = solver.solve(target, q0), any = solver.solve(target);
    if (!near.success || !any.success) continue;
    ++solved;
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      for (const double turn : {-2.0 * M_PI, 2.0 * M_PI}) {
        const double other = near.q[i] + turn;
        if (other < robot.lower()[i] || other > robot.upper()[i]) continue;
        EXPECT_LE(std::abs(near.q[i] - q0[i]), std::abs(other - q0[i]) + 1e-9);
      }
      EXPECT_LE(std::abs(any.q[i]), M_PI + 1e-9);
    }
  }
  EXPECT_GT(solved, 60);
}

TEST(SolverBehaviour, a_step_is_kept_though_the_posture_is_a_whole_turn_away) {
  const Robot robot = Robot::builtin("ur10");  // limits of two turns
  Options options = timeless();
  options.max_restarts = 5;
  Solver solver(robot, options);
  Random random(12);
  const Eigen::VectorXd step = Eigen::VectorXd::Constant(robot.dof(), 0.05);
  for (int k = 0; k < 40; ++k) {
    Eigen::VectorXd q0 = random_configuration(robot, random), aim = q0, posture = q0;
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      aim[i] += random.uniform(-0.1, 0.1);  // with and without an answer
      posture[i] += q0[i] < 0.0 ? 2.0 * M_PI : -2.0 * M_PI;
    }
    const Goal goal = solver.goal(robot.fk(aim));
    Result result;
    solver.solve({.goals = {&goal, 1}, .q0 = &q0, .posture = &posture, .max_step = &step}, result);
    EXPECT_LE((result.q - q0).cwiseAbs().maxCoeff(), 0.05 + 1e-12) << k;
  }
}

TEST(SolverBehaviour, an_arm_that_no_goal_concerns_stays_where_it_can) {
  const Robot robot = Robot::builtin("h1", "", {"left_elbow_link", "right_elbow_link"});
  const int left =
      robot.link_names()[static_cast<std::size_t>(robot.tips()[0])] == "left_elbow_link" ? 0 : 1;
  Options options = timeless(GoalType::Position);
  options.self_collision = false;
  Solver solver(robot, options);
  Random random(6);
  int solved = 0;
  const std::vector<std::string>& names = robot.joint_names();
  for (int k = 0; k < 60; ++k) {
    const Eigen::VectorXd q0 = random_configuration(robot, random, 0.1);
    Goal goal;
    goal.type = GoalType::Position;
    goal.tip = left;
    goal.T_base_tip = robot.fk(random_configuration(robot, random, 0.1), "left_elbow_link");
    Result result;
    solver.solve({.goals = {&goal, 1}, .q0 = &q0}, result);
    if (!result.success) continue;
    ++solved;
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      const std::string& name = names[static_cast<std::size_t>(i)];
      if (!name.starts_with("right_")) continue;
      EXPECT_EQ(result.q[i], q0[i]) << name;
    }
  }
  EXPECT_GT(solved, 40);
}

}  // namespace
}  // namespace pdoik
