#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arms.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/lagrangian.hpp"
#include "pdoik/option_fields.hpp"
#include "pdoik/tracker.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The call must throw invalid_argument with every one of `words` in its message.
template <class Call>
void expect_invalid(Call&& call, const std::vector<std::string>& words) {
  try {
    call();
    ADD_FAILURE() << "accepted; expected an invalid_argument with '" << words.front() << "'";
  } catch (const std::invalid_argument& error) {
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << error.what() << " lacks " << word;
    }
  }
}

TEST(SolverMisuse, options_out_of_range_are_refused_by_name) {
  const Robot robot = Robot::builtin("panda");
  const auto refused = [&](const char* name, auto&& change) {
    Options options;
    change(options);
    expect_invalid([&] { Solver(robot, options); }, {name});
  };
  for (const double bad : {0.0, -1.0, kNan, kInfinity}) {
    refused("position_tolerance", [&](Options& o) { o.position_tolerance = bad; });
    refused("rotation_tolerance", [&](Options& o) { o.rotation_tolerance = bad; });
    refused("collision_weight", [&](Options& o) { o.collision_weight = bad; });
  }
  for (const double bad : {-1.0, kNan, kInfinity}) {  // 0 is for by the robot's size
    refused("rotation_weight", [&](Options& o) { o.rotation_weight = bad; });
    refused("point_distance", [&](Options& o) { o.point_distance = bad; });
  }
  for (const double bad : {kNan, kInfinity, -kInfinity})
    refused("clearance", [&](Options& o) { o.clearance = bad; });
  for (const double bad : {-1e-9, kNan, kInfinity}) {
    refused("clearance_tolerance", [&](Options& o) { o.clearance_tolerance = bad; });
  }
  for (const double bad : {0.0, -1.0, kNan})
    refused("max_time", [&](Options& o) { o.max_time = bad; });
  for (const double bad : {0.0, 0.5, -0.1, kNan})
    refused("start_inset", [&](Options& o) { o.start_inset = bad; });
  refused("max_restarts", [](Options& o) { o.max_restarts = -1; });
  refused("max_obstacles", [](Options& o) { o.max_obstacles = -1; });
  refused("memory", [](Options& o) { o.lbfgs.memory = 0; });
  refused("armijo", [](Options& o) { o.lbfgs.armijo = 2.0; });
  for (const Eigen::Vector3d& bad :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(kNan, 0.0, 1.0)}) {
    refused("goal_axis", [&](Options& o) { o.goal_axis = bad; });
  }
}

/// Calls spoil(name, change) for each number of a struct of options and of the structs in it; what
/// `change` does to Options is NaN there, or -1 of a whole number.
template <class Struct, class Get, class Spoil>
void for_each_number(const std::string& prefix, Get get, Spoil&& spoil) {
  const auto visit = [&](const auto& field) {
    const auto at = [get, member = field.member](Options& o) -> auto& { return get(o).*member; };
    using Value = std::remove_cvref_t<decltype(at(std::declval<Options&>()))>;
    const std::string name = prefix + field.name;
    if constexpr (std::tuple_size_v<decltype(detail::option_fields<Value>)> > 0)
      for_each_number<Value>(name + ".", at, spoil);
    else if constexpr (std::is_same_v<Value, double>)
      spoil(name, [at](Options& o) { at(o) = kNan; });
    else if constexpr (std::is_same_v<Value, int>)
      spoil(name, [at](Options& o) { at(o) = -1; });
  };
  std::apply([&](const auto&... field) { (visit(field), ...); }, detail::option_fields<Struct>);
}

TEST(SolverMisuse, every_number_among_the_options_is_refused_by_its_name) {
  const Robot robot = Robot::builtin("panda");
  int count = 0;
  const auto refused = [&](const std::string& name, auto&& change) {
    Options options;
    change(options);
    expect_invalid([&] { Solver(robot, options); }, {name + " is ", ", expected "});
    ++count;
  };
  for_each_number<Options>("", [](Options& o) -> Options& { return o; }, refused);
  EXPECT_GT(count, 30);
}

