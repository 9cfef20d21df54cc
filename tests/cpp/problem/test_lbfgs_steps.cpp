#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "pdoik/lbfgs.hpp"
#include "textbook_functions.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

/// Runs with a record of points accepted, checking that each step satisfies both weak Wolfe
/// conditions.
template <class Function>
int check_wolfe(Function&& f, Eigen::VectorXd x, const LbfgsOptions& options) {
  Eigen::VectorXd previous, g_previous, g(x.size());
  double f_previous = 0.0;
  int steps = 0;
  const auto check = [&](const Eigen::VectorXd& at, double value) {
    f(at, g);
    if (previous.size() > 0) {
      const Eigen::VectorXd step = at - previous;
      const double slope = g_previous.dot(step);
      EXPECT_LT(slope, 0.0);
      EXPECT_LE(value, f_previous + options.armijo * slope + 1e-15 * std::abs(f_previous));
      EXPECT_GE(g.dot(step), options.curvature * slope * (1.0 + 1e-9));
      ++steps;
    }
    previous = at, g_previous = g, f_previous = value;
    return ::testing::Test::HasFailure();
  };
  Lbfgs lbfgs(x.size(), options);
  lbfgs.minimize(f, x, check);
  return steps;
}

TEST(Lbfgs, every_step_taken_satisfies_the_weak_wolfe_conditions) {
  for (const auto& [armijo, curvature] :
       {std::pair(1e-4, 0.9), {1e-4, 0.5}, {0.3, 0.4}, {1e-3, 0.01}}) {
    SCOPED_TRACE("c1 = " + std::to_string(armijo) + ", c2 = " + std::to_string(curvature));
    LbfgsOptions options = thorough();
    options.armijo = armijo, options.curvature = curvature;
    options.gradient_tolerance = 1e-4;  // short of where rounding decides
    EXPECT_GT(check_wolfe(rosenbrock, Eigen::Vector2d(-1.2, 1.0), options), 10);
    Random random(4);
    EXPECT_GT(check_wolfe(Quadratic(random, 10, 1e3), random.vector(10, -1.0, 1.0), options), 10);
    const auto wavy = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {  // not convex
      g = 0.2 * x.array() + 3.0 * (3.0 * x.array()).cos();
      return (0.1 * x.array().square() + (3.0 * x.array()).sin()).sum();
    };
    EXPECT_GT(check_wolfe(wavy, random.vector(6, -4.0, 4.0), options), 3);
  }
}

TEST(Lbfgs, skips_pairs_whose_curvature_is_not_positive_and_goes_on_downhill) {
  // Concave until |x| = 1 / sqrt(3): with two trials a line, searches end short of the curvature
  // condition there.
  const auto hill = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    g = -4.0 * x.array() + 4.0 * x.array().cube();
    return (-2.0 * x.array().square() + x.array().pow(4)).sum();
  };
  LbfgsOptions options = thorough();
  options.first_step = 1e-3;
  options.max_line_search = 2;
  Eigen::VectorXd x = Eigen::Vector3d(0.01, -0.02, 0.015);
  double last = std::numeric_limits<double>::infinity();
  int concave_steps = 0;
  Eigen::VectorXd before = x, g(3), g_before(3);
  hill(before, g_before);
  Lbfgs lbfgs(3, options);
  const LbfgsResult result = lbfgs.minimize(hill, x, [&](const Eigen::VectorXd& at, double f) {
    EXPECT_LE(f, last);
    last = f;
    hill(at, g);
    concave_steps += (at - before).dot(g - g_before) < 0.0;
    before = at, g_before = g;
    return false;
  });
  EXPECT_EQ(result.status, LbfgsStatus::GradientSmall);
  EXPECT_GT(concave_steps, 0);
  EXPECT_LT((x.cwiseAbs() - Eigen::Vector3d::Ones()).norm(), 1e-6);
}

TEST(Lbfgs, survives_functions_that_return_nan_beyond_a_border) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    const auto guarded = [&](const Eigen::VectorXd& x,
                             Eigen::VectorXd& g) {  // minimum at 0.1, defined for x > 0
      if (x[0] <= 0.0) {
        g.setConstant(std::nan(""));
        return bad;
      }
      g = Eigen::VectorXd::Constant(1, 10.0 - 1.0 / x[0]);
      return 10.0 * x[0] - std::log(x[0]);
    };
    LbfgsOptions options = thorough();
    options.first_step = 1e3;
    Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 30.0);
    Lbfgs lbfgs(1, options);
    lbfgs.minimize(guarded, x);
    EXPECT_NEAR(x[0], 0.1, 1e-6);
  }
}

TEST(Lbfgs, started_where_the_function_is_nan_it_ends_at_once_and_leaves_x) {
  const auto nowhere = [](const Eigen::VectorXd&, Eigen::VectorXd& g) {
    g.setConstant(std::nan(""));
    return std::nan("");
  };
  Eigen::VectorXd x = Eigen::Vector2d(1.0, 2.0);
  Lbfgs lbfgs(2);
  const LbfgsResult result = lbfgs.minimize(nowhere, x);
  EXPECT_EQ(result.status, LbfgsStatus::LineSearchFailed);
  EXPECT_LT(result.evaluations, 50);
  EXPECT_EQ(x, Eigen::Vector2d(1.0, 2.0));
}

