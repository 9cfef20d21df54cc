#include <gtest/gtest.h>

#include "arms.hpp"
#include "pdoik/cloud.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;
using Kind = WorstConstraint::Kind;

Result judged(Solver& solver, const Eigen::Isometry3d& target, const Eigen::VectorXd& q) {
  Result result;
  solver.judge(target, q, result);
  return result;
}

TEST(Judge, says_of_any_configuration_what_fk_and_brute_force_say) {
  for (int seed = 1; seed <= 40; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    Robot robot = random_robot(random, seed % 2 == 0 ? kMixedTree : kSerial);
    robot.set_occupancy(random_occupancy(robot, random, 3, 4));
    Options options = timeless(static_cast<GoalType>(seed % 3));
    Solver solver(robot, options);
    const ObstacleMatrix obstacles = random_obstacles(random, 12, 1.5, seed % 3 == 0 ? 0.1 : 0.0);
    solver.set_obstacles(obstacles);
    for (const double beyond : {0.0, 0.7}) {  // inside the limits, and also outside of them
      SCOPED_TRACE("seed " + std::to_string(seed) + ", beyond limits by " + std::to_string(beyond));
      Eigen::VectorXd q = random_configuration(robot, random);
      if (beyond > 0.0) q = robot.upper().cwiseMin(1e3).array() + beyond;
      const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
      const Result result = judged(solver, target, q);
      EXPECT_EQ(result.q, q);
      EXPECT_NEAR(result.position_error, position_error(robot, q, target), 1e-9);
      EXPECT_NEAR(result.rotation_error, rotation_error(robot, q, target, options), 1e-7);
      const double outside =
          std::max(0.0, std::max((robot.lower() - q).maxCoeff(), (q - robot.upper()).maxCoeff()));
      EXPECT_EQ(result.limit_violation, outside);
      EXPECT_NEAR(result.clearance, brute_force_clearance(robot, q, obstacles, 100), 1e-9);
      EXPECT_TRUE(outside == 0.0 || !result.success);
    }
  }
}

TEST(Judge, sees_obstacles_that_only_a_slide_beyond_its_limit_brings_near) {
  RobotDescription description;
  description.links = {{.name = "rail"}, {.name = "cart"}};
  description.joints = {joint_between("rail", "cart", "slide", JointType::Prismatic, 0.0, 0.2)};
  Robot robot(description);
  Occupancy occupancy;
  occupancy.spheres.push_back({"cart", Eigen::Vector3d::Zero(), 0.1});
  robot.set_occupancy(occupancy);
  Solver solver(robot, timeless(GoalType::Position));
  ObstacleMatrix obstacles(2, 3);
  obstacles << 0.0, 0.0, 0.35, 0.0, 0.0,
      5.0;  // in reach; out of reach unless the cart leaves the rail
  solver.set_obstacles(obstacles);
  for (const double q : {0.1, 4.0, 5.0}) {
    const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, q);
    EXPECT_NEAR(judged(solver, robot.fk(at), at).clearance,
                brute_force_clearance(robot, at, obstacles), 1e-12)
        << q;
  }
}

TEST(Judge, overlooks_nothing_out_of_reach_of_a_hull_whose_foci_are_too_far_apart) {
  RobotDescription description;
  description.links = {{.name = "base"}, {.name = "arm"}};
  description.joints = {joint_between("base", "arm", "turn", JointType::Revolute, -3.0, 3.0)};
  description.joints[0].T_parent_child.translation().x() = 1.0;
  Robot robot(description);
  Occupancy occupancy;
  occupancy.spheres.push_back({"arm", Eigen::Vector3d(0.1, 0.0, 0.0), 0.05});
  occupancy.spheroids.push_back(
      {"arm", Eigen::Vector3d(0.3, 0.0, 0.0), "base", Eigen::Vector3d::Zero(), 0.2});
  robot.set_occupancy(occupancy);
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    Options options = timeless(GoalType::Position);
    options.clearance = random.uniform(-0.3, 0.3);
    Solver solver(robot, options);
    // One out of the arm's reach, close to the base, and one that the arm may come close to.
    ObstacleMatrix obstacles = random_obstacles(random, 2, 0.3, trial % 2 == 0 ? 0.1 : 0.0);
    obstacles.row(1).head<3>() *= 2.0;
    obstacles(1, 0) += 1.0;
    solver.set_obstacles(obstacles);
    const Eigen::VectorXd q = random_configuration(robot, random);
    EXPECT_NEAR(judged(solver, robot.fk(q), q).clearance,
                brute_force_clearance(robot, q, obstacles), 1e-9)
        << trial;
  }
}