TEST(SolverMisuse, more_rows_than_places_can_be_counted_for_are_refused_before_any_is_read) {
  // Rows that overlap, of memory that is never touched.
  const Eigen::Index rows = (Eigen::Index{1} << 25) + 1;
  const std::unique_ptr<double, decltype(&std::free)> memory(
      static_cast<double*>(std::calloc(static_cast<std::size_t>(rows) + 2, sizeof(double))),
      &std::free);
  ASSERT_NE(memory, nullptr);
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Map<const Rows, 0, Eigen::OuterStride<>> many(memory.get(), rows, 3,
                                                             Eigen::OuterStride<>(1));
  Solver solver(Robot::builtin("panda"));
  expect_invalid([&] { solver.set_obstacles(many); }, {"obstacles", "33554433 rows"});
  expect_invalid([&] { Cloud{Obstacles(many)}; }, {"points", "33554433 rows"});
  Lagrangian lagrangian(Robot::builtin("panda"), {}, Lagrangian::Variables::Slack);
  expect_invalid([&] { lagrangian.set_obstacles(many); }, {"obstacles", "33554433 rows"});
}

TEST(SolverMisuse, robots_it_cannot_take_are_refused) {
  RobotDescription description;
  description.links = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
  description.joints = {joint_between("a", "b", "j", JointType::Revolute),
                        joint_between("a", "c", "k", JointType::Revolute)};
  expect_invalid([&] { Solver(Robot{description}).solve(Eigen::Isometry3d::Identity()); },
                 {"2 tips", "b", "c"});
  EXPECT_NO_THROW(Solver(Robot(description, {}, {"c"})));
  RobotDescription rigid;
  rigid.links = {{.name = "a"}, {.name = "b"}};
  rigid.joints = {joint_between("a", "b", "j")};
  expect_invalid([&] { Solver(Robot{rigid}); }, {"0 joints"});
  expect_invalid(
      [] {
        Solver(
            Robot::from_dh(std::vector<DhRow>(65, DhRow{.a = 0.1, .lower = -1.0, .upper = 1.0})));
      },
      {"65"});
  EXPECT_NO_THROW(
      Solver(Robot::from_dh(std::vector<DhRow>(64, DhRow{.a = 0.1, .lower = -1.0, .upper = 1.0}))));
}

TEST(SolverMisuse,
     targets_starts_and_obstacles_that_make_no_sense_are_refused_and_leave_the_solver_usable) {
  const Robot robot = Robot::builtin("ur10");
  Solver solver(robot, timeless());
  const Eigen::Isometry3d good = robot.fk(Eigen::VectorXd::Constant(6, 0.5));
  Eigen::Isometry3d nan = good, sheared = good, mirrored = good, scaled = good;
  nan.translation().y() = kNan;
  sheared.linear()(0, 1) += 1e-3;
  mirrored.linear().col(0) *= -1.0;
  scaled.linear() *= 1.01;
  expect_invalid([&] { solver.solve(nan); }, {"T_base_tip", "NaN"});
  for (const Eigen::Isometry3d& bad : {sheared, mirrored, scaled})
    expect_invalid([&] { solver.solve(bad); }, {"T_base_tip", "rigid"});
  expect_invalid([&] { solver.solve(good, Eigen::VectorXd::Zero(5)); }, {"q0", "5", "6"});
  expect_invalid([&] { solver.solve(good, Eigen::VectorXd::Constant(6, kNan)); }, {"q0", "NaN"});
  expect_invalid([&] { solver.set_obstacles(ObstacleMatrix::Zero(4, 2)); }, {"(4, 2)"});
  expect_invalid([&] { solver.set_obstacles(ObstacleMatrix::Zero(1, 5)); }, {"(1, 5)"});
  ObstacleMatrix points = ObstacleMatrix::Zero(3, 4);
  points(2, 3) = -0.1;
  expect_invalid([&] { solver.set_obstacles(points); }, {"negative", "row 2"});
  points(1, 0) = kInfinity;
  expect_invalid([&] { solver.set_obstacles(points); }, {"infinity", "row 1"});
  const std::vector<Eigen::Isometry3d> targets{good, nan};
  const std::vector<Eigen::VectorXd> starts(3, Eigen::VectorXd::Zero(6));
  expect_invalid([&] { (void)solver.solve_batch(targets); }, {"NaN"});
  expect_invalid([&] { (void)solver.solve_batch({targets.data(), 1}, starts); }, {"q0", "3"});
  expect_invalid([&] { (void)solver.solve_batch({targets.data(), 1}, {}, -1); }, {"threads", "-1"});
  EXPECT_TRUE(solver.solve(good).success);
}

