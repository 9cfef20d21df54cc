// What the README promises, at sizes, speeds and inputs that are not the usual ones.
#include <gtest/gtest.h>

#include "arms.hpp"
#include "brute_force.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/floating_base.hpp"
#include "pdoik/lagrangian.hpp"
#include "pdoik/tracker.hpp"
#include "solver_settings.hpp"
#include "tree_bench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Six joints in a row, the second without a limit of angle or speed, hulls on every link.
Robot arm_with_a_free_joint(double velocity) {
  RobotDescription description;
  description.name = "free";
  description.links.push_back({.name = "l0"});
  for (int i = 1; i <= 6; ++i) {
    JointDescription joint =
        joint_between("l" + std::to_string(i - 1), "l" + std::to_string(i), "j" + std::to_string(i),
                      i == 2 ? JointType::Continuous : JointType::Revolute, -2.8, 2.8);
    joint.T_parent_child.translation().z() = 0.2;
    joint.axis = i % 2 == 1 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
    joint.velocity = i == 2 ? velocity : 2.0;
    description.links.push_back({.name = joint.child_link});
    description.joints.push_back(joint);
  }
  Robot robot(description, {}, {"l6"});
  Occupancy occupancy;
  for (int i = 2; i <= 6; ++i)
    occupancy.spheres.push_back(
        {"l" + std::to_string(i), Eigen::Vector3d(0.0, 0.0, 0.1), i == 2 ? 0.09 : 0.07});
  occupancy.spheroids.push_back(
      {"l3", Eigen::Vector3d::Zero(), "l4", Eigen::Vector3d::Zero(), 0.13});
  robot.set_occupancy(occupancy);
  return robot;
}

/// The least clearance along the straight way between two configurations, by brute force.
double clearance_between(const Robot& robot, const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                         const ObstacleMatrix& points) {
  double least = kInfinity;
  const int places = 1 + static_cast<int>(200.0 * (to - from).cwiseAbs().maxCoeff());
  for (int k = 0; k <= places; ++k) {
    const Eigen::VectorXd q = from + (to - from) * (static_cast<double>(k) / places);
    least = std::min(least, brute_force_clearance(robot, q, points, 60));
  }
  return least;
}

TEST(Promises, a_joint_without_a_speed_limit_or_with_a_huge_one_takes_no_hull_through_an_obstacle) {
  for (const double velocity : {kInfinity, 1e9, 1e3, 50.0}) {
    SCOPED_TRACE("velocity " + std::to_string(velocity));
    const Robot robot = arm_with_a_free_joint(velocity);
    int tracking = 0, held_back = 0;
    for (int seed = 1; seed <= 15; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(static_cast<std::uint64_t>(seed));
      Options options;
      options.goal = GoalType::Position;
      Tracker tracker(robot, options, {.period = 0.004, .max_time = 10.0});
      Eigen::VectorXd last = random_configuration(robot, random);
      const ObstacleMatrix points = random_obstacles(random, 4, 0.7, 0.02);
      if (brute_force_clearance(robot, last, points) < 0.01) continue;
      tracker.reset(last);
      ASSERT_TRUE(tracker.set_obstacles(points));
      Eigen::VectorXd goal = last + random.vector(6, -0.3, 0.3);
      goal[1] += random.uniform(-3.0, 3.0);
      const Eigen::Isometry3d target = robot.fk(goal);
      for (int k = 0; k < 60; ++k) {
        const TrackerResult& step = tracker.step(target);
        // Sampled every 2 mm, which leaves a millimetre in between.
        ASSERT_GT(clearance_between(robot, last, step.q, points), -1.1e-3) << k;
        if (step.tracking == TrackerStatus::Tracking) {
          ++tracking;
          ASSERT_GT(brute_force_clearance(robot, step.q, points), -1.1e-6) << k;
        } else {
          ++held_back;
        }
        last = step.q;
      }
    }
    EXPECT_GT(tracking, 100);
    EXPECT_GT(held_back, 10);
  }
}

