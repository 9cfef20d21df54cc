#include <gtest/gtest.h>

#include "arms.hpp"
#include "pdoik/tracker.hpp"
#include "track/braking.hpp"

// A robot whose acceleration is limited brakes before goals, limits and obstacles.
namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

Eigen::VectorXd drawn(Random& random, int n, double low, double high) {
  Eigen::VectorXd x(n);
  for (double& each : x) each = random.uniform(low, high);
  return x;
}

TEST(Braking, a_step_leads_to_where_braking_as_hard_as_may_be_comes_to_rest) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const double period = random.uniform(0.001, 0.02);
    const Eigen::VectorXd most = drawn(random, 3, 0.5, 3.0), a = drawn(random, 3, 1.0, 50.0);
    const Eigen::VectorXd end = Eigen::VectorXd::Constant(3, 100.0);
    detail::Braking braking(period, -end, end, most, a);
    const Eigen::VectorXd from = drawn(random, 3, -2.0, 2.0),
                          velocity = most.cwiseProduct(drawn(random, 3, -1.0, 1.0));
    braking.begin(from, velocity);
    Eigen::VectorXd lower(3), upper(3), next(3), rest(3);
    braking.box(from, lower, upper);
    const Eigen::VectorXd aim = lower + (upper - lower).cwiseProduct(drawn(random, 3, 0.0, 1.0));
    braking.place(from, aim, next, rest);
    EXPECT_LT((rest - aim).cwiseAbs().maxCoeff(), 1e-12);
    const Eigen::VectorXd v = (next - from) / period;
    EXPECT_LT((v.cwiseAbs() - most).maxCoeff(), 1e-9);
    EXPECT_LT(((v - velocity).cwiseAbs() - period * a).maxCoeff(), 1e-9);
    // By steps of a thousandth, from the end of the step on.
    Eigen::VectorXd q = next, left = v;
    for (const double h = 1e-3 * period; left.cwiseAbs().maxCoeff() > 0.0;) {
      const Eigen::VectorXd less = left.cwiseAbs().cwiseMin(h * a).cwiseProduct(left.cwiseSign());
      q += h * (left - 0.5 * less);
      left -= less;
    }
    EXPECT_LT((q - rest).cwiseAbs().maxCoeff(), 1e-5);
    // And so does the way that is looked at, in pieces none of which is longer than told.
    const Eigen::VectorXd displacement_bounds = drawn(random, 3, 0.1, 1.0);
    const double way = braking.brake(from, next, displacement_bounds);
    Eigen::VectorXd before(3), there(3);
    braking.between(0.0, before);
    EXPECT_LT((before - next).cwiseAbs().maxCoeff(), 1e-12);
    for (int k = 1; k <= 50; ++k) {
      braking.between(k / 50.0, there);
      EXPECT_LE(displacement_bounds.dot((there - before).cwiseAbs()), way / 50.0 + 1e-12);
      before = there;
    }
    EXPECT_LT((before - rest).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Braking, a_stop_that_is_too_hard_is_said_whatever_the_speed_limit) {
  for (const double most : {2.0, 1e9, kInfinite}) {
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
    detail::Braking braking(0.01, -100.0 * one, 100.0 * one, most * one, 3.7 * one);
    const Eigen::VectorXd at = 0.27 * one, slower = at + 0.01 * (0.26 - 0.036) * one;
    braking.begin(at, 0.26 * one);
    braking.made(at, slower, false, false);
    EXPECT_FALSE(braking.was_hard()) << most;
    braking.made(slower, slower, false, true);  // at once
    EXPECT_TRUE(braking.was_hard()) << most;
  }
}

TEST(Braking, joints_without_a_limit_step_as_they_like) {
  const Eigen::Vector2d end = Eigen::Vector2d::Constant(kInfinite), speed(1.0, 2.0);
  detail::Braking braking(0.01, -end, end, speed, end);
  EXPECT_FALSE(braking.limited());
  EXPECT_EQ(detail::Braking(0.01, -end, end, end, end).farthest()[0], kInfinite);
  detail::Braking one(0.01, -end, end, speed, Eigen::Vector2d(kInfinite, 5.0));
  Eigen::VectorXd from = Eigen::Vector2d::Zero(), lower(2), upper(2), next(2), rest(2);
  one.box(from, lower, upper);
  EXPECT_NEAR(upper[0], 0.01, 1e-15);
  one.place(from, upper, next, rest);
  EXPECT_NEAR(next[0], rest[0], 1e-15);
  EXPECT_LT(next[1], rest[1]);
}

