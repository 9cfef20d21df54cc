#include <gtest/gtest.h>

#include <functional>

#include "arms.hpp"
#include "common/deadline.hpp"
#include "pdoik/tracker.hpp"

// No step is worse than standing still, whenever the clock strikes and whatever becomes of it.
namespace pdoik {
namespace {

using namespace pdoik::testing;

/// A robot among what it may touch, and a goal on the other side of it.
struct Place {
  std::string name;
  Robot robot;
  Options options;
  Eigen::VectorXd q;
  std::vector<Goal> goals;
  ObstacleMatrix points;
  std::vector<Shape> shapes, held;
};

Goal pose_of(const Robot& robot, const Eigen::VectorXd& q, int tip = 0) {
  Goal goal;
  goal.tip = tip;
  goal.T_base_tip = robot.fk(q, robot.tips()[static_cast<std::size_t>(tip)]);
  return goal;
}

Options timeless_with(bool self_collision) {
  Options options = timeless();
  options.self_collision = self_collision;
  return options;
}

/// Points about the middle of the way from one configuration to another, that leave the first one
/// clear.
ObstacleMatrix in_between(const Robot& robot, Random& random, const Eigen::VectorXd& from,
                          const Eigen::VectorXd& to) {
  ObstacleMatrix points(12, 4);
  for (Eigen::Index k = 0; k < points.rows();) {
    const double share = random.uniform(0.3, 1.0);
    const Eigen::VectorXd q = from + share * (to - from);
    const auto link = static_cast<std::size_t>(random.uniform(2.0, 6.9));
    Eigen::Vector3d at = robot.fk(q, robot.link_names()[link]).translation();
    for (int i = 0; i < 3; ++i) at[i] += random.uniform(-0.05, 0.05);
    points.row(k) << at.transpose(), 0.01;
    if (brute_force_clearance(robot, from, points.row(k), 50) > 0.005) ++k;
  }
  return points;
}

Place arm_place(const std::string& name, const std::string& kind, std::uint64_t seed) {
  Random random(seed);
  Place place{name + ", " + kind,
              with_hulls(Robot::builtin(name)),
              timeless_with(kind == "self"),
              {},
              {},
              ObstacleMatrix(0, 4),
              {},
              {}};
  const Robot& robot = place.robot;
  place.q = random_configuration(robot, random, 0.1);
  const Eigen::VectorXd aim = random_configuration(robot, random, 0.1);
  place.goals = {pose_of(robot, aim)};
  if (kind == "self") return place;
  place.points = in_between(robot, random, place.q, aim);
  if (kind == "shapes") {
    for (Eigen::Index k = 0; k < place.points.rows(); ++k) {
      place.shapes.push_back(
          Shape::sphere("ball " + std::to_string(k), place.points.row(k).head<3>(), 0.01));
    }
    place.points.resize(0, 4);
  }
  if (kind == "held") {
    place.held = {Shape::box("box", Eigen::Isometry3d::Identity(), {0.06, 0.06, 0.2})};
  }
  return place;
}

void dress(const Place& place, auto& solver) {
  if (place.points.rows() > 0) solver.set_obstacles(place.points);
  if (!place.shapes.empty()) solver.set_shapes(Shapes(place.shapes));
  if (!place.held.empty()) {
    const Robot& robot = place.robot;
    solver.attach(robot.link_names()[static_cast<std::size_t>(robot.tips()[0])], place.held);
  }
}

/// What is left before contact, by kind.
Eigen::Vector3d room(const Result& verdict, const Options& options) {
  return {verdict.clearance - options.clearance, verdict.self_distance - options.self_clearance,
          -verdict.balance_violation};
}

class Judged {
 public:
  explicit Judged(const Place& place) : place_(place), solver_(place.robot, place.options) {
    dress(place, solver_);
  }
  Eigen::Vector3d room_at(const Eigen::VectorXd& q) {
    solver_.judge(place_.goals, q, verdict_);
    return room(verdict_, place_.options);
  }