TEST(Promises, a_thin_hull_does_not_hop_over_a_point_in_a_short_step) {
  for (const double radius : {0.012, 0.004, 0.001}) {
    SCOPED_TRACE("radius " + std::to_string(radius));
    RobotDescription description;
    description.name = "slide";
    description.links = {{.name = "rail"}, {.name = "probe"}};
    JointDescription joint =
        joint_between("rail", "probe", "slide", JointType::Prismatic, -1.0, 1.0);
    joint.axis = Eigen::Vector3d::UnitX();
    joint.velocity = kInfinity;
    description.joints = {joint};
    Robot robot(description);
    Occupancy occupancy;
    occupancy.spheres = {{"probe", Eigen::Vector3d::Zero(), radius}};
    robot.set_occupancy(occupancy);
    Options options;
    options.goal = GoalType::Position;
    Tracker tracker(robot, options, {.period = 0.004, .max_time = 10.0});
    const double way = std::min(0.019, 3.0 * radius);  // over the point, less than 2 cm
    tracker.reset(Eigen::VectorXd::Constant(1, -std::max(0.5 * way, 1.05 * radius)));
    ObstacleMatrix point = ObstacleMatrix::Zero(1, 3);
    point(0, 1) = 0.2 * radius;
    ASSERT_TRUE(tracker.set_obstacles(point));
    for (int k = 0; k < 20; ++k) {
      const TrackerResult& step = tracker.step(robot.fk(Eigen::VectorXd::Constant(1, 0.5 * way)));
      EXPECT_NE(step.tracking, TrackerStatus::Tracking) << k;
      EXPECT_LT(step.q[0], 0.0) << k;
    }
  }
}

TEST(Promises, a_floating_arm_steps_around_obstacles_without_a_limit_of_speed) {
  RobotDescription description = builtin_description("panda");
  FloatingBaseBounds bounds;
  bounds.lower << -1.0, -1.0, -1.0, -1.0, -1.0, -1.0;
  bounds.upper << 1.0, 1.0, 1.0, 1.0, 1.0, 1.0;
  const Occupancy occupancy = Robot::builtin("panda").occupancy();
  Robot robot(with_floating_base(description, "panda_link0", bounds), "world", {"panda_link8"});
  robot.set_occupancy(occupancy);
  int tracking = 0;
  for (int seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Tracker tracker(robot, {}, {.period = 0.004, .max_time = 10.0});
    Eigen::VectorXd last = robot.mid_configuration();
    tracker.reset(last);
    ObstacleMatrix points = random_obstacles(random, 30, 1.0);
    if (brute_force_clearance(robot, last, points) < 0.01) continue;
    ASSERT_TRUE(tracker.set_obstacles(points));
    const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
    for (int k = 0; k < 40; ++k) {
      const TrackerResult& step = tracker.step(target);
      ASSERT_GT(clearance_between(robot, last, step.q, points), -1.1e-3) << k;
      if (step.tracking == TrackerStatus::Tracking) {
        ++tracking;
        ASSERT_GT(brute_force_clearance(robot, step.q, points), -1.1e-6) << k;
      }
      last = step.q;
    }
  }
  EXPECT_GT(tracking, 10);
}

TEST(Promises, speed_limits_too_small_for_a_tolerance_still_lead_to_the_goal) {
  const Robot robot = Robot::builtin("panda");
  TrackerOptions slow{.period = 0.001, .max_time = 10.0};
  slow.max_speed = Eigen::VectorXd::Constant(7, 1e-4);  // 1e-7 rad a step
  Tracker tracker(robot, {}, slow);
  const Eigen::VectorXd start = robot.mid_configuration();
  tracker.reset(start);
  const Eigen::Isometry3d target = robot.fk(start.array() + 1e-4);
  bool arrived = false;
  for (int k = 0; k < 1500 && !arrived; ++k)
    arrived = tracker.step(target).tracking == TrackerStatus::Tracking;
  EXPECT_TRUE(arrived);
}

