#include <gtest/gtest.h>

#include <cmath>

#include "arms.hpp"
#include "pdoik/path.hpp"
#include "room.hpp"

/// Moves between configurations: what is called clear is looked at all along.
namespace pdoik {
namespace {

using namespace pdoik::testing;

/// The least room along a move [m].
double least_room(Solver& solver, const MotionResult& motion) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index row = 1; row < motion.q.rows(); ++row) {
    const Eigen::VectorXd from = motion.q.row(row - 1), to = motion.q.row(row);
    const int looks = 1 + static_cast<int>((to - from).norm() / 0.01);
    for (int k = 0; k <= looks; ++k)
      least = std::min(least, room(solver, from + (to - from) * k / looks));
  }
  return least;
}

std::vector<Shape> random_boxes(Random& random, int count) {
  std::vector<Shape> boxes;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d size = random.point(0.2).cwiseAbs() + Eigen::Vector3d::Constant(0.03);
    Eigen::Isometry3d T = random.pose(0.9);
    if (T.translation().head<2>().norm() < 0.3) T.translation().x() += 0.5;
    boxes.push_back(Shape::box("box" + std::to_string(k), T, size));
  }
  return boxes;
}

TEST(Motions, what_is_called_clear_is_clear_all_along_among_boxes_and_points) {
  int solved = 0, straight = 0;
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    Solver solver(robot);
    Random random(5);
    for (int trial = 0; trial < 25; ++trial) {
      SCOPED_TRACE(name + " " + std::to_string(trial));
      solver.set_shapes(Shapes(random_boxes(random, 6)));
      solver.set_obstacles(random_obstacles(random, 30, 0.9, 0.02));
      const Eigen::VectorXd from = random_configuration(robot, random, 0.1),
                            to = random_configuration(robot, random, 0.1);
      const bool possible = room(solver, from) > 0.0 && room(solver, to) > 0.0;
      const MotionResult motion =
          solver.plan_motion({.from = &from, .to = &to}, {.max_time = kSanitized ? 4.0 : 0.5});
      if (!possible) {
        EXPECT_TRUE(motion.status == MotionStatus::BlockedStart ||
                    motion.status == MotionStatus::BlockedGoal);
        continue;
      }
      if (motion.status != MotionStatus::Solved) continue;
      ++solved;
      straight += motion.q.rows() == 2 ? 1 : 0;
      EXPECT_EQ((motion.q.row(0).transpose() - from).norm(), 0.0);
      EXPECT_EQ((motion.q.row(motion.q.rows() - 1).transpose() - to).norm(), 0.0);
      EXPECT_GT(least_room(solver, motion), -1e-4);
    }
  }
  EXPECT_GE(solved, 10);
  EXPECT_LT(straight, solved);
}

TEST(Motions, what_is_carried_is_kept_off_too) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  Eigen::VectorXd from(7), to(7);
  from << -0.8, 0.3, 0.0, -2.0, 0.0, 2.3, 0.785;
  to << 0.8, 0.3, 0.0, -2.0, 0.0, 2.3, 0.785;
  const Eigen::Isometry3d middle = robot.fk(0.5 * (from + to), robot.tips()[0]);
  Eigen::Isometry3d wall = Eigen::Isometry3d::Identity();
  wall.translation() = middle.translation() - Eigen::Vector3d(0.0, 0.0, 0.33);
  solver.set_shapes(Shapes({Shape::box("wall", wall, Eigen::Vector3d(0.5, 0.04, 0.4))}));
  const MotionResult free = solver.plan_motion({.from = &from, .to = &to});
  ASSERT_EQ(free.status, MotionStatus::Solved);
  EXPECT_EQ(free.q.rows(), 2);  // the hand passes above it
  Eigen::Isometry3d held = Eigen::Isometry3d::Identity();
  held.translation().z() = 0.2;
  solver.attach("panda_link8",
                std::vector{Shape::box("stick", held, Eigen::Vector3d(0.03, 0.03, 0.25))});
  const MotionResult carrying = solver.plan_motion({.from = &from, .to = &to});
  ASSERT_EQ(carrying.status, MotionStatus::Solved);
  EXPECT_GT(carrying.q.rows(), 2);
  EXPECT_GT(least_room(solver, carrying), -1e-4);
}

TEST(Motions, end_at_whichever_goal_can_be_had) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Eigen::VectorXd from = bent_arm(robot);
  Eigen::Isometry3d far = robot.fk(from, robot.tips()[0]), near = far;
  far.translation() *= 4.0;
  near.translation().z() += 0.1;
  const std::vector<std::vector<Goal>> goals{{solver.goal(far)}, {solver.goal(near)}};
  const MotionResult motion = solver.plan_motion({.from = &from, .any_of = goals});
  ASSERT_EQ(motion.status, MotionStatus::Solved);
  EXPECT_EQ(motion.goal_index, 1);
  Result verdict;
  solver.judge(goals[1], motion.q.row(motion.q.rows() - 1), verdict);
  EXPECT_TRUE(verdict.success);
}

TEST(Motions, what_blocks_the_start_or_the_goals_is_named) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Eigen::VectorXd from = bent_arm(robot);
  Eigen::VectorXd to = from;
  to[0] += 0.8;
  Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  at.translation() = robot.fk(from, robot.tips()[0]).translation();
  solver.set_shapes(Shapes({Shape::sphere("ball", at.translation(), 0.05)}));
  const MotionResult out = solver.plan_motion({.from = &from, .to = &to});
  EXPECT_EQ(out.status, MotionStatus::BlockedStart);
  EXPECT_NE(solver.describe(out.at_fault.worst).find("ball"), std::string::npos);
  const MotionResult in = solver.plan_motion({.from = &to, .to = &from});
  EXPECT_EQ(in.status, MotionStatus::BlockedGoal);
  EXPECT_NE(solver.describe(in.at_fault.worst).find("ball"), std::string::npos);
}

TEST(Motions, misuse_is_named) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Eigen::VectorXd q = bent_arm(robot), wrong = Eigen::VectorXd::Zero(3);
  EXPECT_THROW(solver.plan_motion({.to = &q}), std::invalid_argument);
  EXPECT_THROW(solver.plan_motion({.from = &q}), std::invalid_argument);
  EXPECT_THROW(solver.plan_motion({.from = &q, .to = &wrong}), std::invalid_argument);
  EXPECT_THROW(solver.plan_motion({.from = &q, .to = &q}, {.max_time = -1.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace pdoik
