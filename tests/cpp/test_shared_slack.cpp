#include <gtest/gtest.h>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "workbench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;
using Slack = JointLimitMap::Slack;

/// The slack of every sub-angle that a shared slack stands for.
Eigen::VectorXd spread(const Robot& robot, const Eigen::VectorXd& shared) {
  std::vector<double> all;
  for (int i = 0; i < robot.dof(); ++i) {
    const double range = robot.upper()[i] - robot.lower()[i];
    const bool cut = robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Revolute;
    const int copies = cut ? std::max(1, static_cast<int>(std::ceil(range / M_PI - 1e-9))) : 1;
    for (int k = 0; k < copies; ++k) all.push_back(shared[i] / std::sqrt(copies));
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

TEST(SharedSlack, is_the_papers_slack_with_equal_sub_angles_and_lengths_kept) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, {.joints = 8, .prismatic = 0.2, .continuous = 0.2});
    const JointLimitMap each(robot), shared(robot, Slack::Shared);
    ASSERT_EQ(shared.size(), robot.dof());
    const Eigen::VectorXd y = random.vector(robot.dof(), -6.0, 6.0), omega = spread(robot, y);
    ASSERT_EQ(omega.size(), each.size());
    EXPECT_NEAR(omega.norm(), y.norm(), 1e-12);
    JointLimitMap::State a = each.make_state(), b = shared.make_state();
    each.forward(omega, a, true);
    shared.forward(y, b, true);
    EXPECT_LT((a.q - b.q).lpNorm<Eigen::Infinity>(), 1e-13);
    EXPECT_LT((a.cosine - b.cosine).lpNorm<Eigen::Infinity>(), 1e-13);
    // A gradient in q pulls back to equal lengths too: inner products are kept.
    const Eigen::VectorXd dq = random.vector(robot.dof(), -1.0, 1.0);
    Eigen::VectorXd pulled_each(omega.size()), pulled_shared(y.size());
    each.pull_back(a, dq, pulled_each);
    shared.pull_back(b, dq, pulled_shared);
    EXPECT_NEAR(pulled_each.norm(), pulled_shared.norm(), 1e-12);
    EXPECT_NEAR(pulled_each.dot(omega), pulled_shared.dot(y), 1e-12);
  }
}

TEST(SharedSlack, inverse_then_forward_gives_q_back_and_the_slope_is_the_central_difference) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, {.joints = 8, .prismatic = 0.2, .continuous = 0.2});
    const JointLimitMap map(robot, Slack::Shared);
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
      std::vector<Eigen::VectorXd> ends;
      for (const Slack slack : {Slack::PerSubAngle, Slack::Shared}) {
        Workbench bench(robot, timeless(), slack);
        bench.set_obstacles(problem.obstacles);
        bench.set_target(problem.target);
        LbfgsOptions options = bench.options.lbfgs;
        options.max_iterations = 12;  // before rounding has grown
        Lbfgs lbfgs(bench.map.size(), options);
        Eigen::VectorXd omega(bench.map.size());
        bench.map.inverse(robot.mid_configuration(), omega);
        const Penalty penalty{PenaltyForm::Smooth, 10.0};
        lbfgs.minimize(
            [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
              return bench.lagrangian.lagrangian(at, penalty, gradient);
            },
            omega);
        ends.push_back(bench.positions(omega));
      }
      EXPECT_LT((ends[0] - ends[1]).lpNorm<Eigen::Infinity>(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace pdoik