 private:
  const Place& place_;
  Solver solver_;
  Result verdict_;
};

constexpr double kRounding = 1e-9;  // [m]
/// What may be grazed between two places on a way that were looked at [m].
constexpr double kGraze = 2e-4;

void expect_no_worse(Judged& judged, const Eigen::VectorXd& from, const Eigen::VectorXd& to,
                     const std::string& when) {
  const Eigen::Vector3d floor = judged.room_at(from).cwiseMin(0.0);
  const Eigen::Vector3d end = judged.room_at(to);
  ASSERT_GE((end - floor).minCoeff(), -kRounding) << when << ": " << (end - floor).transpose();
  for (int k = 1; k < 10 && (to - from).cwiseAbs().maxCoeff() > 0.0; ++k) {
    const Eigen::Vector3d there = judged.room_at(from + 0.1 * k * (to - from));
    ASSERT_GE((there - floor).minCoeff(), -kGraze) << when << ", on the way";
  }
}

std::vector<Place> places() {
  std::vector<Place> result;
  for (const std::string& name : arm_names())
    for (const char* kind : {"points", "shapes", "held", "self"})
      for (std::uint64_t seed = 1; seed <= 2; ++seed) result.push_back(arm_place(name, kind, seed));
  return result;
}

/// With so much acceleration.
class EveryStep : public ::testing::TestWithParam<double> {};

TEST_P(EveryStep, is_no_deeper_than_standing_still_at_whatever_look_the_clock_strikes) {
  int moved = 0, struck = 0, near = 0;
  for (const Place& place : places()) {
    Judged judged(place);
    const Eigen::VectorXd a = Eigen::VectorXd::Constant(place.robot.dof(), GetParam());
    Tracker tracker(place.robot, place.options,
                    {.period = 0.01, .max_time = 1e6, .max_acceleration = a});
    dress(place, tracker);
    tracker.reset(place.q);
    for (int k = 0; k < 60; ++k) {
      const Eigen::VectorXd from = tracker.q(), velocity = tracker.velocity();
      if (k % 6 == 5) {
        for (int looks = 1; looks < 60; looks += 1 + looks / 8) {
          detail::Deadline::looks_left = looks;
          tracker.reset(from, velocity);
          const TrackerResult& step = tracker.step(place.goals);
          struck += step.tracking == TrackerStatus::DeadlineStruck ? 1 : 0;
          detail::Deadline::looks_left = 0;
          expect_no_worse(
              judged, from, step.q,
              place.name + ", look " + std::to_string(looks) + " of step " + std::to_string(k));
          if (HasFatalFailure()) return;
        }
        tracker.reset(from, velocity);
      }
      const TrackerResult& step = tracker.step(place.goals);
      moved += step.q == from ? 0 : 1;
      near += judged.room_at(from).minCoeff() < 0.005 ? 1 : 0;
      expect_no_worse(judged, from, step.q, place.name + ", step " + std::to_string(k));
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(moved, 400);
  EXPECT_GT(struck, 400);
  EXPECT_GT(near, 100);  // or nothing was tried
}
INSTANTIATE_TEST_SUITE_P(, EveryStep,
                         ::testing::Values(std::numeric_limits<double>::infinity(), 20.0));

TEST(SafeSteps, what_comes_at_an_arm_at_half_a_metre_per_second_is_kept_off) {
  for (const std::string& name : arm_names()) {
    Place place{name,
                with_hulls(Robot::builtin(name)),
                timeless_with(false),
                {},
                {},
                ObstacleMatrix(0, 4),
                {},
                {}};
    place.options.clearance = 0.02;
    place.q = place.robot.mid_configuration();
    place.q[1] += 0.5;
    place.q[3] -= 0.7;
    place.goals = {pose_of(place.robot, place.q)};
    const std::vector<std::string>& links = place.robot.link_names();
    const Eigen::Vector3d at = place.robot.fk(place.q, links[4]).translation();
    Tracker tracker(place.robot, place.options, {.period = 0.001, .max_time = 1e6});
    tracker.reset(place.q);
    tracker.set_posture(place.q);
    Random random(3);
    ObstacleMatrix ball(80, 4), now;
    for (Eigen::Index k = 0; k < ball.rows(); ++k) {
      const Eigen::Vector3d out =
          Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1))
              .normalized();
      ball.row(k) << 0.08 * out.transpose(), 0.015;
    }
    double least = 1.0;
    for (int k = 0; k < 700; ++k) {
      now = ball;
      now.leftCols<3>().rowwise() +=
          (at + Eigen::Vector3d(0.02, -0.3 + 0.0005 * k, 0.03)).transpose();
      tracker.set_obstacles(now);
      least = std::min(least, tracker.step(place.goals).clearance);
    }
    EXPECT_GT(least, place.options.clearance - 1e-4) << name;
  }
}

TEST(SafeSteps, an_arm_whose_goal_cannot_be_reached_comes_to_rest) {
  for (const std::string& name : arm_names()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Place place = arm_place(name, "shapes", seed);
      Tracker tracker(place.robot, place.options, {.period = 0.002, .max_time = 1e6});
      dress(place, tracker);
      tracker.reset(place.q);
      Eigen::VectorXd before = place.q, way = before;
      int back = 0;
      for (int k = 0; k < 3000; ++k) {
        const Eigen::VectorXd& q = tracker.step(place.goals).q;
        if (k >= 2500) {
          back += ((q - before).array() * way.array()).minCoeff() < -1e-10 ? 1 : 0;
          EXPECT_LT((q - before).cwiseAbs().maxCoeff() / 0.002, 0.02) << place.name << " " << k;
          if (HasFailure()) return;
        }
        way = q - before;
        before = q;
      }
      EXPECT_EQ(back, 0) << place.name;
    }
  }
}

TEST(SafeSteps, a_goal_metres_away_is_come_as_near_to_as_joints_allow) {
  Options options = timeless();
  options.self_collision = false;
  constexpr double kStep = 1e-5;  // of the differences [rad]
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    Random random(5);
    for (int k = 0; k < 4; ++k) {
      Goal goal;
      goal.type = GoalType::Position;
      const Eigen::Vector3d out(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 1));
      goal.T_base_tip.translation() = 2.5 * out.normalized();
      const auto left = [&](const Eigen::VectorXd& q) {
        return (robot.fk(q, robot.tips()[0]).translation() - goal.T_base_tip.translation()).norm();
      };
      Tracker tracker(robot, options, {.period = 0.001, .max_time = 1e6});
      tracker.reset(random_configuration(robot, random));
      Eigen::VectorXd q;
      for (int step = 0; step < 8000; ++step) q = tracker.step({&goal, 1}).q;
      for (int i = 0; i < robot.dof(); ++i) {
        Eigen::VectorXd more = q, less = q;
        more[i] = std::min(q[i] + kStep, robot.upper()[i]);
        less[i] = std::max(q[i] - kStep, robot.lower()[i]);
        EXPECT_GT(left(more) - left(q), -2e-3 * kStep) << name << " " << k << " joint " << i;
        EXPECT_GT(left(less) - left(q), -2e-3 * kStep) << name << " " << k << " joint " << i;
      }
    }
  }
}