TEST(SolverMisuse, a_target_off_rigid_by_less_than_its_tolerance_is_solved_to_it) {
  const Robot robot = Robot::builtin("ur10");
  Eigen::Isometry3d target = robot.fk(Eigen::VectorXd::Constant(6, 0.5));
  target.linear()(0, 1) += 4e-7;
  EXPECT_TRUE(Solver(robot, timeless()).solve(target).success);
}

/// Values so large that a follower's angle overflows: no pose, so no success.
TEST(SolverMisuse, a_configuration_without_a_pose_is_never_a_success) {
  RobotDescription description;
  description.links = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
  JointDescription follower = joint_between("b", "c", "follow", JointType::Continuous);
  follower.mimic = Mimic{"turn", 3.0, 0.0};
  follower.T_parent_child.translation().x() = 0.3;
  description.joints = {joint_between("a", "b", "turn", JointType::Continuous), follower};
  const Robot robot(description);
  const Eigen::VectorXd huge = Eigen::VectorXd::Constant(1, 1e308);
  Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
  target.translation().z() = 1.0;  // not on the plane that the tip moves in
  for (const GoalType goal : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
    for (const Method method : {Method::Default, Method::Paper}) {
      Solver solver(robot, timeless(goal, method));
      Result result;
      solver.judge(target, huge, result);
      EXPECT_FALSE(result.success);
      EXPECT_FALSE(solver.solve(target, huge).success);
    }
  }
}

TEST(SolverMisuse,
     obstacles_as_large_or_as_small_as_it_takes_do_no_harm_and_larger_ones_are_refused) {
  const Robot robot = with_hulls(Robot::builtin("iiwa14"));
  ObstacleMatrix far(6, 4);
  far << 1e6, 0, 0, 0, 0, -1e6, 0, 1e-300, 1e5, 1e5, 1e5, 0, 1e3, 0, 0, 1, 0, 30, 0, 0, 5, 5, 5,
      1e-320;
  for (const Method method : {Method::Default, Method::Paper}) {
    Solver solver(robot, timeless(GoalType::Pose, method));
    const Eigen::Isometry3d target = robot.fk(Eigen::VectorXd::Constant(7, 0.2));
    const Result alone = solver.solve(target);
    solver.set_obstacles(far);
    const Result result = solver.solve(target);
    EXPECT_EQ(result.q, alone.q);
    EXPECT_NEAR(result.clearance, brute_force_clearance(robot, result.q, far, 100), 1e-9);
    Eigen::Isometry3d distant = target;
    distant.translation().x() = 1e200;
    EXPECT_FALSE(solver.solve(distant).success);
    ObstacleMatrix everything(1, 4);
    everything << 0.0, 0.0, 0.0, 1e5;  // a ball that holds the robot
    solver.set_obstacles(everything);
    EXPECT_EQ(solver.solve(target).status, Status::BaseCollision);
    for (const double beyond : {1.1e6, 1e30, 1e300}) {
      ObstacleMatrix points = far;
      points(3, 1) = beyond;
      expect_invalid([&] { solver.set_obstacles(points); }, {"row 3"});
    }
  }
}

