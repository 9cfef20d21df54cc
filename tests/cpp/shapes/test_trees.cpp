#include <gtest/gtest.h>

#include "arms.hpp"
#include "pdoik/collision_pairs.hpp"
#include "pdoik/solver.hpp"
#include "tree_bench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

/// Errors of a goal by Robot::fk alone.
void expect_met(const Robot& robot, const Goal& goal, const Eigen::VectorXd& q, double tolerance) {
  const Eigen::Isometry3d T = robot.fk(q, robot.tips()[static_cast<std::size_t>(goal.tip)]);
  const Eigen::Matrix3d R = goal.T_base_tip.linear();
  const Eigen::Vector3d off = R.transpose() * (T.translation() - goal.T_base_tip.translation());
  EXPECT_TRUE((off.cwiseAbs().array() <= goal.position_slack.array() + tolerance).all())
      << off.transpose();
  if (goal.type == GoalType::Position) return;
  if (goal.type == GoalType::Axis) {
    const double cosine = (T.linear() * goal.axis.normalized()).dot(R * goal.axis.normalized());
    EXPECT_LE(std::acos(std::clamp(cosine, -1.0, 1.0)),
              goal.rotation_slack.maxCoeff() + tolerance + 1e-7);
    return;
  }
  const Eigen::AngleAxisd turn(R.transpose() * T.linear());
  const Eigen::Vector3d e = turn.angle() * turn.axis();
  EXPECT_TRUE((e.cwiseAbs().array() <= goal.rotation_slack.array() + tolerance).all())
      << e.transpose();
}

TEST(Trees, several_goals_are_met_at_once_as_forward_kinematics_confirms) {
  int solved = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const RobotKind kind{.joints = 14, .branches = true, .prismatic = 0.1, .mimic = 0.1};
    const Robot robot = random_tree(random, 2 + seed % 2, kind);
    const std::vector<Goal> goals = random_goals(robot, random, seed % 2 == 0);
    Solver solver(robot, {.max_time = 0.5});
    Result result;
    solver.solve({.goals = goals}, result);
    EXPECT_TRUE((result.q.array() >= robot.lower().array()).all());
    EXPECT_TRUE((result.q.array() <= robot.upper().array()).all());
    if (!result.success) continue;
    ++solved;
    for (const Goal& goal : goals) expect_met(robot, goal, result.q, 1.5e-5);
  }
  EXPECT_GE(solved, 57);
}

TEST(Trees, a_goal_in_another_tip_s_frame_is_met_wherever_that_tip_is) {
  for (const InnerMethod inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    int solved = 0;
    for (int seed = 1; seed <= 40; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(static_cast<std::uint64_t>(seed));
      const RobotKind kind{.joints = 14, .branches = true, .prismatic = 0.1, .mimic = 0.1};
      const Robot robot = random_tree(random, 2, kind);
      const bool slack = seed % 2 == 0 && inner == InnerMethod::LevenbergMarquardt;
      std::vector<Goal> goals = one_after_the_other(random_goals(robot, random, slack));
      if (seed % 3 == 0) goals.erase(goals.begin());  // the other tip may be anywhere
      Solver solver(robot, {.max_time = 0.5, .inner = inner});
      Result result;
      solver.solve({.goals = goals}, result);
      if (!result.success) continue;
      ++solved;
      for (Goal goal : goals) {
        if (goal.relative_to >= 0) {
          const int reference = robot.tips()[static_cast<std::size_t>(goal.relative_to)];
          goal.T_base_tip = robot.fk(result.q, reference) * goal.T_base_tip;
        }
        expect_met(robot, goal, result.q, 1.5e-5);
      }
    }
    EXPECT_GE(solved, 36);
  }
}

TEST(Trees, goals_of_both_kinds_in_one_batch_have_the_answers_that_each_has_alone) {
  Random random(8);
  const RobotKind kind{.joints = 12, .branches = true};
  const Robot robot = random_tree(random, 2, kind);
  std::vector<std::vector<Goal>> asked;
  for (int k = 0; k < 20; ++k) {
    const std::vector<Goal> goals = random_goals(robot, random, false);
    asked.push_back(k % 3 == 0 ? one_after_the_other(goals) : goals);
  }
  Solver solver(robot, {.max_time = 10.0, .max_restarts = 30});
  const std::vector<Result> together = solver.solve_goals_batch(asked, {}, 2);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    Result alone;
    solver.solve({.goals = asked[k]}, alone);
    EXPECT_EQ(alone.q, together[k].q) << k;
    EXPECT_EQ(alone.success, together[k].success) << k;
  }
}

TEST(Trees, a_tip_without_a_goal_is_free) {
  Random random(3);
  const Robot robot = random_tree(random, 3);
  const std::vector<Goal> goals = random_goals(robot, random, false);
  Solver solver(robot, {.max_time = 0.5});
  for (const Goal& goal : goals) {
    Result result;
    solver.solve({.goals = {&goal, 1}}, result);
    ASSERT_TRUE(result.success);
    expect_met(robot, goal, result.q, 1.5e-5);
  }
}

