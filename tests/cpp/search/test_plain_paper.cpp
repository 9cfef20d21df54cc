#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>

#include "binomial.hpp"
#include "brute_force.hpp"
#include "finite_differences.hpp"
#include "plain_paper.hpp"
#include "random_robots.hpp"
#include "sub_angles.hpp"
#include "workbench.hpp"

/// PlainPaper is the second implementation that the library's evaluation is compared with,
/// in time by bench/ik/compare/__main__.py and in value here.
namespace pdoik::testing {
namespace {

constexpr PenaltyForm kPrinted = PenaltyForm::Printed;

/// A random serial arm with limits and hulls among points, evaluated by both.
struct Scenario {
  Scenario(int seed, GoalType goal) : random(static_cast<std::uint64_t>(seed)) {
    Robot robot = random_robot(random, kSerial);
    robot.set_occupancy(random_occupancy(robot, random, 4, 6));
    Options options;
    options.goal = goal;
    options.goal_axis = random.direction();
    options.clearance = random.chance(0.5) ? 0.0 : 0.02;
    workbench = std::make_unique<Workbench>(robot, options);
    plain = std::make_unique<PlainProblem>(robot, options);
    const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
    const ObstacleMatrix points = random_obstacles(random, 30, 0.8);
    workbench->set_target(target);
    workbench->set_obstacles(points);
    plain->set_target(target);
    plain->set_obstacles(points);
    y = random.vector(workbench->map.size(), -3.0, 3.0);
    omega = spread(workbench->map, y);
  }

  Random random;
  std::unique_ptr<Workbench> workbench;
  std::unique_ptr<PlainProblem> plain;
  Eigen::VectorXd y, omega;  ///< the library's variables and the paper's, of the same positions
};

class PlainPaperOfGoal : public ::testing::TestWithParam<GoalType> {};
INSTANTIATE_TEST_SUITE_P(Goals, PlainPaperOfGoal,
                         ::testing::Values(GoalType::Pose, GoalType::Axis, GoalType::Position));

TEST_P(PlainPaperOfGoal, GradientIsTheCentralDifference) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Scenario s(seed, GetParam());
    const Penalty penalty{kPrinted, 3.0};
    s.plain->update_multipliers(s.omega, penalty);
    s.omega += s.random.vector(s.plain->size(), -0.1, 0.1);
    Eigen::VectorXd gradient(s.plain->size()), unused(s.plain->size());
    s.plain->lagrangian(s.omega, penalty, gradient);
    const auto value = [&](const Eigen::VectorXd& at) {
      return s.plain->lagrangian(at, penalty, unused);
    };
    const double scale = std::max(1.0, gradient.cwiseAbs().maxCoeff());
    EXPECT_LT((gradient - central_gradient(value, s.omega, 1e-6)).cwiseAbs().maxCoeff(),
              1e-6 * scale);
  }
}

TEST_P(PlainPaperOfGoal, ValueAndGradientAreThoseOfTheLibrary) {
  int touching = 0;
  for (int seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Scenario s(seed, GetParam());
    detail::LagrangianProblem& library = s.workbench->lagrangian;
    for (double rho = 1.0; rho < 500.0; rho *= 10.0) {  // multipliers grow on the way
      const Penalty penalty{kPrinted, rho};
      Eigen::VectorXd gradient(s.plain->size()), expected(s.y.size());
      const double value = s.plain->lagrangian(s.omega, penalty, gradient);
      EXPECT_NEAR(value, library.lagrangian(s.y, penalty, expected), 1e-9 * (1.0 + value));
      EXPECT_LT((gathered(s.workbench->map, gradient) - expected).norm(),
                1e-9 * (1.0 + expected.norm()));
      touching += library.last_max_constraint() > 0.0;
      s.plain->update_multipliers(s.omega, penalty);
      library.update_multipliers(s.y, penalty);
      s.y += s.random.vector(s.y.size(), -0.3, 0.3);
      s.omega = spread(s.workbench->map, s.y);
    }
    Eigen::VectorXd q(s.workbench->robot.dof());
    s.plain->recover(s.omega, q);
    EXPECT_LT((q - s.workbench->positions(s.y)).cwiseAbs().maxCoeff(), 1e-9);
  }
  EXPECT_GT(touching, 100);
}

