#include <gtest/gtest.h>

#include "arms.hpp"
#include "common/frame.hpp"
#include "pdoik/tracker.hpp"
#include "shapes/solid.hpp"

/// Contact that is wanted: at the target, to a depth.
namespace pdoik {
namespace {

using namespace pdoik::testing;
using Kind = WorstConstraint::Kind;

/// An arm whose last link is one capsule along the tool's axis and beyond the tip by its radius.
struct Gripper {
  Gripper() : robot(Robot::builtin("panda")) {
    hand = robot.link_names().back();
    Occupancy occupancy;
    occupancy.capsules.push_back({hand, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.1}, kRadius});
    occupancy.capsules.push_back({robot.link_names()[4], {0, 0, 0}, {0, 0, 0.05}, 0.05});
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

TEST(AllowedContact, at_the_target_contact_is_let_to_a_depth_and_within_a_radius) {
  const Gripper gripper;
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

TEST(AllowedContact, a_link_and_a_shape_touch_to_the_depth_that_is_allowed) {
  const Gripper gripper;
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
TEST(AllowedContact, blocked_is_said_where_all_starts_end_by_the_same_hull_at_the_same_obstacle) {
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
