#include <gtest/gtest.h>

#include "finite_differences.hpp"
#include "tree_bench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr int kSeeds = 60;
constexpr double kStep = 1e-6;

struct Case {
  std::unique_ptr<Workbench> bench;
  Eigen::VectorXd q;
};

Case random_case(int seed, bool slack) {
  Random random(static_cast<std::uint64_t>(seed));
  const Robot robot = random_tree(random, 1 + seed % 3);
  Options options;
  options.rotation_weight = random.uniform(0.1, 1.0);
  options.collision_weight = random.uniform(0.3, 3.0);
  Case c;
  c.q = random_configuration(robot, random, 0.05);
  if (seed % 2 == 0) options.balance = random_balance(robot, c.q, random, seed % 4 == 0);
  options.self_collision = seed % 3 != 0;
  options.self_clearance = random.uniform(0.0, 0.1);
  c.bench = std::make_unique<Workbench>(robot, options);
  c.bench->set_obstacles(random_obstacles(random, 15, 0.8));
  const std::vector<Goal> goals = random_goals(robot, random, slack);
  c.bench->problem.set_goals(seed % 3 == 0 ? goals : one_after_the_other(goals));
  return c;
}

/// Kinks (a constraint about to act, a slack about to end, the polygon's corners about to change)
/// are where two difference quotients disagree.
template <class Function>
bool is_smooth(Function&& f, const Eigen::VectorXd& x) {
  const Eigen::VectorXd coarse = central_gradient(f, x, 4.0 * kStep),
                        fine = central_gradient(f, x, kStep);
  return (coarse - fine).norm() < 1e-5 * (1.0 + fine.norm());
}

TEST(TreeGradients, the_least_squares_gradient_is_the_central_difference_whatever_is_asked) {
  int checked = 0, balanced = 0, touching = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Case c = random_case(seed, seed % 5 < 3);
    LeastSquaresProblem& problem = c.bench->least_squares;
    const Eigen::Index n = c.q.size();
    Random random(static_cast<std::uint64_t>(1000 + seed));
    const Eigen::VectorXd posture = random_configuration(c.bench->robot, random),
                          pull = random.vector(n, 0.0, 0.3);
    if (seed % 2 == 1) problem.posture.set(&posture, &pull);
    const auto f = [&](const Eigen::VectorXd& q) { return problem.evaluate(q); };
    if (!is_smooth(f, c.q)) continue;
    Eigen::MatrixXd H(n, n);
    Eigen::VectorXd g(n);
    problem.evaluate(c.q);
    problem.linearise(H, g);
    const Eigen::VectorXd expected = central_gradient(f, c.q, kStep);
    EXPECT_LT((g - expected).norm(), 3e-6 * (1.0 + expected.norm()));
    ++checked;
    balanced += c.bench->problem.constraints.balance.count();
    touching += c.bench->problem.constraints.self.count();
  }
  EXPECT_GT(checked, kSeeds * 3 / 4);
  EXPECT_GT(balanced, 30);
  EXPECT_GT(touching, 30);
}

TEST(TreeGradients, the_augmented_lagrangian_gradient_is_the_central_difference_with_multipliers) {
  int checked = 0, multiplied = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    for (const PenaltyForm form : {PenaltyForm::Smooth, PenaltyForm::Printed}) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Case c = random_case(seed, false);
      LagrangianProblem& problem = c.bench->lagrangian;
      Random random(static_cast<std::uint64_t>(1000 + seed));
      const Penalty penalty{form, random.uniform(0.5, 20.0)};
      const Eigen::VectorXd omega = random.vector(c.bench->map.size(), -2.0, 2.0);
      problem.reset_multipliers();
      problem.update_multipliers(omega, penalty);
      problem.update_multipliers(omega, penalty);
      c.bench->problem.constraints.for_each([&](const auto& family, std::size_t number) {
        if (number == 0) return;  // obstacles have tests of their own
        for (int k = 0; k < family.count(); ++k) multiplied += family.at(k).c > 0.0 ? 1 : 0;
      });
      Eigen::VectorXd gradient(omega.size()), unused(omega.size());
      const auto f = [&](const Eigen::VectorXd& x) {
        return problem.lagrangian(x, penalty, unused);
      };
      if (!is_smooth(f, omega)) continue;
      problem.lagrangian(omega, penalty, gradient);
      const Eigen::VectorXd expected = central_gradient(f, omega, kStep);
      EXPECT_LT((gradient - expected).norm(), 1e-5 * (1.0 + expected.norm()));
      ++checked;
    }
  }
  EXPECT_GT(checked, kSeeds * 3 / 2);
  EXPECT_GT(multiplied, 30);
}

TEST(TreeGradients, the_lagrangian_counts_balance_and_touching_hulls_in_its_largest_constraint) {
  for (int seed = 2; seed <= 20; seed += 2) {
    Case c = random_case(seed, false);
    c.bench->set_obstacles(ObstacleMatrix(0, 3));
    const Eigen::VectorXd omega = Eigen::VectorXd::Zero(c.bench->map.size());
    const Eigen::VectorXd q = c.bench->positions(omega);
    const BalanceOptions& balance = c.bench->options.balance;
    const Eigen::Vector3d com = c.bench->robot.center_of_mass(q);
    const double beyond_box =
        std::max((balance.com_lower - com).maxCoeff(), (com - balance.com_upper).maxCoeff());
    EXPECT_GE(c.bench->lagrangian.max_constraint(omega), beyond_box - 1e-12);
    EXPECT_GT(beyond_box, 0.0) << "the middle of the ranges is off the box, most often";
  }
}

}  // namespace
}  // namespace pdoik::detail
