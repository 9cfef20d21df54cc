#include <gtest/gtest.h>

#include <array>
#include <map>

#include "arms.hpp"
#include "binomial.hpp"
#include "pdoik/solver.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr int kTargets = kSanitized ? 15 : 200;

/// Everything a result says, against forward kinematics, limits and brute force.
void expect_honest(const Robot& robot, const Options& options, const Problem& problem,
                   const Result& result) {
  ASSERT_EQ(result.q.size(), robot.dof());
  ASSERT_TRUE(result.q.allFinite());
  const double position = position_error(robot, result.q, problem.target);
  const double rotation = rotation_error(robot, result.q, problem.target, options);
  const double outside = std::max(
      0.0, std::max((robot.lower() - result.q).maxCoeff(), (result.q - robot.upper()).maxCoeff()));
  const double clearance = brute_force_clearance(robot, result.q, problem.obstacles, 100);
  ASSERT_NEAR(result.position_error, position, 1e-10);
  ASSERT_NEAR(result.rotation_error, rotation, 1e-7);
  ASSERT_NEAR(result.limit_violation, outside, 1e-15);
  if (problem.obstacles.rows() > 0) {
    ASSERT_NEAR(result.clearance, clearance, 1e-9);
  } else {
    ASSERT_EQ(result.clearance, std::numeric_limits<double>::infinity());
  }
  ASSERT_EQ(outside, 0.0) << "limits hold whatever the outcome";
  const bool success = position <= options.position_tolerance &&
                       rotation <= options.rotation_tolerance &&
                       clearance >= options.clearance - options.clearance_tolerance;
  ASSERT_EQ(result.success, success)
      << position << " m, " << rotation << " rad, clear by " << clearance << " m";
  ASSERT_EQ(result.status == Status::Solved, result.success);
  ASSERT_EQ(result.worst.violation <= 0.0, result.success);
}

struct Setting {
  const char* name;
  Method method;
  InnerMethod inner;
};

class EveryArm : public ::testing::TestWithParam<std::tuple<std::string, GoalType, Setting>> {};

const Setting kSettings[] = {
    {"default", Method::Default, InnerMethod::LevenbergMarquardt},
    {"default_lbfgs", Method::Default, InnerMethod::Lbfgs},
    {"paper", Method::Paper, InnerMethod::Lbfgs},
};

/// Measured shares of the 200 targets solved without and among obstacles. With restarts all 7,200
/// were; 0.999 is what that leaves certain. The paper's single start has its own share per arm and
/// goal.
double measured_share(const std::string& arm, GoalType goal, const Setting& setting, bool among) {
  if (setting.method == Method::Default) return 0.999;
  using Shares = std::array<std::array<double, 2>, 3>;  // pose, axis, position
  static const std::map<std::string, Shares> paper{
      {"panda", {{{0.450, 0.485}, {0.740, 0.740}, {0.920, 0.920}}}},
      {"ur10", {{{0.735, 0.625}, {0.845, 0.810}, {0.920, 0.910}}}},
      {"iiwa14", {{{0.775, 0.755}, {0.845, 0.890}, {0.925, 0.975}}}},
  };
  return paper.at(arm)[static_cast<std::size_t>(goal)][among ? 1 : 0];
}