/// A cloud as dense as a depth camera's all around the arm, its own surface included.
ObstacleMatrix dense_cloud(int count) {
  Random random(17);
  return random_obstacles(random, count, 0.9);
}

TEST(Promises, once_the_deadline_has_struck_one_pass_over_what_is_near_is_all_that_is_done) {
  const Robot robot = Robot::builtin("panda");
  int struck = 0;
  for (const int count : {0, 500, 20000}) {
    const ObstacleMatrix points = dense_cloud(count);
    for (const auto& [method, inner] : {std::pair(Method::Default, InnerMethod::LevenbergMarquardt),
                                        std::pair(Method::Default, InnerMethod::Lbfgs),
                                        std::pair(Method::Paper, InnerMethod::Lbfgs)}) {
      for (const Prefer prefer : {Prefer::First, Prefer::Nearest}) {
        for (const double max_time : {1e-9, 2e-5, 2e-4, 1e-3}) {
          Options options;
          options.method = method;
          options.inner = inner;
          options.prefer = prefer;
          options.max_time = max_time;
          if (method == Method::Paper && prefer == Prefer::Nearest) continue;
          Solver solver(robot, options);
          solver.set_obstacles(points);
          Random random(2);
          for (int k = 0; k < 10; ++k) {
            Result result;
            const Eigen::VectorXd q0 = random_configuration(robot, random);
            solver.solve(robot.fk(random_configuration(robot, random)), &q0, result);
            EXPECT_LE(result.late_evaluations, 1)
                << count << " points, " << max_time << " s, " << to_string(result.status);
            struck += result.status == Status::TimeLimit;
            EXPECT_TRUE(result.q.allFinite());
          }
        }
      }
    }
  }
  EXPECT_GT(struck, 50);
}

TEST(Promises, a_step_among_many_points_does_one_pass_after_the_deadline_at_most) {
  const Robot robot = Robot::builtin("panda");
  Options options;
  options.max_obstacles = 20000;
  int struck = 0;
  for (const double max_time : {1e-9, 1e-5, 5e-5}) {
    Tracker tracker(robot, options,
                    {.period = 0.004, .max_time = max_time, .posture_weight = 0.01});
    tracker.reset(robot.mid_configuration());
    tracker.set_posture(robot.mid_configuration());
    ASSERT_TRUE(tracker.set_obstacles(dense_cloud(20000)));
    Random random(4);
    for (int k = 0; k < 50; ++k) {
      const TrackerResult& step = tracker.step(robot.fk(random_configuration(robot, random)));
      EXPECT_LE(step.late_evaluations, 1);
      EXPECT_GT(step.intake, 0.0);
      struck += step.tracking == TrackerStatus::DeadlineStruck;
    }
  }
  EXPECT_GT(struck, 20);
}

TEST(Promises, an_obstacle_in_a_hull_that_no_joint_moves_is_said_at_once) {
  const Robot robot = Robot::builtin("panda");
  Options options;
  options.max_time = kInfinity;
  options.max_restarts = 1000000;  // a search for an answer would not end
  for (const InnerMethod inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    options.inner = inner;
    Solver solver(robot, options);
    ObstacleMatrix points(2, 3);
    points << 0.0, 0.0, 0.05, 0.3, 0.3, 0.3;
    solver.set_obstacles(points);
    Random random(6);
    int reached = 0;
    for (int k = 0; k < 50; ++k) {
      const Result result = solver.solve(robot.fk(random_configuration(robot, random)));
      EXPECT_EQ(result.status, Status::BaseCollision);
      EXPECT_LE(result.restarts, 100);
      reached += result.position_error < 1e-5 && result.rotation_error < 1e-5;
    }
    EXPECT_GE(reached, 48);  // q is the best for the goal alone
  }
}