/// What steps of a tracker must hold, whatever they are for.
struct Watched {
  Watched(const Robot& robot, Options options, double acceleration)
      : a(Eigen::VectorXd::Constant(robot.dof(), acceleration)),
        tracker(robot, options, {.period = 0.004, .max_time = 1e6, .max_acceleration = a}) {}

  const TrackerResult& step(const Goal& goal) {
    const Eigen::VectorXd from = tracker.q(), before = tracker.velocity();
    const TrackerResult& result = tracker.step({&goal, 1});
    const Robot& robot = tracker.robot();
    EXPECT_LT((tracker.velocity() - (result.q - from) / 0.004).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((tracker.velocity().cwiseAbs() - robot.velocity()).maxCoeff(), 1e-9);
    if (!result.stopped_hard) {
      EXPECT_LT(((tracker.velocity() - before).cwiseAbs() - 0.004 * a).maxCoeff(), 1e-8);
    }
    EXPECT_TRUE((result.q.array() >= robot.lower().array()).all());
    EXPECT_TRUE((result.q.array() <= robot.upper().array()).all());
    hard += result.stopped_hard ? 1 : 0;
    return result;
  }

  Eigen::VectorXd a;
  Tracker tracker;
  int hard = 0;
};

Goal pose_of(const Robot& robot, const Eigen::VectorXd& q) {
  Goal goal;
  goal.T_base_tip = robot.fk(q, robot.tips()[0]);
  return goal;
}

TEST(Braking, a_goal_far_away_is_reached_without_a_step_too_hard_and_not_overshot) {
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    Random random(7);
    int reached = 0, past = 0;
    for (int trial = 0; trial < 6; ++trial) {
      Options options = timeless();
      options.self_collision = false;
      Watched watched(robot, options, 8.0);
      const Eigen::VectorXd q = random_configuration(robot, random, 0.2);
      const Goal goal = pose_of(robot, q + drawn(random, robot.dof(), -0.5, 0.5));
      watched.tracker.reset(q);
      double nearest = 10.0;
      for (int k = 0; k < 1500; ++k) {
        const TrackerResult& step = watched.step(goal);
        if (HasFailure()) return;
        const double error = std::hypot(step.position_error, 0.3 * step.rotation_error);
        nearest = std::min(nearest, error);
        past += error > nearest + 1e-3 && nearest < 1e-3 ? 1 : 0;
      }
      EXPECT_EQ(watched.hard, 0) << name;
      const TrackerResult& step = watched.step(goal);
      reached += step.success ? 1 : 0;
      EXPECT_LT(watched.tracker.velocity().cwiseAbs().maxCoeff(), 1e-3) << name << trial;
    }
    EXPECT_GE(reached, 4) << name;  // some end at a limit
    EXPECT_EQ(past, 0) << name;
  }
}

TEST(Braking, a_goal_that_moves_is_caught_up_with_and_followed) {
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    Watched watched(robot, timeless(), 8.0);
    const Eigen::VectorXd q = bent_arm(robot);
    watched.tracker.reset(q);
    Goal goal = pose_of(robot, q);
    const Eigen::Vector3d centre = goal.T_base_tip.translation();
    int followed = 0;
    for (int k = 0; k < 1500; ++k) {  // a circle of 5 cm at 0.2 m/s
      const double turn = 0.2 * 0.004 / 0.05 * k;
      goal.T_base_tip.translation() =
          centre + 0.05 * Eigen::Vector3d(std::cos(turn) - 1.0, 0.0, std::sin(turn));
      const TrackerResult& step = watched.step(goal);
      if (HasFailure()) return;
      followed += k >= 500 && step.position_error < 1e-4 && step.rotation_error < 1e-4 ? 1 : 0;
    }
    EXPECT_EQ(followed, 1000) << name;
  }
}