TEST_P(EveryArm, confirms_every_success_by_fk_and_brute_force_without_and_among_obstacles) {
  const auto& [arm, goal, setting] = GetParam();
  const Robot robot = with_hulls(Robot::builtin(arm));
  Options options = timeless(goal, setting.method, setting.inner);
  options.goal_axis = Eigen::Vector3d(0.0, 0.6, 0.8);
  options.max_restarts = 30;
  for (const int obstacles : {0, 25}) {
    Random random(obstacles == 0 ? 100 : 200);
    Solver solver(robot, options);
    Result result;
    int solved = 0;
    for (int k = 0; k < kTargets; ++k) {
      SCOPED_TRACE("target " + std::to_string(k) + " among " + std::to_string(obstacles) +
                   " obstacles");
      const Problem problem = solvable_problem(robot, random, obstacles, k % 2 == 0 ? 0.05 : 0.0);
      const Eigen::VectorXd q0 = random_configuration(robot, random);
      solver.set_obstacles(problem.obstacles);
      solver.solve(problem.target, k % 3 == 0 ? nullptr : &q0, result);
      ASSERT_NO_FATAL_FAILURE(expect_honest(robot, options, problem, result));
      solved += result.success;
    }
    RecordProperty("solved_among_" + std::to_string(obstacles), solved);
    const double share = measured_share(arm, goal, setting, obstacles > 0);
    EXPECT_GE(solved, fewest_by_luck(kTargets, share)) << share << " was measured";
  }
}

INSTANTIATE_TEST_SUITE_P(Solver, EveryArm,
                         ::testing::Combine(::testing::ValuesIn(arm_names()),
                                            ::testing::Values(GoalType::Pose, GoalType::Axis,
                                                              GoalType::Position),
                                            ::testing::ValuesIn(kSettings)),
                         [](const auto& test) {
                           return std::get<0>(test.param) + "_" + name_of(std::get<1>(test.param)) +
                                  "_" + std::get<2>(test.param).name;
                         });

TEST(Solver, random_robots_with_followers_slides_and_turns_without_limits_get_honest_answers) {
  int solved = 0, tried = 0;
  for (int seed = 1; seed <= (kSanitized ? 20 : 80); ++seed) {
    for (const Setting& setting : kSettings) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", " + setting.name);
      Random random(static_cast<std::uint64_t>(seed));
      Robot robot = random_robot(random, {.joints = 9,
                                          .branches = seed % 2 == 0,
                                          .fixed = 0.1,
                                          .prismatic = 0.25,
                                          .continuous = 0.2,
                                          .mimic = 0.25});
      if (robot.body_of_link(robot.tips().front()) == 0) continue;  // the tip is bolted to the base
      robot.set_occupancy(random_occupancy(robot, random, 2, 3));
      Options options = timeless(static_cast<GoalType>(seed % 3), setting.method, setting.inner);
      options.max_restarts = 20;
      const int count = seed % 4 == 0 ? 0 : 10;
      Problem problem;
      problem.q = random_configuration(robot, random);
      problem.target = robot.fk(problem.q);
      problem.obstacles = random_obstacles(random, count, 1.5, seed % 3 == 0 ? 0.05 : 0.0);
      Solver solver(robot, options);
      solver.set_obstacles(problem.obstacles);
      const Result result = solver.solve(problem.target);
      ASSERT_NO_FATAL_FAILURE(expect_honest(robot, options, problem, result));
      solved += result.success;
      ++tried;
    }
  }
  EXPECT_GE(solved, fewest_by_luck(tried, 210.0 / 231.0)) << "of " << tried;
}

TEST(Solver, keeps_the_clearance_asked_for) {
  const Robot robot = with_hulls(Robot::builtin("iiwa14"));
  for (const double clearance : {0.0, 0.01, 0.03}) {
    Options options = timeless(GoalType::Axis);
    options.clearance = clearance;
    Random random(9);
    int solved = 0;
    for (int k = 0; k < 30; ++k) {
      SCOPED_TRACE("clearance " + std::to_string(clearance) + ", target " + std::to_string(k));
      const Problem problem = solvable_problem(robot, random, 20, k % 2 == 0 ? 0.03 : 0.0, 0.04);
      Solver solver(robot, options);
      solver.set_obstacles(problem.obstacles);
      const Result result = solver.solve(problem.target);
      ASSERT_NO_FATAL_FAILURE(expect_honest(robot, options, problem, result));
      solved += result.success;
    }
    EXPECT_GE(solved, fewest_by_luck(30, 0.999));
  }
}

}  // namespace
}  // namespace pdoik