TEST(Promises, a_goal_for_a_tip_that_no_joint_moves_is_out_of_reach_at_once_or_solved) {
  const Robot robot = Robot::builtin("panda", {}, {"panda_link8", "panda_link0"});
  Options options;
  options.max_time = kInfinity;
  options.max_restarts = 1000000;
  Solver solver(robot, options);
  Goal goal;
  goal.tip = 1;
  Result result;
  solver.solve({.goals = {&goal, 1}}, result);
  EXPECT_EQ(result.status, Status::Solved);
  goal.T_base_tip.translation().x() = 0.01;
  solver.solve({.goals = {&goal, 1}}, result);
  EXPECT_EQ(result.status, Status::OutOfReach);
  EXPECT_LE(result.restarts, 16);
  goal.T_base_tip.setIdentity();
  goal.T_base_tip.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()).toRotationMatrix();
  solver.solve({.goals = {&goal, 1}}, result);
  EXPECT_EQ(result.status, Status::OutOfReach);
}

TEST(Promises, a_search_that_no_joint_can_help_ends_by_its_deadline) {
  // Nothing that moves reaches the goal's tip, and the other tip has no goal.
  const Robot robot = Robot::builtin("panda", {}, {"panda_link8", "panda_link0"});
  Options options;
  options.max_time = 1e-3;
  options.max_restarts = std::numeric_limits<int>::max() - 1;
  options.balance.com_lower.x() = 5.0;  // never
  Solver solver(robot, options);
  Goal goal;
  goal.tip = 1;
  Result result;
  solver.solve({.goals = {&goal, 1}}, result);
  EXPECT_FALSE(result.success);
  EXPECT_LE(result.late_evaluations, 1);
}

/// What a failed answer falls short by, in the search's own measure, from what the judge says.
double shortfall(const Result& result, const Options& options) {
  constexpr double kRotationWeight = 0.3;  // of arms of usual sizes
  const double p = result.position_error, r = kRotationWeight * result.rotation_error,
               c = options.collision_weight * std::max(0.0, -result.clearance);
  return 0.5 * (p * p + r * r + c * c);
}

TEST(Promises, the_answer_of_a_failed_solve_by_lbfgs_gets_better_with_more_starts) {
  const Robot robot = Robot::builtin("ur10");
  int better = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Eigen::VectorXd q = random_configuration(robot, random);
    const Eigen::Isometry3d target = robot.fk(q);
    ObstacleMatrix points = random_obstacles(random, 40, 0.9, 0.05);
    points.row(0) << target.translation().transpose(), 0.2;  // around the target: no answer
    double few = 0.0;
    for (const int starts : {2, 8, 60}) {
      // Of a pose it would be said at once that the tool is blocked.
      Options options = timeless(GoalType::Axis, Method::Default, InnerMethod::Lbfgs);
      options.max_restarts = starts;
      Solver solver(robot, options);
      solver.set_obstacles(points);
      const Result result = solver.solve(target);
      ASSERT_FALSE(result.success);
      const double now = shortfall(result, options);
      if (starts > 2) {
        // The search's measure adds up all penetrations, the judge tells the deepest: nearly alike.
        EXPECT_LT(now, 2.0 * few + 1e-4);
        better += starts == 60 && now < 0.98 * few;
      }
      few = now;
    }
  }
  EXPECT_GT(better, 5);  // than the best of the first few
}

