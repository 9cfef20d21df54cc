#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "arms.hpp"
#include "pdoik/tracker.hpp"
#include "tree_bench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Where the tip is at time t on a path around the middle of the ranges.
Eigen::Isometry3d on_path(const Robot& robot, double t) {
  Eigen::VectorXd q = robot.mid_configuration();
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q[i] += 0.5 + 0.3 * std::sin(t + 0.7 * static_cast<double>(i));
  return robot.fk(q);
}

Options unhurried() {
  Options options;
  options.max_time = 1.0;
  return options;
}

/// A deadline that no test machine misses, where it is not what the test is about.
TrackerOptions patient() { return {.period = 0.001, .max_time = 0.5}; }

Eigen::VectorXd start_of(const Robot& robot) {
  Solver solver(robot, unhurried());
  const Eigen::VectorXd q0 = robot.mid_configuration();
  return solver.solve(on_path(robot, 0.0), q0).q;
}

TEST(Tracker, follows_a_path_within_speed_limits_and_tolerances) {
  for (const char* name : {"panda", "ur10", "iiwa14"}) {
    SCOPED_TRACE(name);
    const Robot robot = Robot::builtin(name);
    Tracker tracker(robot, unhurried(), patient());
    tracker.reset(start_of(robot));
    Eigen::VectorXd last = tracker.q();
    for (int k = 1; k <= 3000; ++k) {
      const Eigen::Isometry3d target = on_path(robot, 0.001 * k);
      const TrackerResult& step = tracker.step(target);
      ASSERT_EQ(step.tracking, TrackerStatus::Tracking)
          << k << " " << tracker.describe(step.worst) << " " << step.worst.violation;
      ASSERT_LT((robot.fk(step.q).translation() - target.translation()).norm(), 1.1e-5);
      ASSERT_TRUE(
          ((step.q - last).array().abs() <= 0.001 * robot.velocity().array() + 1e-12).all());
      last = step.q;
    }
    EXPECT_EQ(tracker.latency().count(), 3000U);
  }
}

TEST(Tracker, a_target_that_jumps_is_followed_no_faster_than_the_limits_allow) {
  const Robot robot = Robot::builtin("panda");
  Tracker tracker(robot, unhurried(), patient());
  tracker.reset(start_of(robot));
  const Eigen::Isometry3d target = on_path(robot, 2.0);
  Eigen::VectorXd last = tracker.q();
  bool limited = false, arrived = false;
  for (int k = 0; k < 2000 && !arrived; ++k) {
    const TrackerResult& step = tracker.step(target);
    ASSERT_TRUE(((step.q - last).array().abs() <= 0.001 * robot.velocity().array() + 1e-12).all());
    if (step.tracking == TrackerStatus::Infeasible) {
      limited = limited || step.step_limited >= 0;
      EXPECT_NE(tracker.describe(step.worst), "none");
    }
    arrived = step.tracking == TrackerStatus::Tracking;
    last = step.q;
  }
  EXPECT_TRUE(limited);
  EXPECT_TRUE(arrived);
}

TEST(Tracker, a_goal_out_of_reach_does_not_push_the_arm_through_what_stands_in_between) {
  const Robot robot = Robot::builtin("panda");
  Tracker tracker(robot, unhurried(), patient());
  tracker.reset(start_of(robot));
  // A wall of points 0.1 m beyond the tip, and a goal far behind it.
  const Eigen::Isometry3d tip = robot.fk(tracker.q());
  const double x = tip.translation().x() + 0.1;
  ObstacleMatrix wall(21 * 21, 3);
  for (int i = 0; i < 21; ++i) {
    for (int j = 0; j < 21; ++j) {
      wall.row(21 * i + j) << x + 0.15, -1.0 + 0.1 * i, -0.5 + 0.1 * j;
    }
  }
  ASSERT_TRUE(tracker.set_obstacles(wall));
  ASSERT_EQ(tracker.step(tip).tracking, TrackerStatus::Tracking);
  Eigen::Isometry3d goal = tip;
  goal.translation().x() += 1.0;
  double worst = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 1500; ++k) {
    const TrackerResult& step = tracker.step(goal);
    EXPECT_NE(step.tracking, TrackerStatus::Tracking);
    worst = std::min(worst, step.clearance);
  }
  EXPECT_GT(worst, -Options{}.clearance_tolerance);
}

