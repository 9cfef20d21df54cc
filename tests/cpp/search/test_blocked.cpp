#include <gtest/gtest.h>

#include "arms.hpp"

/// Targets at which the tool itself is in an obstacle: told after a start, not after the budget.
namespace pdoik {
namespace {

using namespace pdoik::testing;

/// The same robot, with those hulls alone that stay where they are to the tip, by trying.
Robot tool_of(const Robot& robot) {
  Random random(99);
  std::vector<Eigen::VectorXd> tries;
  for (int k = 0; k < 4; ++k) tries.push_back(random_configuration(robot, random));
  const auto stays = [&](const std::string& link, const Eigen::Vector3d& p) {
    const auto in_tip = [&](const Eigen::VectorXd& q) -> Eigen::Vector3d {
      return robot.fk(q).inverse() * (robot.fk(q, link) * p);
    };
    return std::all_of(tries.begin(), tries.end(), [&](const Eigen::VectorXd& q) {
      return (in_tip(q) - in_tip(tries.front())).norm() < 1e-9;
    });
  };
  Occupancy occupancy = robot.occupancy();
  std::erase_if(occupancy.spheres, [&](const Sphere& s) { return !stays(s.link, s.center); });
  std::erase_if(occupancy.spheroids, [&](const Spheroid& s) {
    return !stays(s.link_a, s.focus_a) || !stays(s.link_b, s.focus_b);
  });
  std::erase_if(occupancy.capsules,
                [&](const Capsule& c) { return !stays(c.link, c.a) || !stays(c.link, c.b); });
  Robot tool = robot;
  tool.set_occupancy(occupancy);
  return tool;
}

Robot arm(int seed) {
  Robot robot = with_hulls(Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)]));
  if (seed % 2 == 0) return robot;
  Occupancy occupancy = robot.occupancy();
  occupancy.capsules.push_back(
      {robot.link_names().back(), {-0.04, 0.0, 0.03}, {0.04, 0.0, 0.03}, 0.03});
  robot.set_occupancy(occupancy);
  return robot;
}

TEST(Blocked, is_said_at_once_and_exactly_where_the_tool_touches_at_the_target) {
  int blocked = 0, free = 0;
  for (int seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = arm(seed), tool = tool_of(robot);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.05);
    const Eigen::Isometry3d target = robot.fk(q);
    ObstacleMatrix points(1, 3);
    points.row(0) = (robot.fk(q, robot.link_names().back()) * random.point(0.1)).transpose();
    const double clearance = brute_force_clearance(tool, q, points);
    Options options = timeless();
    options.max_restarts = 60;
    Solver solver(robot, options);
    solver.set_obstacles(points);
    const Result result = solver.solve(target);
    if (clearance < -1e-3) {
      ++blocked;
      EXPECT_EQ(result.status, Status::Blocked);
      EXPECT_FALSE(result.success);
      EXPECT_LE(result.restarts, 8);
      EXPECT_EQ(result.worst.kind, WorstConstraint::Kind::Clearance);
      EXPECT_NEAR(result.worst.violation, -clearance, 1e-5);
      EXPECT_NE(solver.describe(result.worst).find("to obstacle 0"), std::string::npos);
      EXPECT_LT(position_error(robot, result.q, target), 1e-3);  // the best for the goal
    } else if (clearance > 0.0) {
      ++free;
      EXPECT_NE(result.status, Status::Blocked);
    }
  }
  EXPECT_GT(blocked, 20);
  EXPECT_GT(free, 20);
}

TEST(Blocked, by_a_shape_is_told_by_its_name_in_solves_and_batches) {
  for (int seed = 1; seed <= 12; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = arm(seed);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.05);
    const Eigen::Isometry3d target = robot.fk(q), T = robot.fk(q, robot.link_names().back());
    Solver solver(robot, timeless());
    solver.set_shapes(Shapes(
        {Shape::box("crate", T, {0.02, 0.02, 0.02}), Shape::sphere("far", {5.0, 0.0, 0.0}, 0.1)}));
    const Result result = solver.solve(target);
    EXPECT_EQ(result.status, Status::Blocked);
    EXPECT_NE(solver.describe(result.worst).find("to crate"), std::string::npos);
    const std::vector<Eigen::Isometry3d> targets(9, target);
    for (const Result& each : solver.solve_batch(targets)) {
      EXPECT_EQ(each.status, Status::Blocked);
      EXPECT_EQ(each.q, result.q);
    }
  }
}

TEST(Blocked, is_not_said_where_the_goal_leaves_the_tool_room) {
  const Robot robot = arm(2);
  Random random(5);
  const Eigen::VectorXd q = random_configuration(robot, random, 0.1);
  const Eigen::Isometry3d target = robot.fk(q), T = robot.fk(q, robot.link_names().back());
  ObstacleMatrix points(1, 3);
  points.row(0) = (T * Eigen::Vector3d(0.0, 0.0, 0.069)).transpose();  // a millimetre deep
  for (const GoalType type : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
    Options options = timeless(type);
    options.max_restarts = 40;
    Solver solver(robot, options);
    solver.set_obstacles(points);
    EXPECT_EQ(solver.solve(target).status == Status::Blocked, type == GoalType::Pose);
  }
  Options options = timeless();
  options.max_restarts = 40;
  Solver solver(robot, options);
  solver.set_obstacles(points);
  Goal goal = solver.goal(target);
  goal.position_slack = Eigen::Vector3d::Constant(0.01);
  Result result;
  solver.solve({.goals = {&goal, 1}}, result);
  EXPECT_EQ(result.status, Status::Solved);
}

}  // namespace
}  // namespace pdoik
