#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "common/quadratic_program.hpp"

namespace pdoik::detail {
namespace {

struct Drawn {
  Eigen::MatrixXd H, rows;
  Eigen::VectorXd g, most, lower, upper;
};

/// One whose inequalities leave room about a point inside the box.
Drawn drawn(std::mt19937& random, int n, int count) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto matrix = [&](int rows, int columns) {
    return Eigen::MatrixXd(
        Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); }));
  };
  Drawn result;
  const Eigen::MatrixXd J = matrix(std::max(1, n / 2), n);
  result.H = J.transpose() * J + 1e-4 * Eigen::MatrixXd::Identity(n, n);
  result.g = 3.0 * matrix(n, 1);
  result.rows = matrix(n, std::max(count, 1));
  const Eigen::VectorXd inside = 0.1 * matrix(n, 1);
  result.most = result.rows.transpose() * inside;
  for (int i = 0; i < count; ++i) result.most[i] += 0.2 * uniform(random) * (i % 3 > 0);
  result.lower = inside.array() - 0.5 * uniform(random);
  result.upper = inside.array() + 0.5 * uniform(random);
  return result;
}

/// By how much the conditions of Karush, Kuhn and Tucker, which one point of a strictly convex
/// program alone meets, are missed: with the multipliers that fit best.
double missed(const Drawn& p, int count, const Eigen::VectorXd& x) {
  const auto n = static_cast<int>(x.size());
  Eigen::MatrixXd all(n, count + 2 * n);
  Eigen::VectorXd slack(count + 2 * n);
  all << p.rows.leftCols(count), -Eigen::MatrixXd::Identity(n, n), Eigen::MatrixXd::Identity(n, n);
  slack << p.most.head(count) - p.rows.leftCols(count).transpose() * x, x - p.lower, p.upper - x;
  double worst = std::max(0.0, -slack.minCoeff());
  // Multipliers of what is active, at least 0: projected gradients, which are slow and simple.
  std::vector<int> active;
  for (int i = 0; i < slack.size(); ++i)
    if (slack[i] < 1e-8) active.push_back(i);
  const Eigen::VectorXd gradient = p.H * x + p.g;
  if (active.empty()) return std::max(worst, gradient.norm());
  const Eigen::MatrixXd normals = all(Eigen::all, active);
  const Eigen::MatrixXd gram = normals.transpose() * normals;
  const double step = 1.0 / gram.trace();
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(gram.rows());
  for (int k = 0; k < 200000; ++k)
    pull = (pull - step * (gram * pull + normals.transpose() * gradient)).cwiseMax(0.0);
  return std::max(worst, (gradient + normals * pull).norm() / std::max(1.0, gradient.norm()));
}

TEST(QuadraticProgram, its_minimum_meets_the_conditions_that_only_the_minimum_meets) {
  std::mt19937 random(1);
  int held = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 1 + trial % 9, count = trial % 4 * n;
    const Drawn p = drawn(random, n, count);
    QuadraticProgram program(n);
    Eigen::VectorXd x(n);
    ASSERT_TRUE(program.factorise(p.H));
    ASSERT_TRUE(program.solve(p.g, {p.rows, p.most, count, p.lower, p.upper}, x)) << trial;
    EXPECT_LT(missed(p, count, x), 1e-5) << trial << " n " << n << " count " << count;
    held += program.held() ? 1 : 0;
  }
  EXPECT_GT(held, 40);
}

TEST(QuadraticProgram, none_is_found_where_inequalities_contradict_one_another) {
  QuadraticProgram program(2);
  const Eigen::MatrixXd H = Eigen::MatrixXd::Identity(2, 2);
  Eigen::MatrixXd rows(2, 2);
  rows << 1.0, -1.0, 0.0, 0.0;
  const Eigen::VectorXd most = Eigen::VectorXd::Constant(2, -1.0), g = Eigen::VectorXd::Zero(2);
  const Eigen::VectorXd box = Eigen::VectorXd::Constant(2, 9.0);
  Eigen::VectorXd x(2);
  ASSERT_TRUE(program.factorise(H));
  EXPECT_FALSE(program.solve(g, {rows, most, 2, -box, box}, x));
}

TEST(QuadraticProgram, what_is_no_number_has_no_minimum) {
  QuadraticProgram program(2);
  const Eigen::MatrixXd H = Eigen::MatrixXd::Identity(2, 2), rows(2, 0);
  const Eigen::VectorXd most(0), box = Eigen::VectorXd::Ones(2), lower = -box;
  Eigen::VectorXd g = box, x(2);
  g[1] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(program.factorise(H));
  EXPECT_FALSE(program.solve(g, {rows, most, 0, lower, box}, x));
}

TEST(QuadraticProgram, rows_that_say_the_same_are_no_trouble) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 20; ++trial) {
    Drawn p = drawn(random, 5, 8);
    Drawn twice = p;
    twice.rows.resize(5, 24);
    twice.rows << p.rows, p.rows, p.rows;
    twice.most.resize(24);
    twice.most << p.most, p.most, p.most;
    QuadraticProgram program(5);
    Eigen::VectorXd once(5), again(5);
    ASSERT_TRUE(program.factorise(p.H));
    ASSERT_TRUE(program.solve(p.g, {p.rows, p.most, 8, p.lower, p.upper}, once));
    ASSERT_TRUE(program.solve(p.g, {twice.rows, twice.most, 24, p.lower, p.upper}, again));
    EXPECT_LT((once - again).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace pdoik::detail