TEST(Tracker, what_moves_is_kept_off_where_it_is_and_where_it_will_be) {
  const Robot robot = Robot::builtin("panda");
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    SCOPED_TRACE(trial);
    const Eigen::VectorXd start = start_of(robot);
    const Eigen::Vector3d about = robot.fk(start).translation();
    Eigen::MatrixXd balls(30, 4), velocity = Eigen::MatrixXd::Zero(30, 3);
    for (Eigen::Index k = 0; k < balls.rows(); ++k) {
      balls.row(k) << (about + random.direction() * random.uniform(0.15, 0.4)).transpose(), 0.02;
      if (k % 3 != 0) velocity.row(k) = 40.0 * random.direction().transpose();
    }
    Eigen::MatrixXd both(50, 4);
    both.topRows(30) = balls;
    for (Eigen::Index k = 0, row = 30; k < 30; ++k) {
      if (k % 3 == 0) continue;
      both.row(row) = balls.row(k);
      both.row(row++).head<3>() += 0.001 * velocity.row(k);
    }
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> now = balls,
                                                                                 union_of = both;
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> moves = velocity;
    Tracker told(robot, unhurried(), patient()), given(robot, unhurried(), patient());
    for (Tracker* each : {&told, &given}) each->reset(start);
    ASSERT_TRUE(told.set_obstacles(now, moves));
    ASSERT_TRUE(given.set_obstacles(union_of));
    for (int k = 0; k < 5; ++k) {
      const TrackerResult &one = told.step(on_path(robot, 0.1)),
                          &other = given.step(on_path(robot, 0.1));
      ASSERT_EQ(one.q, other.q);
      ASSERT_EQ(one.clearance, other.clearance);
      const bool named = one.worst.kind == WorstConstraint::Kind::Clearance;
      ASSERT_LT(named ? one.worst.obstacle : 0, 30);
    }
    const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> too_few = moves.topRows(7);
    EXPECT_FALSE(told.set_obstacles(now, too_few));
    EXPECT_EQ(told.step(on_path(robot, 0.1)).tracking, TrackerStatus::InvalidInput);
  }
}

TEST(Tracker, input_that_makes_no_sense_leaves_the_last_answer_standing_and_says_so) {
  const Robot robot = Robot::builtin("panda");
  Options options = unhurried();
  options.max_obstacles = 100;
  Tracker tracker(robot, options, patient());
  tracker.reset(start_of(robot));
  const Eigen::Isometry3d good = on_path(robot, 0.0);
  const Eigen::VectorXd q = tracker.step(good).q;
  const auto expect_held = [&](const TrackerResult& step, const std::string& word) {
    EXPECT_EQ(step.tracking, TrackerStatus::InvalidInput);
    EXPECT_FALSE(step.success);
    EXPECT_EQ(step.q, q);
    EXPECT_NE(std::string(step.complaint).find(word), std::string::npos) << step.complaint;
  };
  Eigen::Isometry3d bad = good;
  bad.translation().y() = kNan;
  expect_held(tracker.step(bad), "NaN");
  bad = good;
  bad.linear() *= 2.0;
  expect_held(tracker.step(bad), "rigid");
  expect_held(tracker.step(std::span<const Goal>{}), "no goal");
  Goal other;
  other.tip = 5;
  expect_held(tracker.step({&other, 1}), "tip");

  ObstacleMatrix cloud = ObstacleMatrix::Constant(3, 3, 5.0);
  cloud(1, 2) = kNan;
  EXPECT_FALSE(tracker.set_obstacles(cloud));
  expect_held(tracker.step(good), "row 1");
  EXPECT_FALSE(tracker.set_obstacles(ObstacleMatrix::Constant(101, 3, 5.0)));
  expect_held(tracker.step(good), "max_obstacles");
  EXPECT_TRUE(tracker.set_obstacles(ObstacleMatrix(0, 3)));
  EXPECT_EQ(tracker.step(good).tracking, TrackerStatus::Tracking);
  EXPECT_TRUE(tracker.set_obstacles(ObstacleMatrix::Constant(100, 3, 5.0)));
  EXPECT_EQ(tracker.step(good).tracking, TrackerStatus::Tracking);
}

