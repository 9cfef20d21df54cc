#include <gtest/gtest.h>

#include "arms.hpp"
#include "detail/frame.hpp"
#include "detail/solid.hpp"
#include "pdoik/tracker.hpp"

/// Contact that is wanted or cannot be told: at the target, to a depth, within a hull's overhang.
namespace pdoik {
namespace {

using namespace pdoik::testing;
using Kind = WorstConstraint::Kind;

/// An arm whose last link is one capsule along the tool's axis and beyond the tip by its radius.
struct Gripper {
  explicit Gripper(double overhang) : robot(Robot::builtin("panda")) {
    hand = robot.link_names().back();
    Occupancy occupancy;
    occupancy.capsules.push_back({hand, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.1}, kRadius, overhang});
    occupancy.capsules.push_back({robot.link_names()[4], {0, 0, 0}, {0, 0, 0.05}, 0.05, overhang});
    robot.set_occupancy(occupancy);
    q = robot.mid_configuration();
    T = robot.fk(q);
  }
  /// A slab whose face is across the tool's axis, this far from the capsule's end.
  Shape slab(double away) const {
    return Shape::half_space("slab", -T.linear().col(2),
                             T * Eigen::Vector3d(0.0, 0.0, 0.1 + kRadius + away));
  }
  Result solve(const Options& options, const Shape& shape) const {
    Solver solver(robot, options);
    solver.set_shapes(Shapes({shape}));
    return solver.solve(T, q);
  }
  /// The same with points on the slab's face, about the tool's axis and out to `width`.
  Result solve_among_points(const Options& options, double away, double width,
                            double radius = 0.0) const {
    Solver solver(robot, options);
    ObstacleMatrix points(9, 4);
    points.col(3).setConstant(radius);
    for (int k = 0; k < 9; ++k) {
      const Eigen::Vector3d p(width * (k % 3 - 1), width * (k / 3 - 1), 0.1 + kRadius + away);
      points.row(k).head<3>() = (T * p).transpose();
    }
    solver.set_obstacles(points);
    return solver.solve(T, q);
  }
  static constexpr double kRadius = 0.02;
  Robot robot;
  std::string hand;
  Eigen::VectorXd q;
  Eigen::Isometry3d T;
};

Options forgiving() {
  Options options = timeless();
  options.forgive_overhang = true;
  return options;
}

TEST(Touching, what_a_hull_overhangs_is_forgiven_where_the_target_places_it) {
  const Gripper gripper(0.006);
  Options options = forgiving();
  EXPECT_EQ(gripper.solve(options, gripper.slab(-0.0055)).status, Status::Solved);
  EXPECT_EQ(gripper.solve(options, gripper.slab(-0.0065)).status, Status::Blocked);
  EXPECT_EQ(gripper.solve_among_points(options, -0.0055, 0.0).status, Status::Solved);
  EXPECT_EQ(gripper.solve_among_points(options, -0.0065, 0.0).status, Status::Blocked);
  // Never more than half the radius.
  const Gripper thin(0.019);
  EXPECT_EQ(thin.solve(options, thin.slab(-0.0095)).status, Status::Solved);
  EXPECT_EQ(thin.solve(options, thin.slab(-0.0105)).status, Status::Blocked);
}

TEST(Touching, nothing_is_forgiven_that_nobody_asked_to_forgive) {
  const Gripper gripper(0.006);
  const Options usual = timeless();
  EXPECT_FALSE(usual.forgive_overhang);
  for (const auto& result : {gripper.solve(usual, gripper.slab(-0.0005)),
                             gripper.solve_among_points(usual, -0.0005, 0.0)}) {
    EXPECT_EQ(result.status, Status::Blocked);
    EXPECT_NEAR(result.clearance, -0.0005, 1e-5);
    EXPECT_EQ(result.forgiven.kind, Kind::None);
  }
  EXPECT_EQ(gripper.solve(usual, gripper.slab(0.0005)).status, Status::Solved);
}

/// By how much a success may be wrong is said, and of what.
TEST(Touching, what_is_forgiven_is_named_and_measured) {
  const Gripper gripper(0.006);
  Options options = forgiving();
  for (const double wanted : {0.0, 0.002, -0.001}) {
    options.clearance = wanted;
    Solver solver(gripper.robot, options);
    solver.set_shapes(Shapes({gripper.slab(wanted - 0.004)}));
    const Result by_shape = solver.solve(gripper.T, gripper.q);
    EXPECT_TRUE(by_shape.success);
    EXPECT_EQ(by_shape.forgiven.kind, Kind::Shape);
    EXPECT_EQ(solver.describe(by_shape.forgiven),
              "clearance of " + gripper.hand + " (capsule 0) to slab");
    EXPECT_NEAR(by_shape.forgiven.violation, 0.004, 2e-5);
    const Result by_point = gripper.solve_among_points(options, wanted - 0.004, 0.0);
    EXPECT_TRUE(by_point.success);
    EXPECT_EQ(by_point.forgiven.kind, Kind::Clearance);
    EXPECT_EQ(by_point.forgiven.index, 0);
    EXPECT_NEAR(by_point.forgiven.violation, 0.004, 2e-5);
    EXPECT_EQ(gripper.solve(options, gripper.slab(wanted + 1e-4)).forgiven.kind, Kind::None);
  }
  options = forgiving();
  options.touch = {.radius = 0.2, .depth = 0.005};  // what may touch has nothing to be forgiven
  EXPECT_EQ(gripper.solve(options, gripper.slab(-0.004)).forgiven.kind, Kind::None);
  EXPECT_EQ(gripper.solve_among_points(options, -0.004, 0.0).forgiven.kind, Kind::None);
}

TEST(Touching, a_trackers_steps_and_batches_name_what_is_forgiven) {
  const Gripper gripper(0.006);
  const Shapes slab({gripper.slab(-0.004)});
  Tracker tracker(gripper.robot, forgiving(), {.max_time = 10.0});
  tracker.reset(gripper.q);
  tracker.set_shapes(slab);
  EXPECT_EQ(tracker.step(gripper.T).forgiven.kind, Kind::Shape);
  EXPECT_EQ(tracker.step(gripper.T).tracking, TrackerStatus::Tracking);
  tracker.set_shapes(Shapes());
  EXPECT_EQ(tracker.step(gripper.T).forgiven.kind, Kind::None);
  Solver solver(gripper.robot, forgiving());
  solver.set_shapes(slab);
  const std::vector<Eigen::Isometry3d> targets(5, gripper.T);
  for (const Result& result : solver.solve_batch(targets, std::vector{gripper.q}, 2)) {
    EXPECT_TRUE(result.success);
    EXPECT_EQ(result.forgiven.kind, Kind::Shape);
  }
}

/// Of the base, what another link carries: the only contact of the robot with itself that is
/// forgiven.
TEST(Touching, what_is_carried_to_the_base_is_named_where_it_is_forgiven) {
  Gripper gripper(0.0);
  Occupancy occupancy;
  occupancy.capsules.push_back({gripper.robot.base_link(), {0, 0, 0.9}, {0, 0, 1.0}, 0.05, 0.006});
  gripper.robot.set_occupancy(occupancy);
  const std::string forearm = gripper.robot.link_names()[5];
  const Eigen::Isometry3d T = gripper.robot.fk(gripper.q, forearm);
  for (const double depth : {0.004, 0.008, -0.001}) {
    Solver solver(gripper.robot, forgiving());
    const Eigen::Vector3d at(0.05 + 0.03 - depth, 0.0, 0.95);  // beside the base's capsule
    solver.attach(forearm, std::vector{Shape::sphere("ball", T.inverse() * at, 0.03)});
    Result result;
    solver.judge(gripper.T, gripper.q, result);
    EXPECT_EQ(result.success, depth < 0.006);
    if (depth < 0.0) {
      EXPECT_EQ(result.forgiven.kind, Kind::None);
      continue;
    }
    EXPECT_EQ(result.forgiven.kind, Kind::HeldHull);
    EXPECT_EQ(solver.describe(result.forgiven),
              "clearance of ball to " + gripper.robot.base_link() + " (capsule 0)");
    EXPECT_NEAR(result.forgiven.violation, depth, 2e-6);
  }
}

/// Whatever the robot and the points: nobody is nearer than what is counted and what is named.
TEST(Touching, with_what_is_forgiven_a_result_is_as_if_nothing_was) {
  for (const std::string& name : arm_names()) {
    SCOPED_TRACE(name);
    const Robot robot = Robot::builtin(name);
    Options options = forgiving();
    options.self_collision = false;
    Solver solver(robot, options);
    options.forgive_overhang = false;
    Solver strict(robot, options);
    Random random(11);
    int named = 0;
    for (int n = 0; n < 60; ++n) {
      const Eigen::VectorXd q = random_configuration(robot, random);
      const Eigen::Isometry3d T = robot.fk(q);
      ObstacleMatrix points = random_obstacles(random, 8, 0.9, 0.01);
      const bool at_base = n % 2 == 0;
      for (Eigen::Index k = 0; k < 4; ++k) {
        const Eigen::Vector3d near =
            (at_base ? Eigen::Vector3d(0.0, 0.0, 0.05) : T.translation()) + random.point(0.12);
        points.row(k).head<3>() = near.transpose();
      }
      Result result, whole;
      for (Solver* each : {&solver, &strict}) each->set_obstacles(points);
      solver.judge(T, q, result);
      strict.judge(T, q, whole);
      EXPECT_NEAR(result.clearance, brute_force_clearance(robot, q, points, 100, true), 1e-9);
      EXPECT_NEAR(whole.clearance, brute_force_clearance(robot, q, points, 100), 1e-9);
      EXPECT_EQ(whole.forgiven.kind, Kind::None);
      const double tolerance = options.clearance_tolerance;
      const bool touches = result.forgiven.kind != Kind::None;
      named += touches;
      // The least is either counted or named.
      const double least =
          std::min(result.clearance, touches ? -result.forgiven.violation - tolerance : 1e9);
      if (whole.clearance < -tolerance) {
        EXPECT_NEAR(least, whole.clearance, 1e-9);
      } else {
        EXPECT_FALSE(touches);
      }
      if (result.success) {
        EXPECT_EQ(whole.success, !touches);
      }
    }
    EXPECT_GT(named, 5);
  }
}

TEST(Touching, other_links_have_nothing_forgiven) {
  const Gripper gripper(0.01);
  Solver solver(gripper.robot, forgiving());
  const Eigen::Isometry3d T = gripper.robot.fk(gripper.q, gripper.robot.link_names()[4]);
  for (const double depth : {0.001, -0.001}) {
    solver.set_shapes(
        Shapes({Shape::sphere("ball", T * Eigen::Vector3d(0.07 - depth, 0.0, 0.025), 0.02)}));
    Result result;
    solver.judge(gripper.T, gripper.q, result);
    EXPECT_EQ(result.success, depth < 0.0);
    EXPECT_NEAR(result.clearance, -depth, 1e-9);
  }
}

TEST(Touching, at_the_target_contact_is_let_to_a_depth_and_within_a_radius) {
  const Gripper gripper(0.0);
  Options options = timeless();
  const double end = 0.1 + Gripper::kRadius;
  const auto solves = [&](double away) {
    const Status by_shape = gripper.solve(options, gripper.slab(away)).status;
    EXPECT_EQ(gripper.solve_among_points(options, away, 0.0).status, by_shape);
    return by_shape == Status::Solved;
  };
  EXPECT_FALSE(solves(-0.004));
  options.touch = {.radius = end + 0.01, .depth = 0.005};
  EXPECT_TRUE(solves(-0.004));
  EXPECT_FALSE(solves(-0.006));
  // Of points that stand for more than themselves the points count.
  EXPECT_TRUE(gripper.solve_among_points(options, -0.004, 0.0, 0.01).success);
  EXPECT_FALSE(gripper.solve_among_points(options, -0.006, 0.0, 0.01).success);
  options.touch.radius = 0.5 * end;  // which the slab is beyond
  EXPECT_FALSE(solves(-0.004));
  options.touch = {.radius = end + 0.01, .depth = 0.005, .links = {gripper.robot.link_names()[2]}};
  EXPECT_FALSE(solves(-0.004));
  options.touch.links = {gripper.hand};
  EXPECT_TRUE(solves(-0.004));
  options.touch.links = {"nobody"};
  EXPECT_THROW(Solver(gripper.robot, options), std::invalid_argument);
  options.touch = {.radius = -1.0};
  EXPECT_THROW(Solver(gripper.robot, options), std::invalid_argument);
}

TEST(Touching, a_link_and_a_shape_touch_to_the_depth_that_is_allowed) {
  const Gripper gripper(0.0);
  for (const double depth : {0.004, 0.006}) {
    Solver solver(gripper.robot, timeless());
    solver.set_shapes(Shapes({gripper.slab(-0.005)}, {{gripper.hand, "slab", -depth}}));
    const Result result = solver.solve(gripper.T, gripper.q);
    EXPECT_EQ(result.success, depth > 0.005);
    if (result.success) {
      EXPECT_NEAR(result.clearance, -0.005, 2e-5);
      EXPECT_NEAR(result.room, depth - 0.005, 2e-5);
    }
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Shapes({gripper.slab(0.0)}, {{gripper.hand, "slab", nan}}), std::invalid_argument);
}

/// Where the elbow cannot but be in a wall, though the tool is not, the budget is not spent.
TEST(Touching, blocked_is_said_where_all_starts_end_by_the_same_hull_at_the_same_obstacle) {
  for (const char* name : {"ur10", "panda"}) {
    SCOPED_TRACE(name);
    Robot robot = Robot::builtin(name);
    // A ball about the shoulder's second link, which reaches the wall wherever it turns.
    Occupancy occupancy;
    const std::string link = robot.link_names()[2];
    occupancy.spheres.push_back({link, {0.05, 0.02, 0.0}, 0.4});
    robot.set_occupancy(occupancy);
    const Eigen::VectorXd q = robot.mid_configuration();
    Options options = timeless();
    options.max_restarts = 100'000;
    Solver solver(robot, options);
    const Eigen::Vector3d shoulder = robot.fk(q, link).translation();
    solver.set_shapes(
        Shapes({Shape::half_space("wall", {0, 0, -1}, shoulder + Eigen::Vector3d(0.0, 0.0, 0.3))}));
    Random random(5);
    const Result result = solver.solve(robot.fk(random_configuration(robot, random, 0.2)));
    EXPECT_EQ(result.status, Status::Blocked);
    EXPECT_LT(result.restarts, 3000);
    EXPECT_EQ(result.worst.kind, Kind::Shape);
    EXPECT_EQ(solver.describe(result.worst), "clearance of " + link + " (sphere 0) to wall");
    EXPECT_NEAR(result.worst.violation, 0.1, 0.06);
    EXPECT_LT(result.position_error, options.position_tolerance);
    Eigen::MatrixXd point(1, 3);
    point << (shoulder + Eigen::Vector3d(0.0, 0.0, 0.2)).transpose();
    solver.clear_obstacles();
    solver.set_obstacles(point);
    EXPECT_EQ(solver.solve(robot.fk(random_configuration(robot, random, 0.2))).status,
              Status::Blocked);
  }
}

}  // namespace
}  // namespace pdoik