TEST(Judge, names_what_is_missed_by_most) {
  Robot robot = with_hulls(Robot::builtin("panda"));
  Solver solver(robot, timeless());
  const Eigen::VectorXd q = robot.mid_configuration();
  const Eigen::Isometry3d at_tip = robot.fk(q);
  EXPECT_TRUE(judged(solver, at_tip, q).success);
  EXPECT_LE(judged(solver, at_tip, q).worst.violation, 0.0);

  Eigen::Isometry3d shifted = at_tip, turned = at_tip;
  shifted.translation().x() += 0.3;
  turned.linear() = at_tip.linear() * Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY());
  const Result far = judged(solver, shifted, q), askew = judged(solver, turned, q);
  EXPECT_EQ(far.worst.kind, Kind::Position);
  EXPECT_NEAR(far.worst.violation, 0.3 - solver.options().position_tolerance, 1e-12);
  EXPECT_EQ(askew.worst.kind, Kind::Rotation);
  EXPECT_NEAR(askew.worst.violation, 0.4 - solver.options().rotation_tolerance, 1e-12);

  Eigen::VectorXd bent = q;
  bent[3] = robot.upper()[3] + 0.5;
  const Result beyond = judged(solver, robot.fk(bent), bent);
  EXPECT_EQ(beyond.worst.kind, Kind::Limit);
  EXPECT_EQ(beyond.worst.index, 3);
  EXPECT_NEAR(beyond.worst.violation, 0.5, 1e-12);
  EXPECT_NE(solver.describe(beyond.worst).find(robot.joint_names()[3]), std::string::npos);

  ObstacleMatrix obstacles(2, 3);
  obstacles << 3.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  obstacles.row(1) = robot.fk(q, "panda_link4").translation().transpose();
  solver.set_obstacles(obstacles);
  const Result touching = judged(solver, at_tip, q);
  EXPECT_FALSE(touching.success);
  EXPECT_EQ(touching.worst.kind, Kind::Clearance);
  EXPECT_EQ(touching.worst.obstacle, 1);
  EXPECT_NEAR(touching.worst.violation, -touching.clearance - solver.options().clearance_tolerance,
              1e-12);
  const auto hull = static_cast<std::size_t>(touching.worst.index);
  ASSERT_LT(hull, robot.occupancy().size());
  EXPECT_NE(solver.describe(touching.worst).find("obstacle 1"), std::string::npos);
}

TEST(Judge, success_turns_exactly_at_each_tolerance) {
  const Robot robot = with_hulls(Robot::builtin("ur10"));
  Options options = timeless();
  options.position_tolerance = 1e-3, options.rotation_tolerance = 2e-3,
  options.clearance_tolerance = 1e-4;
  Solver solver(robot, options);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(6, 0.4);
  const Eigen::Isometry3d T = robot.fk(q);
  for (const double factor : {0.999, 1.001}) {
    Eigen::Isometry3d shifted = T, turned = T;
    shifted.translation().y() += factor * options.position_tolerance;
    turned.linear() = T.linear() * Eigen::AngleAxisd(factor * options.rotation_tolerance,
                                                     Eigen::Vector3d::UnitX());
    EXPECT_EQ(judged(solver, shifted, q).success, factor < 1.0);
    EXPECT_EQ(judged(solver, turned, q).success, factor < 1.0);
    ObstacleMatrix obstacle(1, 3);
    const double depth = factor * options.clearance_tolerance;
    obstacle << (robot.fk(q, "base_link").translation() - Eigen::Vector3d(0.0, 0.0, 0.07 - depth))
                    .transpose();
    solver.set_obstacles(obstacle);
    EXPECT_EQ(judged(solver, T, q).success, factor < 1.0);
    EXPECT_NEAR(judged(solver, T, q).clearance, -depth, 1e-12);
    solver.clear_obstacles();
  }
}

TEST(Judge, looks_again_at_what_stands_still_whenever_the_cloud_is_another) {
  Random random(7);
  for (int turn = 0; turn < 20; ++turn) {
    SCOPED_TRACE(turn);
    const Robot robot = Robot::builtin(arm_names()[static_cast<std::size_t>(turn % 3)]);
    Solver kept(robot, timeless());
    const Eigen::VectorXd q = random_configuration(robot, random);
    Cloud cloud(random_obstacles(random, 3000, 1.5, 0.0));
    for (int change = 0; change < 6; ++change) {
      kept.set_obstacles(cloud);
      Solver fresh(robot, timeless());
      fresh.set_obstacles(cloud);
      for (int look = 0; look < 2; ++look)
        EXPECT_EQ(judged(kept, robot.fk(q), q).clearance, judged(fresh, robot.fk(q), q).clearance);
      const double half = random.uniform(0.05, 0.8);
      cloud.remove({Eigen::Vector3d::Constant(-half), Eigen::Vector3d::Constant(half)});
      if (change % 2 == 0) kept.set_obstacles(random_obstacles(random, 40, 0.3, 0.0));
      judged(kept, robot.fk(q), q);
    }
  }
}

TEST(Judge, results_tell_clearance_up_to_where_that_is_asked_for) {
  int less = 0, as_much = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)]);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.02);
    Options asked = timeless(), all = timeless();
    asked.max_restarts = all.max_restarts = 20;
    asked.report_clearance = 0.06;
    asked.clearance = all.clearance = seed % 5 == 0 ? 0.1 : 0.0;  // which counts if it is more
    Solver some(robot, asked), every(robot, all);
    const ObstacleMatrix points = 0.6 * random_obstacles(random, 30, 1.2, 0.0);
    for (Solver* solver : {&some, &every}) {
      solver->set_obstacles(points);
      if (seed % 2 == 0) solver->set_shapes(Shapes({Shape::sphere("ball", {0.5, 0.1, 0.4}, 0.1)}));
    }
    const Result told = some.solve(robot.fk(q)), whole = every.solve(robot.fk(q));
    EXPECT_EQ(told.success, whole.success);
    EXPECT_EQ(told.q, whole.q);
    EXPECT_EQ(told.clearance, std::min(whole.clearance, std::max(0.06, asked.clearance)));
    (told.clearance < 0.06 ? less : as_much) += 1;
  }
  EXPECT_GT(less, 5);
  EXPECT_GT(as_much, 5);
}

TEST(Judge, every_status_and_kind_has_a_word_of_its_own) {
  std::vector<std::string> words;
  for (const Status status : {Status::Solved, Status::TimeLimit, Status::Exhausted,
                              Status::OutOfReach, Status::BaseCollision}) {
    words.emplace_back(to_string(status));
  }
  std::sort(words.begin(), words.end());
  EXPECT_EQ(std::adjacent_find(words.begin(), words.end()), words.end());
  for (const std::string& word : words) {
    EXPECT_EQ(word.find_first_not_of("abcdefghijklmnopqrstuvwxyz_"), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace pdoik