TEST(Tracker, a_deadline_that_strikes_leaves_a_step_within_limits_also_beside_a_busy_thread) {
  std::atomic<bool> stop{false};
  std::thread busy([&] {
    volatile double x = 0.0;
    while (!stop) x = x + 1.0;
  });
  const Robot robot = Robot::builtin("panda");
  Tracker tracker(robot, unhurried(), {.period = 0.001, .max_time = 1e-9});
  tracker.reset(start_of(robot));
  Eigen::VectorXd last = tracker.q();
  const Eigen::Isometry3d target = on_path(robot, 2.0);
  int struck = 0;
  for (int k = 0; k < 200; ++k) {
    const TrackerResult& step = tracker.step(target);
    ASSERT_TRUE(((step.q - last).array().abs() <= 0.001 * robot.velocity().array() + 1e-12).all());
    EXPECT_LE(step.evaluations, 4);  // it looks at the clock before every trial step
    struck += step.tracking == TrackerStatus::DeadlineStruck ? 1 : 0;
    last = step.q;
  }
  stop = true;
  busy.join();
  EXPECT_EQ(struck, 200);
}

TEST(Tracker, obstacles_that_come_near_are_kept_off_and_the_posture_is_returned_to) {
  const Robot robot = Robot::builtin("iiwa14");
  Options options = unhurried();
  options.goal = GoalType::Position;
  options.clearance = 0.01;
  TrackerOptions tracking = patient();
  tracking.posture_weight = 1e-2;
  Tracker tracker(robot, options, tracking);
  Eigen::VectorXd posture = robot.mid_configuration();
  posture[1] = 0.5;
  posture[3] = -1.0;
  const Eigen::Isometry3d target = robot.fk(posture);
  tracker.reset(posture);
  tracker.set_posture(posture);
  ObstacleMatrix ball(1, 4);
  const Eigen::Vector3d elbow = robot.fk(posture, "iiwa_link_4").translation();
  int kept = 0;
  double closest = 1.0;
  const int steps = 1500;
  for (int k = 0; k < steps; ++k) {
    // At 0.25 m/s until it has to push the elbow by some centimetres, and back.
    const double x = 0.1 + 0.00025 * std::abs(k - steps / 2);
    ball.row(0) << elbow.x() - x, elbow.y(), elbow.z(), 0.05;
    tracker.set_obstacles(ball);
    const TrackerResult& step = tracker.step(target);
    kept += step.success ? 1 : 0;
    closest = std::min(closest, step.clearance);
  }
  EXPECT_GT(closest, 0.0099);  // the goal gives way, never the clearance
  EXPECT_GT(kept, steps * 3 / 4);
  tracker.set_obstacles(ObstacleMatrix(0, 3));
  for (int k = 0; k < 2000; ++k) tracker.step(target);
  EXPECT_LT((tracker.q() - posture).norm(), 1e-3);
}

TEST(Tracker, options_out_of_range_are_refused_by_name) {
  const Robot robot = Robot::builtin("panda");
  const auto refused = [&](const TrackerOptions& options, const std::string& word) {
    try {
      Tracker(robot, {}, options);
      ADD_FAILURE() << "accepted " << word;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused({.period = 0.0}, "period");
  refused({.max_time = -1.0}, "max_time");
  refused({.speed_share = kNan}, "speed_share");
  refused({.max_speed = Eigen::VectorXd::Ones(3)}, "max_speed");
  refused({.max_speed = -Eigen::VectorXd::Ones(7)}, "max_speed");
  refused({.posture_weight = -1.0}, "posture_weight");
  Options paper;
  paper.method = Method::Paper;
  EXPECT_THROW(Tracker(robot, paper), std::invalid_argument);
}

TEST(LatencyHistogram, quantiles_are_those_of_the_sorted_times_to_six_percent) {
  LatencyHistogram histogram;
  Random random(1);
  std::vector<double> times;
  for (int k = 0; k < 5000; ++k) {
    times.push_back(1e-6 * std::exp(random.uniform(0.0, 5.0)));
    histogram.add(times.back());
  }
  std::sort(times.begin(), times.end());
  for (const double share : {0.01, 0.5, 0.9, 0.999}) {
    const double exact = times[static_cast<std::size_t>(share * 5000.0) - 1];
    EXPECT_GE(histogram.quantile(share), exact * 0.999);
    EXPECT_LE(histogram.quantile(share), exact * 1.07);
  }
  EXPECT_EQ(histogram.max(), times.back());
  EXPECT_EQ(histogram.quantile(1.0), times.back());
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.quantile(0.5), 0.0);
}

}  // namespace
}  // namespace pdoik
