#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pdoik/lbfgs.hpp"
#include "textbook_functions.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

TEST(Lbfgs, solves_quadratics_like_the_linear_system) {
  for (const int n : {1, 2, 7, 24, 60}) {
    for (const double condition : {1.0, 10.0, 1e4}) {
      SCOPED_TRACE(std::to_string(n) + " variables, condition " + std::to_string(condition));
      Random random(static_cast<std::uint64_t>(n));
      const Quadratic f(random, n, condition);
      Eigen::VectorXd x = random.vector(n, -3.0, 3.0);
      Lbfgs lbfgs(n, thorough());
      const LbfgsResult result = lbfgs.minimize(f, x);
      EXPECT_EQ(result.status, LbfgsStatus::GradientSmall);
      EXPECT_LT((x - f.A.ldlt().solve(f.A * f.solution)).norm(), 1e-7);
    }
  }
}

TEST(Lbfgs, crawls_but_arrives_where_the_condition_is_a_hundred_million) {
  Random random(8);
  const Quadratic f(random, 12, 1e8);
  Eigen::VectorXd x = random.vector(12, -1.0, 1.0);
  LbfgsOptions options = thorough();
  options.gradient_tolerance = 1e-5;
  Lbfgs lbfgs(12, options);
  lbfgs.minimize(f, x);
  Eigen::VectorXd g(12);
  EXPECT_LT(f(x, g), 1e-6);  // from about 1e7
}

TEST(Lbfgs, finds_the_end_of_rosenbrocks_valley) {
  for (const int n : {2, 10, 100}) {
    for (const double curvature : {0.5, 0.9}) {
      SCOPED_TRACE(std::to_string(n) + " variables, c2 = " + std::to_string(curvature));
      LbfgsOptions options = thorough();
      options.curvature = curvature;
      Eigen::VectorXd x(n);
      for (int i = 0; i < n; ++i)
        x[i] = (i % 2 == 0 ? -1.2 : 1.0) + 0.003 * i;  // no two pairs alike
      Lbfgs lbfgs(n, options);
      const LbfgsResult result = lbfgs.minimize(rosenbrock, x);
      EXPECT_EQ(result.status, LbfgsStatus::GradientSmall);
      EXPECT_LT((x - Eigen::VectorXd::Ones(n)).lpNorm<Eigen::Infinity>(), 1e-6);
    }
  }
}

/// -H g with dense BFGS's H (Nocedal and Wright, eq. 6.17) from s.y / y.y of the newest pair on.
Eigen::VectorXd dense_direction(
    const std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>>& pairs,
    const Eigen::VectorXd& g) {
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(g.size(), g.size());
  if (pairs.empty()) return -g;
  const auto& [newest_s, newest_y] = pairs.back();
  Eigen::MatrixXd H = I * (newest_s.dot(newest_y) / newest_y.squaredNorm());
  for (const auto& [s, y] : pairs) {
    const double rho = 1.0 / y.dot(s);
    const Eigen::MatrixXd V = I - rho * y * s.transpose();
    H = V.transpose() * H * V + rho * s * s.transpose();
  }
  return -H * g;
}

/// Runs with a memory that forgets nothing and compares the first trial of each iteration with
/// dense BFGS's direction, from pairs of positive curvature only. Returns how many pairs were not
/// positive.
template <class Function>
int expect_dense_directions(Function&& f, Eigen::VectorXd x, LbfgsOptions options) {
  options.memory = 40;
  options.max_iterations = 12;
  std::vector<std::pair<Eigen::VectorXd, Eigen::VectorXd>> pairs;
  Eigen::VectorXd at, g_at, first_trial;
  bool awaiting_trial = false;
  int skipped = 0, compared = 0;
  const auto watched = [&](const Eigen::VectorXd& trial, Eigen::VectorXd& g) {
    if (awaiting_trial) first_trial = trial;
    awaiting_trial = false;
    return f(trial, g);
  };
  const auto accepted = [&](const Eigen::VectorXd& now, double) {
    Eigen::VectorXd g(now.size());
    f(now, g);
    if (at.size() > 0) {
      const Eigen::VectorXd tried = (first_trial - at).normalized(), went = (now - at).normalized();
      EXPECT_LT((tried - dense_direction(pairs, g_at).normalized()).norm(), 1e-7) << compared;
      if ((tried - went).norm() > 1e-6) pairs.clear();  // fell back on the steepest descent
      const Eigen::VectorXd s = now - at, y = g - g_at;
      if (s.dot(y) > 1e-10 * s.norm() * y.norm())
        pairs.emplace_back(s, y);
      else
        ++skipped;
      ++compared;
    }
    at = now, g_at = g, awaiting_trial = true;
    return ::testing::Test::HasFailure();
  };
  Lbfgs lbfgs(x.size(), options);
  lbfgs.minimize(watched, x, accepted);
  EXPECT_GT(compared, 5);
  return skipped;
}

TEST(Lbfgs, with_full_memory_goes_where_dense_bfgs_goes) {
  for (int seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Quadratic f(random, 8, 50.0);
    EXPECT_EQ(expect_dense_directions(f, random.vector(8, -2.0, 2.0), thorough()), 0);
  }
}

TEST(Lbfgs, leaves_pairs_without_positive_curvature_out_of_its_memory) {
  int skipped = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    LbfgsOptions options = thorough();
    options.first_step = 0.05, options.max_step = 0.3;
    options.max_line_search =
        1;  // ends short of the curvature condition where the function is concave
    const auto wavy = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
      g = 0.2 * x.array() + 3.0 * (3.0 * x.array()).cos();
      return (0.1 * x.array().square() + (3.0 * x.array()).sin()).sum();
    };
    skipped += expect_dense_directions(wavy, random.vector(4, -2.0, 2.0), options);
  }
  EXPECT_GT(skipped, 10);
}

}  // namespace
}  // namespace pdoik