/// Points of which each leaves the configuration clear.
ObstacleMatrix points_clear_of(const Eigen::VectorXd& q, Solver& solver, Random& random,
                               int count) {
  ObstacleMatrix points(count, 3);
  Result result;
  for (int i = 0; i < count;) {
    points.row(i) = random.point(0.8).transpose();
    solver.set_obstacles(points.middleRows(i, 1));
    solver.judge(solver.robot().fk(q), q, result);
    if (result.clearance > 0.0) ++i;
  }
  return points;
}

/// Solves of Method::Paper and of PlainPaper, side by side.
struct Comparison {
  int compared = 0, equal = 0, same_iterations = 0, solved = 0, plain_solved = 0;
};

Comparison compare_answers(Options options, int obstacles) {
  options.method = Method::Paper;
  options.max_time = 10.0;
  Comparison counts;
  for (const char* name : {"panda", "ur10", "iiwa14"}) {
    const Robot robot = without_capsules(Robot::builtin(name));
    Random random(7);
    Solver solver(robot, options);
    PlainPaper plain(robot, options);
    Result result, answer;
    answer.q.setZero(robot.dof());
    for (int k = 0; k < 60; ++k) {
      const Eigen::VectorXd goal = random_configuration(robot, random);
      const Eigen::VectorXd q0 = random_configuration(robot, random);
      const Eigen::Isometry3d target = robot.fk(goal);
      const ObstacleMatrix points = points_clear_of(goal, solver, random, obstacles);
      const Eigen::VectorXd* start = k % 3 == 0 ? nullptr : &q0;
      solver.set_obstacles(points);
      plain.set_obstacles(points);
      solver.solve(target, start, result);
      plain.solve(target, start, answer);
      ++counts.compared;
      counts.equal += (result.q - answer.q).cwiseAbs().maxCoeff() < 1e-6;
      counts.same_iterations +=
          result.iterations == answer.iterations && result.evaluations == answer.evaluations;
      counts.solved += result.success;
      solver.judge(target, answer.q, answer);
      counts.plain_solved += answer.success;
    }
  }
  return counts;
}

// The two differ in rounding alone, which L-BFGS makes ten times larger every four iterations or
// so, and faster at the kinks of the printed penalty. So answers are compared while that is still
// small, ...
TEST(PlainPaper, FirstStepsAreThoseOfMethodPaper) {
  Options options;
  options.augmented_lagrangian.max_outer_iterations = 1;
  options.lbfgs.max_iterations = 20;
  const Comparison free = compare_answers(options, 0);
  EXPECT_EQ(free.equal, free.compared);
  EXPECT_EQ(free.same_iterations, free.compared);
  options.lbfgs.max_iterations = 2;
  const Comparison among_points = compare_answers(options, 40);
  EXPECT_EQ(among_points.equal, among_points.compared);
  EXPECT_EQ(among_points.same_iterations, among_points.compared);
}

// ... and for whole solves most of them are still the same, and so is the number solved, within
// what chance allows.
TEST(PlainPaper, AnswersAreThoseOfMethodPaper) {
  Options options;
  options.position_tolerance = options.rotation_tolerance = 1e-3;
  const Comparison free = compare_answers(options, 0);
  EXPECT_GE(free.equal, fewest_by_luck(free.compared, 0.91));
  EXPECT_NEAR(free.solved, free.plain_solved, 0.03 * free.compared);
  EXPECT_GE(free.solved, fewest_by_luck(free.compared, 0.66));
  options.clearance_tolerance = options.augmented_lagrangian.constraint_tolerance = 1e-3;
  const Comparison among_points = compare_answers(options, 40);
  EXPECT_GE(among_points.equal, fewest_by_luck(among_points.compared, 0.93));
  EXPECT_NEAR(among_points.solved, among_points.plain_solved, 0.03 * among_points.compared);
  EXPECT_GE(among_points.solved, fewest_by_luck(among_points.compared, 0.63));
}

TEST(PlainPaper, RefusesWhatIsNoSerialChainOfRevoluteJoints) {
  const Robot slides = Robot::from_dh(
      {{.lower = -1.0, .upper = 1.0}, {.lower = 0.0, .upper = 0.5, .prismatic = true}});
  EXPECT_THROW(PlainProblem(slides, {}), std::invalid_argument);
  const Robot endless = Robot::from_dh({{.a = 0.1}, {.a = 0.2, .lower = -1.0, .upper = 1.0}});
  EXPECT_THROW(PlainProblem(endless, {}), std::invalid_argument);
}

}  // namespace
}  // namespace pdoik::testing