TEST(Trees, solutions_are_balanced_and_off_themselves_as_plain_sums_and_samples_confirm) {
  int solved = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const RobotKind kind{.joints = 12, .branches = true, .prismatic = 0.1};
    Robot robot = random_tree(random, 1, kind);
    const Eigen::VectorXd q = random_configuration(robot, random);
    robot.set_ignored_pairs(pairs_touching_at(robot, q));  // so that there is a solution
    Options options;
    options.max_time = 0.5;
    const Eigen::Vector3d com = robot.center_of_mass(q);
    options.balance.com_lower = com - Eigen::Vector3d::Constant(0.02);
    options.balance.com_upper = com + Eigen::Vector3d::Constant(0.02);
    options.self_collision = true;
    Goal goal;
    goal.type = GoalType::Position;
    goal.T_base_tip = robot.fk(q);
    Solver solver(robot, options);
    Result result;
    solver.solve({.goals = {&goal, 1}}, result);
    if (!result.success) continue;
    ++solved;
    const Eigen::Vector3d reached = robot.center_of_mass(result.q);
    EXPECT_LT((reached - com).cwiseAbs().maxCoeff(), 0.02 + 2e-6);
    EXPECT_LT((reached - result.center_of_mass).norm(), 1e-12);
    EXPECT_GE(result.self_distance, -1e-6);
    EXPECT_LE(result.balance_violation, 1e-6);
  }
  EXPECT_GE(solved, 36);
}

TEST(Trees, the_posture_is_approached_without_giving_up_goals) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const RobotKind kind{.joints = 12, .branches = true};
    const Robot robot = random_tree(random, 1, kind);
    Goal goal;
    goal.type = GoalType::Position;
    const Eigen::VectorXd posture = random_configuration(robot, random, 0.2);
    goal.T_base_tip = robot.fk(random_configuration(robot, random));
    Solver solver(robot, {.max_time = 0.5});
    Result without, with;
    solver.solve({.goals = {&goal, 1}}, without);
    solver.solve({.goals = {&goal, 1}, .posture = &posture}, with);
    ASSERT_TRUE(with.success);
    expect_met(robot, goal, with.q, 1.5e-5);
    EXPECT_LE((with.q - posture).norm(), (without.q - posture).norm() + 1e-9);

    // Stationary: what is left of the pull has no part along motions that keep the tip in place,
    // but for joints that their limits stop.
    const Eigen::MatrixXd J = robot.jacobian(with.q).topRows<3>();
    Eigen::VectorXd pull = posture - with.q;
    Eigen::MatrixXd K = J;
    for (Eigen::Index i = 0; i < pull.size(); ++i) {
      const bool held =
          with.q[i] <= robot.lower()[i] + 1e-9 || with.q[i] >= robot.upper()[i] - 1e-9;
      if (!held) continue;
      pull[i] = 0.0;
      K.col(i).setZero();
    }
    const Eigen::VectorXd along =
        pull - K.completeOrthogonalDecomposition().pseudoInverse() * (K * pull);
    EXPECT_LT(along.norm(), 0.05 * (1.0 + (posture - with.q).norm()));
  }
}

TEST(Trees, the_nearest_of_many_is_no_farther_than_the_first) {
  double first_sum = 0.0, nearest_sum = 0.0;
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    for (int seed = 1; seed <= 10; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Eigen::VectorXd q0 = random_configuration(robot, random);
      const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
      Result first, nearest;
      Solver(robot, {.self_collision = false, .max_time = 1.0}).solve(target, &q0, first);
      Options options;
      options.self_collision = false;
      options.prefer = Prefer::Nearest;
      options.max_time = 1.0;
      options.max_restarts = 100;
      Solver(robot, options).solve(target, &q0, nearest);
      ASSERT_TRUE(nearest.success);
      EXPECT_LE((nearest.q - q0).norm(), (first.q - q0).norm() + 1e-6);
      first_sum += (first.q - q0).norm();
      nearest_sum += (nearest.q - q0).norm();
    }
  }
  EXPECT_LT(nearest_sum, 0.9 * first_sum);
}

TEST(Trees, steps_are_never_longer_than_asked_for) {
  const Robot robot = Robot::builtin("panda");
  Random random(7);
  for (int k = 0; k < 30; ++k) {
    const Eigen::VectorXd q0 = random_configuration(robot, random),
                          step = random.vector(7, 0.0, 0.1);
    Solver solver(robot, {.self_collision = false, .max_time = 0.02, .max_restarts = 20});
    const Goal goal = solver.goal(robot.fk(random_configuration(robot, random)));
    Result result;
    solver.solve({.goals = {&goal, 1}, .q0 = &q0, .max_step = &step}, result);
    EXPECT_TRUE(((result.q - q0).array().abs() <= step.array() + 1e-15).all());
    const Goal near = solver.goal(robot.fk((q0 + 0.5 * step).cwiseMin(robot.upper())));
    solver.solve({.goals = {&near, 1}, .q0 = &q0, .max_step = &step}, result);
    EXPECT_TRUE(result.success);
  }
}

TEST(Trees, a_box_that_no_posture_meets_is_named) {
  Random random(5);
  const Robot robot = random_tree(random, 1);
  Options options;
  options.max_time = 0.05;
  options.balance.com_lower = Eigen::Vector3d(50.0, -1.0, -1.0);
  options.balance.com_upper = Eigen::Vector3d(51.0, 1.0, 1.0);
  Solver solver(robot, options);
  const Goal goal = solver.goal(robot.fk(robot.mid_configuration()));
  Result result;
  solver.solve({.goals = {&goal, 1}}, result);
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.worst.kind, WorstConstraint::Kind::Balance);
  EXPECT_EQ(solver.describe(result.worst), "lower x of the centre of mass");
}

}  // namespace
}  // namespace pdoik