TEST(Lbfgs, finds_the_kink_of_a_sum_of_absolute_values) {
  const auto kink = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    for (Eigen::Index i = 0; i < x.size(); ++i)
      g[i] = (x[i] > 0.3 ? 1.0 : -1.0) * static_cast<double>(i + 1);
    double f = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i)
      f += static_cast<double>(i + 1) * std::abs(x[i] - 0.3);
    return f;
  };
  for (const int n : {1, 2, 3}) {
    Eigen::VectorXd x(n);
    for (int i = 0; i < n; ++i) x[i] = 2.0 - 1.6 * i;
    LbfgsOptions options;
    options.max_line_search = 60;
    Lbfgs lbfgs(n, options);
    lbfgs.minimize(kink, x);
    EXPECT_LT((x.array() - 0.3).abs().maxCoeff(), n == 1 ? 1e-9 : 1e-3) << n;
  }
}

TEST(Lbfgs, never_ends_higher_than_it_began_and_reports_the_value_at_x) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Eigen::VectorXd x = random.vector(4, -3.0, 3.0), g(4);
    const double before = rosenbrock(x, g);
    LbfgsOptions options;
    options.max_iterations = random.integer(0, 30);
    options.max_line_search = random.integer(1, 20);
    Lbfgs lbfgs(4, options);
    const LbfgsResult result = lbfgs.minimize(rosenbrock, x);
    EXPECT_LE(result.value, before);
    EXPECT_EQ(result.value, rosenbrock(x, g));
    EXPECT_LE(result.iterations, options.max_iterations);
  }
}

TEST(Lbfgs, counts_iterations_and_evaluations_and_honours_their_limits) {
  LbfgsOptions options = thorough();
  for (const int limit : {0, 1, 5}) {
    options.max_iterations = limit;
    int calls = 0;
    const auto counted = [&](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
      ++calls;
      return rosenbrock(x, g);
    };
    Eigen::VectorXd x = Eigen::Vector2d(-1.2, 1.0);
    Lbfgs lbfgs(2, options);
    const LbfgsResult result = lbfgs.minimize(counted, x);
    EXPECT_EQ(result.status, LbfgsStatus::IterationLimit);
    EXPECT_EQ(result.iterations, limit);
    EXPECT_EQ(result.evaluations, calls);
  }
}

TEST(Lbfgs, stops_when_the_caller_says_so_with_the_point_the_caller_saw) {
  for (const int when : {1, 2, 4}) {
    int asked = 0;
    Eigen::VectorXd seen, x = Eigen::Vector2d(-1.2, 1.0);
    Lbfgs lbfgs(2);
    const LbfgsResult result =
        lbfgs.minimize(rosenbrock, x, [&](const Eigen::VectorXd& at, double) {
          seen = at;
          return ++asked == when;
        });
    EXPECT_EQ(result.status, LbfgsStatus::Stopped);
    EXPECT_EQ(asked, when);
    EXPECT_EQ(result.iterations, when - 1);
    EXPECT_EQ(x, seen);
  }
}

TEST(Lbfgs, no_iterations_first_trial_is_longer_than_max_step) {
  LbfgsOptions options = thorough();
  options.max_step = 0.01;
  const auto steep = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    g = Eigen::VectorXd::Constant(2, 100.0) + x;
    return 100.0 * x.sum() + 0.5 * x.squaredNorm();
  };
  Eigen::VectorXd first_trial;
  int calls = 0;
  const auto watched = [&](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    if (++calls == 2) first_trial = x;
    return steep(x, g);
  };
  Eigen::VectorXd x = Eigen::Vector2d::Zero();
  Lbfgs lbfgs(2, options);
  lbfgs.minimize(watched, x);
  EXPECT_NEAR(first_trial.norm(), 0.01, 1e-12);
  EXPECT_NEAR(x[0], -100.0, 1e-6);  // the bracket may still expand
}

TEST(Lbfgs, gives_the_same_run_when_used_again) {
  Lbfgs lbfgs(2);
  Eigen::VectorXd once = Eigen::Vector2d(-1.2, 1.0), again = once;
  const LbfgsResult first = lbfgs.minimize(rosenbrock, once),
                    second = lbfgs.minimize(rosenbrock, again);
  EXPECT_EQ(once, again);
  EXPECT_EQ(first.evaluations, second.evaluations);
}

TEST(Lbfgs, refuses_options_out_of_range) {
  EXPECT_THROW(Lbfgs(0), std::invalid_argument);
  LbfgsOptions options;
  options.memory = 0;
  EXPECT_THROW(Lbfgs(2, options), std::invalid_argument);
  for (const auto& [armijo, curvature] :
       {std::pair(0.0, 0.5), {0.6, 0.5}, {0.1, 1.0}, {0.5, 0.5}}) {
    options = {};
    options.armijo = armijo, options.curvature = curvature;
    EXPECT_THROW(Lbfgs(2, options), std::invalid_argument);
  }
}

}  // namespace
}  // namespace pdoik