TEST(Braking, what_stands_still_is_braked_before) {
  int near = 0, hard = 0;
  for (const std::string& name : arm_names()) {
    const Robot robot = with_hulls(Robot::builtin(name));
    Random random(11);
    for (int trial = 0; trial < 4; ++trial) {
      Options options = timeless();
      options.self_collision = false;
      Watched watched(robot, options, 8.0);
      const Eigen::VectorXd q = random_configuration(robot, random, 0.2),
                            aim = random_configuration(robot, random, 0.1);
      ObstacleMatrix points(12, 4);
      for (Eigen::Index k = 0; k < points.rows();) {
        const auto link = static_cast<std::size_t>(random.uniform(2.0, 6.9));
        Eigen::Vector3d at =
            robot.fk(q + random.uniform(0.3, 1.0) * (aim - q), robot.link_names()[link])
                .translation();
        for (int i = 0; i < 3; ++i) at[i] += random.uniform(-0.05, 0.05);
        points.row(k) << at.transpose(), 0.01;
        if (brute_force_clearance(robot, q, points.row(k), 50) > 0.005) ++k;
      }
      watched.tracker.set_obstacles(points);
      watched.tracker.reset(q);
      const Goal goal = pose_of(robot, aim);
      for (int k = 0; k < 700; ++k) {
        const TrackerResult& step = watched.step(goal);
        if (HasFailure()) return;
        ASSERT_GT(brute_force_clearance(robot, step.q, points, 50), -1e-3) << name << k;
        near += step.clearance < 0.005 ? 1 : 0;
      }
      hard += watched.hard;
    }
  }
  EXPECT_GT(near, 100);
  EXPECT_LE(hard,
            2);  // where the way on which it brakes grazes something by less than is looked for
}

TEST(Braking, what_comes_too_near_to_be_braked_before_is_stopped_before) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Options options = timeless();
  options.self_collision = false;
  Watched watched(robot, options, 2.0);
  Random random(3);
  Eigen::VectorXd q = robot.mid_configuration();
  watched.tracker.reset(q);
  q[0] += 1.5;
  const Goal goal = pose_of(robot, q);
  for (int k = 0; k < 120; ++k) watched.step(goal);
  ASSERT_GT(watched.tracker.velocity()[0], 0.5);
  // A wall of points right before the hand, where it cannot brake any more.
  const Eigen::VectorXd here = watched.tracker.q();
  ObstacleMatrix wall(400, 4);
  Eigen::VectorXd ahead = here + 0.03 * watched.tracker.velocity();
  Eigen::Index count = 0;
  for (int k = 0; k < 20000 && count < wall.rows(); ++k) {
    Eigen::Vector3d at = robot.fk(ahead, robot.tips()[0]).translation();
    for (int i = 0; i < 3; ++i) at[i] += random.uniform(-0.2, 0.2);
    wall.row(count) << at.transpose(), 0.005;
    if (brute_force_clearance(robot, here, wall.row(count), 50) > 0.004) ++count;
  }
  ASSERT_EQ(count, wall.rows());
  watched.tracker.set_obstacles(wall);
  for (int k = 0; k < 300; ++k) {
    const TrackerResult& step = watched.step(goal);
    EXPECT_GT(brute_force_clearance(robot, step.q, wall, 50), -1e-4) << k;
  }
  EXPECT_GE(watched.hard, 1);
}

TEST(Braking, limits_that_make_no_sense_are_refused) {
  const Robot robot = Robot::builtin("panda");
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    Eigen::VectorXd a = Eigen::VectorXd::Constant(7, 5.0);
    a[2] = bad;
    EXPECT_THROW(Tracker(robot, {}, {.max_acceleration = a}), std::invalid_argument);
  }
  EXPECT_THROW(Tracker(robot, {}, {.max_acceleration = Eigen::VectorXd::Ones(3)}),
               std::invalid_argument);
  Tracker tracker(robot, {}, {.max_acceleration = Eigen::VectorXd::Ones(7)});
  EXPECT_THROW(tracker.reset(robot.mid_configuration(), Eigen::VectorXd::Ones(3)),
               std::invalid_argument);
}

}  // namespace
}  // namespace pdoik