TEST(SafeSteps, a_foot_that_stands_gives_nothing_of_its_place_up_for_a_hand_that_cannot_reach) {
  const Robot robot = Robot::builtin("h1", "left_ankle_link",
                                     {"right_ankle_link", "left_elbow_link", "right_elbow_link"});
  Eigen::VectorXd q = Eigen::VectorXd::Zero(robot.dof());
  for (int i = 0; i < robot.dof(); ++i) {
    const std::string& name = robot.joint_names()[static_cast<std::size_t>(i)];
    if (name.find("knee") != std::string::npos) q[i] = 0.6;
    if (name.find("hip_pitch") != std::string::npos) q[i] = -0.3;
    if (name.find("ankle") != std::string::npos) q[i] = -0.3;
  }
  Goal foot, hand;
  foot.tip = 0;
  foot.T_base_tip = robot.fk(q, robot.tips()[0]);
  hand.tip = 1;
  hand.type = GoalType::Position;
  const Eigen::Vector3d at = robot.fk(q, robot.tips()[1]).translation();
  for (const Eigen::Vector3d& way :
       {Eigen::Vector3d(0.8, 0.0, 0.0), Eigen::Vector3d(0.0, 0.6, 0.4),
        Eigen::Vector3d(0.3, 0.2, -0.9), Eigen::Vector3d(-0.7, 0.0, 0.3)}) {
    double slipped[2] = {0.0, 0.0}, left[2] = {0.0, 0.0};
    for (const bool stands : {false, true}) {
      Options options = timeless();
      options.self_collision = false;
      Tracker tracker(robot, options, {.period = 0.004, .max_time = 1e6});
      tracker.reset(q);
      foot.stands = stands;
      hand.T_base_tip.translation() = at + way;
      const std::vector<Goal> goals = {foot, hand};
      for (int k = 0; k < 400; ++k) {
        const Eigen::VectorXd& now = tracker.step(goals).q;
        const Eigen::Isometry3d T = robot.fk(now, robot.tips()[0]);
        slipped[stands] =
            std::max(slipped[stands], (T.translation() - foot.T_base_tip.translation()).norm());
        left[stands] =
            (robot.fk(now, robot.tips()[1]).translation() - hand.T_base_tip.translation()).norm();
      }
    }
    EXPECT_LT(slipped[true], 6e-5) << way.transpose();
    EXPECT_GT(slipped[false], 1e-2) << way.transpose();  // or nothing was asked
    EXPECT_LT(left[true], way.norm() - 0.1) << way.transpose();
  }
}

TEST(SafeSteps, a_robot_without_hulls_follows) {
  for (const std::string& name : arm_names()) {
    Robot robot = Robot::builtin(name);
    robot.set_occupancy({});
    Tracker tracker(robot, timeless(), {.period = 0.001, .max_time = 1e6, .speed_share = 3.0});
    const Eigen::VectorXd q = bent_arm(robot);
    tracker.reset(q);
    Goal goal = pose_of(robot, q);
    const Eigen::Vector3d centre = goal.T_base_tip.translation();
    for (int k = 0; k < 500; ++k) {  // a circle of 2 cm at 0.25 m/s
      const double turn = 0.00025 / 0.02 * k;
      goal.T_base_tip.translation() =
          centre + 0.02 * Eigen::Vector3d(std::cos(turn) - 1.0, 0.0, std::sin(turn));
      const TrackerResult& step = tracker.step({&goal, 1});
      EXPECT_TRUE(step.success) << name << " " << k;
    }
  }
}

}  // namespace
}  // namespace pdoik
