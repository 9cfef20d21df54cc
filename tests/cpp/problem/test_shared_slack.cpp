#include <gtest/gtest.h>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "plain_problem.hpp"
#include "sub_angles.hpp"
#include "workbench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;
TEST(SharedSlack, is_the_papers_slack_with_equal_sub_angles_and_lengths_kept) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, kSerial);
    const JointLimitMap map(robot);
    const PlainProblem plain(robot, Options{});
    ASSERT_EQ(map.size(), robot.dof());
    const Eigen::VectorXd y = random.vector(robot.dof(), -6.0, 6.0), omega = spread(map, y);
    ASSERT_EQ(omega.size(), plain.size());
    EXPECT_NEAR(omega.norm(), y.norm(), 1e-12);
    Eigen::VectorXd q(robot.dof()), recovered(robot.dof());
    map.positions(y, q);
    plain.recover(omega, recovered);
    EXPECT_LT((q - recovered).lpNorm<Eigen::Infinity>(), 1e-12);
  }
}

TEST(SharedSlack, inverse_then_forward_gives_q_back_and_the_slope_is_the_central_difference) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, {.joints = 8, .prismatic = 0.2, .continuous = 0.2});
    const JointLimitMap map(robot);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.02);
    Eigen::VectorXd y(map.size()), back(robot.dof());
    map.inverse(q, y);
    map.positions(y, back);
    EXPECT_LT((back - q).lpNorm<Eigen::Infinity>(), 1e-12);
    JointLimitMap::State state = map.make_state();
    map.forward(y, state, false);
    for (Eigen::Index i = 0; i < y.size(); ++i) {
      const auto joint = [&](const Eigen::VectorXd& at) {
        map.positions(at, back);
        return back[i];
      };
      EXPECT_NEAR(state.slope[i], central_gradient(joint, y, 1e-4)[i], 1e-7);
    }
  }
}

TEST(SharedSlack, lbfgs_takes_the_same_steps_over_it_as_over_the_papers_variables) {
  for (const std::string& arm : arm_names()) {
    for (int seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(arm + ", seed " + std::to_string(seed));
      Random random(static_cast<std::uint64_t>(seed));
      const Robot robot = with_hulls(Robot::builtin(arm));
      const Problem problem = solvable_problem(robot, random, 15);
      Workbench bench(robot, timeless());
      PlainProblem plain(robot, bench.options);
      bench.set_obstacles(problem.obstacles);
      plain.set_obstacles(problem.obstacles);
      bench.set_target(problem.target);
      plain.set_target(problem.target);
      LbfgsOptions options = bench.options.lbfgs;
      options.max_iterations = 12;  // before rounding has grown
      const Penalty penalty{PenaltyForm::Smooth, 10.0};
      Eigen::VectorXd y(bench.map.size()), q(robot.dof());
      bench.map.inverse(robot.mid_configuration(), y);
      Eigen::VectorXd omega = spread(bench.map, y);
      Lbfgs(y.size(), options)
          .minimize(
              [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
                return bench.lagrangian.lagrangian(at, penalty, gradient);
              },
              y);
      Lbfgs(omega.size(), options)
          .minimize(
              [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
                return plain.lagrangian(at, penalty, gradient);
              },
              omega);
      plain.recover(omega, q);
      EXPECT_LT((bench.positions(y) - q).lpNorm<Eigen::Infinity>(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace pdoik
