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

/// Dense BFGS (Nocedal and Wright, eq. 6.17) along the points that L-BFGS visits: with a memory
/// that forgets nothing and the scaling s.y / y.y of the newest pair on the identity, both give the
/// same direction.
TEST(Lbfgs, with_full_memory_goes_where_dense_bfgs_goes) {
  for (int seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const int n = 8;
    const Quadratic f(random, n, 50.0);
    std::vector<Eigen::VectorXd> xs, gs;
    const auto record = [&](const Eigen::VectorXd& x, double) {
      Eigen::VectorXd g(n);
      f(x, g);
      xs.push_back(x), gs.push_back(g);
      return xs.size() > 7;
    };
    LbfgsOptions options = thorough();
    options.memory = 20;
    options.max_step = 1e9;
    Lbfgs lbfgs(n, options);
    Eigen::VectorXd x = random.vector(n, -2.0, 2.0);
    lbfgs.minimize(f, x, record);
    ASSERT_EQ(xs.size(), 8U);
    for (std::size_t k = 1; k + 1 < xs.size(); ++k) {
      const Eigen::VectorXd newest_s = xs[k] - xs[k - 1], newest_y = gs[k] - gs[k - 1];
      Eigen::MatrixXd H =
          Eigen::MatrixXd::Identity(n, n) * (newest_s.dot(newest_y) / newest_y.squaredNorm());
      for (std::size_t i = 1; i <= k; ++i) {
        const Eigen::VectorXd s = xs[i] - xs[i - 1], y = gs[i] - gs[i - 1];
        const double rho = 1.0 / y.dot(s);
        const Eigen::MatrixXd V = Eigen::MatrixXd::Identity(n, n) - rho * y * s.transpose();
        H = V.transpose() * H * V + rho * s * s.transpose();
      }
      const Eigen::VectorXd direction = (-H * gs[k]).normalized(),
                            gone = (xs[k + 1] - xs[k]).normalized();
      EXPECT_LT((direction - gone).norm(), 1e-8) << "iteration " << k;
    }
  }
}

}  // namespace
}  // namespace pdoik