/// What nobody keeps off must not be taken for what is kept off.
TEST(SolverMisuse, a_robot_without_hulls_is_refused_among_obstacles_of_every_kind) {
  Robot robot = Robot::builtin("panda");
  robot.set_occupancy({});
  const std::string hand = robot.link_names().back();
  const Eigen::VectorXd q = robot.mid_configuration();
  const Eigen::Isometry3d T = robot.fk(q);
  const std::vector<Eigen::Isometry3d> targets(3, T);
  ObstacleMatrix point(1, 3);
  point << 0.4, 0.0, 0.5;
  const Eigen::AlignedBox3d there(Eigen::Vector3d(0.3, -0.1, 0.4), Eigen::Vector3d(0.5, 0.1, 0.6));
  const Shapes shapes({Shape::sphere("ball", {0.4, 0.0, 0.5}, 0.1)});
  const std::vector<Shape> box = {
      Shape::box("box", Eigen::Isometry3d::Identity(), {0.1, 0.1, 0.1})};
  Cloud cloud;

  using Fill = std::function<void(Solver&)>;
  const std::vector<std::pair<std::string, Fill>> scenes = {
      {"1 points", [&](Solver& s) { s.set_obstacles(point); }},
      {"1 points", [&](Solver& s) { s.set_obstacles(cloud); }},
      {"1 shapes", [&](Solver& s) { s.set_shapes(shapes); }},
      {"1 attached things", [&](Solver& s) { s.attach(hand, box); }},
  };
  const std::vector<std::string> words = {"panda", "no hulls", "pdoik occupancy",
                                          "ignore_obstacles_without_hulls"};
  for (const Method method : {Method::Default, Method::Paper}) {
    for (const auto& [what, fill] : scenes) {
      SCOPED_TRACE(what);
      cloud = Cloud();
      Options options = timeless(GoalType::Pose, method);
      Solver solver(robot, options);
      EXPECT_TRUE(solver.solve(T, q).success);  // among nothing
      fill(solver);
      cloud.update(Obstacles(point), there);  // a cloud may be filled later
      std::vector<std::string> all = words;
      all.push_back(what);
      Result result;
      expect_invalid([&] { solver.solve(T, q); }, all);
      expect_invalid([&] { solver.solve_batch(targets); }, all);
      expect_invalid([&] { Solver(solver).solve(T, q); }, all);
      expect_invalid([&] { solver.judge(T, q, result); }, all);
      expect_invalid([&] { solver.clearances(q); }, all);
      solver.clear_obstacles();
      solver.detach();
      EXPECT_TRUE(solver.solve(T, q).success);
      EXPECT_EQ(solver.solve_batch(targets).size(), 3U);

      options.ignore_obstacles_without_hulls = true;
      Solver told(robot, options);
      fill(told);
      EXPECT_TRUE(told.solve(T, q).success);
    }
  }
  expect_invalid(
      [&] {
        Lagrangian lagrangian(robot);
        lagrangian.set_obstacles(point);
      },
      words);
}

TEST(SolverMisuse, a_tracker_of_a_robot_without_hulls_holds_its_answer_among_obstacles) {
  Robot robot = Robot::builtin("panda");
  robot.set_occupancy({});
  const Eigen::VectorXd q = robot.mid_configuration();
  const Eigen::Isometry3d T = robot.fk(q + Eigen::VectorXd::Constant(q.size(), 1e-3));
  ObstacleMatrix point(1, 3);
  point << 0.4, 0.0, 0.5;
  Tracker tracker(robot, timeless(), {.max_time = 10.0});
  tracker.reset(q);
  EXPECT_EQ(tracker.step(T).tracking, TrackerStatus::Tracking);
  tracker.reset(q);
  const Eigen::AlignedBox3d there(Eigen::Vector3d(0.3, -0.1, 0.4), Eigen::Vector3d(0.5, 0.1, 0.6));
  Cloud cloud;
  tracker.set_obstacles(cloud);
  EXPECT_EQ(tracker.step(robot.fk(q)).tracking, TrackerStatus::Tracking);
  cloud.update(Obstacles(point), there);
  const TrackerResult& held = tracker.step(T);
  EXPECT_EQ(held.tracking, TrackerStatus::InvalidInput);
  EXPECT_FALSE(held.success);
  EXPECT_NE(std::string(held.complaint).find("no hulls"), std::string::npos) << held.complaint;
  EXPECT_TRUE(held.q.isApprox(q, 1e-9));
  cloud.remove(there);
  EXPECT_EQ(tracker.step(T).tracking, TrackerStatus::Tracking);
  EXPECT_STREQ(tracker.step(T).complaint, "");
  tracker.set_shapes(Shapes({Shape::sphere("ball", {0.4, 0.0, 0.5}, 0.1)}));
  EXPECT_EQ(tracker.step(T).tracking, TrackerStatus::InvalidInput);

  Options told = timeless();
  told.ignore_obstacles_without_hulls = true;
  Tracker ignoring(robot, told, {.max_time = 10.0});
  ignoring.reset(q);
  EXPECT_TRUE(ignoring.set_obstacles(point));
  EXPECT_EQ(ignoring.step(T).tracking, TrackerStatus::Tracking);
}

/// A hull on any link is what the robot has been given to keep off obstacles with.
TEST(SolverMisuse, a_robot_with_hulls_on_some_links_is_taken_among_obstacles) {
  Robot robot = Robot::builtin("panda");
  Occupancy one;
  one.spheres.push_back({robot.link_names()[4], Eigen::Vector3d::Zero(), 0.05});
  robot.set_occupancy(one);
  Solver solver(robot, timeless());
  ObstacleMatrix point(1, 3);
  point << 2.0, 0.0, 0.5;
  solver.set_obstacles(point);
  EXPECT_TRUE(solver.solve(robot.fk(robot.mid_configuration())).success);
}

}  // namespace
}  // namespace pdoik