TEST(Promises, a_negative_clearance_lets_points_into_hulls_by_that_much_and_no_more) {
  const Robot robot = without_pieces(Robot::builtin("panda"));
  Options options = timeless();
  options.clearance = -0.02;
  int solved = 0, inside = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Solver solver(robot, options);
    const Eigen::VectorXd q0 = random_configuration(robot, random, 0.2);
    // Points that lie in moving hulls a little.
    ObstacleMatrix points(6, seed % 2 == 0 ? 4 : 3);
    for (Eigen::Index i = 0; i < 6; ++i) {
      const Eigen::Vector3d at =
          robot.fk(q0, i % 2 == 0 ? "panda_link5" : "panda_link3").translation();
      points.row(i).head<3>() = (at + random.uniform(0.05, 0.15) * random.direction()).transpose();
      if (points.cols() == 4) points(i, 3) = random.uniform(0.0, 0.03);
    }
    solver.set_obstacles(points);
    Result result;
    solver.solve(robot.fk(q0), &q0, result);
    const double clearance = brute_force_clearance(robot, result.q, points);
    EXPECT_NEAR(result.clearance, clearance, 1e-7);
    if (!result.success) continue;
    ++solved;
    EXPECT_GE(clearance, -0.02 - 1.1e-6);
    inside += clearance < -0.005;
  }
  EXPECT_GT(solved, 20);
  EXPECT_GT(inside, 5);
  options.inner = InnerMethod::Lbfgs;
  EXPECT_THROW(Solver(robot, options), std::invalid_argument);
}

TEST(Promises, numbers_that_make_no_sense_are_refused_by_name) {
  RobotDescription description;
  description.name = "r";
  description.links = {{.name = "a"}, {.name = "b"}};
  const auto refused = [&](const std::string& word, const auto& change,
                           std::vector<std::string> tips = {}) {
    RobotDescription changed = description;
    JointDescription joint = joint_between("a", "b", "j", JointType::Revolute);
    change(joint);
    changed.joints = {joint};
    try {
      Robot(changed, {}, std::move(tips));
      ADD_FAILURE() << "accepted " << word;
    } catch (const LoadError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused("velocity", [](JointDescription& j) { j.velocity = -1.0; });
  refused("velocity", [](JointDescription& j) { j.velocity = std::nan(""); });
  refused("effort", [](JointDescription& j) { j.effort = -1.0; });
  refused("origin", [](JointDescription& j) { j.T_parent_child.translation().x() = 1e7; });
  refused("twice", [](JointDescription&) {}, {"b", "b"});

  const Robot robot = Robot::builtin("panda");
  Lagrangian problem(robot);
  Eigen::VectorXd wrong = Eigen::VectorXd::Zero(problem.size() + 1), gradient;
  EXPECT_THROW(problem.lagrangian(wrong, {}, gradient), std::invalid_argument);
  EXPECT_THROW(problem.max_constraint(wrong), std::invalid_argument);
  EXPECT_THROW(problem.positions(wrong), std::invalid_argument);
  EXPECT_THROW(problem.update_multipliers(wrong, {}), std::invalid_argument);

  Tracker tracker(robot);
  EXPECT_THROW(tracker.set_posture(Eigen::VectorXd::Constant(7, std::nan(""))),
               std::invalid_argument);
}

TEST(Promises, copies_of_a_solver_share_its_cloud_and_none_changes_another_s) {
  const Robot robot = without_pieces(Robot::builtin("panda"));
  Random random(9);
  Solver one(robot);
  const ObstacleMatrix cloud = dense_cloud(9000), other = random_obstacles(random, 5, 1.0);
  one.set_obstacles(cloud);
  Solver two(one);
  two.set_obstacles(other);
  const Eigen::VectorXd q = random_configuration(robot, random);
  Result a, b, c;
  one.judge(robot.fk(q), q, a);
  two.judge(robot.fk(q), q, b);
  EXPECT_NEAR(a.clearance, brute_force_clearance(robot, q, cloud, 100), 1e-7);
  EXPECT_NEAR(b.clearance, brute_force_clearance(robot, q, other, 100), 1e-7);
  Solver three(one);
  three.judge(robot.fk(q), q, c);
  EXPECT_EQ(c.clearance, a.clearance);
}

}  // namespace
}  // namespace pdoik
