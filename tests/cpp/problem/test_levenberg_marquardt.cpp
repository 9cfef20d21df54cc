#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <functional>

#include "pdoik/levenberg_marquardt.hpp"
#include "random_robots.hpp"

namespace pdoik {
namespace {

using testing::Random;

/// f = 1/2 |r(x)|^2 with r and its Jacobian given together; done when |r| < tolerance.
struct Residuals {
  std::function<void(const Eigen::VectorXd&, Eigen::VectorXd&, Eigen::MatrixXd&)> fill;
  double tolerance = 1e-10;
  Eigen::VectorXd r{};
  Eigen::MatrixXd J{};
  std::vector<double> values{};
  Eigen::VectorXd largest{}, smallest{};

  double evaluate(const Eigen::VectorXd& x) {
    fill(x, r, J);
    values.push_back(0.5 * r.squaredNorm());
    largest = largest.size() == 0 ? x : Eigen::VectorXd(largest.cwiseMax(x));
    smallest = smallest.size() == 0 ? x : Eigen::VectorXd(smallest.cwiseMin(x));
    return values.back();
  }
  bool done() const { return r.norm() < tolerance; }
  void linearise(Eigen::MatrixXd& H, Eigen::VectorXd& g) const {
    H.setConstant(std::nan(""));  // only the upper triangle may be read
    const Eigen::MatrixXd full = J.transpose() * J;
    H.triangularView<Eigen::Upper>() = full;
    g = J.transpose() * r;
  }
};

const auto never = [] { return false; };
constexpr double kInfinity = std::numeric_limits<double>::infinity();

LevenbergMarquardtResult run(Residuals& problem, Eigen::VectorXd& x,
                             const LevenbergMarquardtOptions& options = {},
                             double lower = -kInfinity, double upper = kInfinity) {
  LevenbergMarquardt lm(x.size(), options);
  return lm.minimize(problem, x, Eigen::VectorXd::Constant(x.size(), lower),
                     Eigen::VectorXd::Constant(x.size(), upper), never);
}

LevenbergMarquardtOptions patient() {
  LevenbergMarquardtOptions options;
  options.max_iterations = 2000;
  options.stall_ratio = 1.0;
  return options;
}

Residuals rosenbrock(double tolerance = 1e-10) {
  return {[](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
            r = Eigen::Vector2d(10.0 * (x[1] - x[0] * x[0]), 1.0 - x[0]);
            J = (Eigen::Matrix2d() << -20.0 * x[0], 10.0, -1.0, 0.0).finished();
          },
          tolerance};
}

Residuals linear(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double tolerance = 1e-10) {
  return {[=](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
            r = A * x - b, J = A;
          },
          tolerance};
}

TEST(LevenbergMarquardt, solves_rosenbrock_as_least_squares) {
  Residuals problem = rosenbrock();
  Eigen::VectorXd x = Eigen::Vector2d(-1.2, 1.0);
  const LevenbergMarquardtResult result = run(problem, x, patient());
  EXPECT_EQ(result.status, LevenbergMarquardtStatus::Done);
  EXPECT_LT((x - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-9);
  EXPECT_LT(result.iterations, 60);
}

TEST(LevenbergMarquardt,
     solves_powells_singular_function_though_its_jacobian_is_singular_at_the_solution) {
  Residuals problem{[](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
                      const double a = x[1] - 2.0 * x[2], b = x[0] - x[3], s5 = std::sqrt(5.0),
                                   s10 = std::sqrt(10.0);
                      r = Eigen::Vector4d(x[0] + 10.0 * x[1], s5 * (x[2] - x[3]), a * a,
                                          s10 * b * b);
                      J.setZero(4, 4);
                      J.row(0) << 1.0, 10.0, 0.0, 0.0;
                      J.row(1) << 0.0, 0.0, s5, -s5;
                      J.row(2) << 0.0, 2.0 * a, -4.0 * a, 0.0;
                      J.row(3) << 2.0 * s10 * b, 0.0, 0.0, -2.0 * s10 * b;
                    },
                    1e-10};
  Eigen::VectorXd x = Eigen::Vector4d(3.0, -1.0, 0.0, 1.0);
  EXPECT_EQ(run(problem, x, patient()).status, LevenbergMarquardtStatus::Done);
  EXPECT_LT(x.norm(), 1e-4);
}

TEST(LevenbergMarquardt, solves_random_linear_systems_of_any_size_it_takes) {
  for (const int n : {1, 2, 7, 30, 64}) {
    SCOPED_TRACE(n);
    Random random(static_cast<std::uint64_t>(n));
    const Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n) +
                              0.3 / std::sqrt(n) * Eigen::MatrixXd::NullaryExpr(n, n, [&] {
                                return random.uniform(-1, 1);
                              });
    const Eigen::VectorXd b = random.vector(n, -1.0, 1.0);
    Residuals problem = linear(A, b, 1e-11);
    Eigen::VectorXd x = random.vector(n, -1.0, 1.0);
    EXPECT_EQ(run(problem, x, patient()).status, LevenbergMarquardtStatus::Done);
    EXPECT_LT((x - A.partialPivLu().solve(b)).norm(), 1e-9);
  }
}

/// The minimiser of 1/2 |A x - b|^2 in a box, by projected gradient: slow, but it cannot be wrong
/// in the same way.
Eigen::VectorXd projected_gradient(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double lower,
                                   double upper) {
  const double step = 1.0 / (A.transpose() * A).norm();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(A.cols());
  for (int k = 0; k < 20000; ++k)
    x = (x - step * A.transpose() * (A * x - b)).cwiseMax(lower).cwiseMin(upper);
  return x;
}

TEST(LevenbergMarquardt, holds_variables_at_bounds_where_the_solution_wants_them) {
  int held = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Eigen::MatrixXd A =
        Eigen::MatrixXd::Identity(5, 5) +
        0.4 * Eigen::MatrixXd::NullaryExpr(5, 5, [&] { return random.uniform(-1.0, 1.0); });
    const Eigen::VectorXd b = random.vector(5, -2.0, 2.0);
    const Eigen::VectorXd expected = projected_gradient(A, b, -0.5, 0.7);
    Residuals problem = linear(A, b);
    LevenbergMarquardtOptions options = patient();
    options.max_iterations = 500;
    Eigen::VectorXd x = random.vector(5, -3.0, 3.0);  // some starts lie outside and are moved in
    run(problem, x, options, -0.5, 0.7);
    EXPECT_LT((x - expected).norm(), 1e-5);
    held +=
        static_cast<int>((expected.array() == -0.5).count() + (expected.array() == 0.7).count());
  }
  EXPECT_GT(held, 40);
}

TEST(LevenbergMarquardt, never_evaluates_outside_the_box) {
  Residuals problem = rosenbrock();
  Eigen::VectorXd x = Eigen::Vector2d(-5.0, 9.0);
  LevenbergMarquardt lm(2);
  const Eigen::VectorXd lower = Eigen::Vector2d(-1.5, -0.5), upper = Eigen::Vector2d(0.5, 2.0);
  lm.minimize(problem, x, lower, upper, never);
  EXPECT_TRUE((problem.smallest.array() >= lower.array()).all());
  EXPECT_TRUE((problem.largest.array() <= upper.array()).all());
  EXPECT_LT((x - Eigen::Vector2d(0.5, 0.25)).norm(), 1e-3);
}

TEST(LevenbergMarquardt, leaves_a_corner_when_the_gradient_points_inwards) {
  Residuals problem = linear(Eigen::Matrix2d::Identity(), Eigen::Vector2d(0.2, 0.3));
  Eigen::VectorXd x = Eigen::Vector2d(1.0, -1.0);
  EXPECT_EQ(run(problem, x, patient(), -1.0, 1.0).status, LevenbergMarquardtStatus::Done);
  EXPECT_LT((x - Eigen::Vector2d(0.2, 0.3)).norm(), 1e-9);
}

TEST(LevenbergMarquardt, stalls_at_a_local_minimum_that_is_no_solution) {
  Residuals problem{[](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
    r = Eigen::Vector2d(x[0] * x[0] + 1.0, 0.1 * x[0]);
    J = Eigen::Vector2d(2.0 * x[0], 0.1);
  }};
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 2.0);
  const LevenbergMarquardtResult result = run(problem, x);
  EXPECT_EQ(result.status, LevenbergMarquardtStatus::Stalled);
  EXPECT_LT(result.iterations, 30);
  EXPECT_NEAR(result.value, 0.5, 0.05);
}

TEST(LevenbergMarquardt,
     stalls_in_a_corner_that_holds_every_variable_and_where_nothing_moves_the_residual) {
  Residuals corner = linear(Eigen::Matrix2d::Identity(), Eigen::Vector2d(5.0, 5.0));
  Eigen::VectorXd x = Eigen::Vector2d(1.0, 1.0);
  EXPECT_EQ(run(corner, x, patient(), -1.0, 1.0).status, LevenbergMarquardtStatus::Stalled);
  EXPECT_EQ(x, Eigen::Vector2d(1.0, 1.0));
  Residuals flat{[](const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
    r = Eigen::Vector2d(1.0, 1.0), J.setZero(2, 2);
  }};
  EXPECT_EQ(run(flat, x, patient()).status, LevenbergMarquardtStatus::Stalled);
}

TEST(LevenbergMarquardt, a_window_of_slow_steps_is_a_stall_and_ratio_one_waits) {
  Residuals slow{[](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
    r = Eigen::Vector2d(3.0, x[0] * x[0]),
    J = Eigen::Vector2d(0.0, 2.0 * x[0]);  // x about halves at each step
  }};
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 0.5);
  EXPECT_EQ(run(slow, x).status, LevenbergMarquardtStatus::Stalled);
  const double soon = x[0];
  x[0] = 0.5;
  run(slow, x, patient());
  EXPECT_LT(x[0], 0.5 * soon);
}

TEST(LevenbergMarquardt, goes_down_at_every_step_and_reports_the_value_at_x) {
  for (int limit = 0; limit < 12; ++limit) {
    Residuals problem = rosenbrock();
    Eigen::VectorXd x = Eigen::Vector2d(-1.2, 1.0);
    LevenbergMarquardtOptions options = patient();
    options.max_iterations = limit;
    const LevenbergMarquardtResult result = run(problem, x, options);
    EXPECT_LE(result.value, problem.values.front());
    EXPECT_EQ(result.value, *std::min_element(problem.values.begin(), problem.values.end()));
    EXPECT_EQ(result.evaluations, static_cast<int>(problem.values.size()));
    EXPECT_EQ(result.value, problem.evaluate(x));
    EXPECT_EQ(result.status, LevenbergMarquardtStatus::IterationLimit);
    EXPECT_EQ(result.iterations, limit);
  }
}

TEST(LevenbergMarquardt, stops_when_the_caller_says_so) {
  Residuals problem = rosenbrock();
  Eigen::VectorXd x = Eigen::Vector2d(-1.2, 1.0);
  LevenbergMarquardt lm(2);
  int asked = 0;
  const Eigen::VectorXd wide = Eigen::VectorXd::Constant(2, 100.0);
  const LevenbergMarquardtResult result =
      lm.minimize(problem, x, -wide, wide, [&] { return ++asked == 3; });
  EXPECT_EQ(result.status, LevenbergMarquardtStatus::Stopped);
  EXPECT_EQ(result.value, problem.evaluate(x));
}

TEST(LevenbergMarquardt, survives_residuals_that_are_not_numbers_beyond_a_border) {
  Residuals problem{[](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
                      r = Eigen::VectorXd::Constant(
                          1, x[0] > 0.0 ? std::log(x[0]) + 5.0 : std::nan(""));
                      J = Eigen::MatrixXd::Constant(1, 1, 1.0 / x[0]);
                    },
                    1e-9};
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 2.0);
  LevenbergMarquardtOptions options = patient();
  options.first_damping = 1e-6;  // so that the first step would jump over the border
  EXPECT_EQ(run(problem, x, options).status, LevenbergMarquardtStatus::Done);
  EXPECT_NEAR(x[0], std::exp(-5.0), 1e-9);
}

TEST(LevenbergMarquardt, takes_no_step_to_what_is_no_number_even_if_all_is_well_there) {
  // Slopes that overflow give a step of NaN, and a residual that takes NaN for zero welcomes it.
  Residuals problem{[](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd& J) {
                      r = Eigen::VectorXd::Constant(1, std::isnan(x[0]) ? 0.0 : 1.0);
                      J = Eigen::MatrixXd::Constant(1, 1, 1e300);
                    },
                    1e-9};
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 0.5);
  EXPECT_NE(run(problem, x, patient()).status, LevenbergMarquardtStatus::Done);
  EXPECT_TRUE(x.allFinite());
}

TEST(LevenbergMarquardt, is_done_without_a_step_where_the_start_is_a_solution) {
  Residuals problem = rosenbrock();
  Eigen::VectorXd x = Eigen::Vector2d(1.0, 1.0);
  const LevenbergMarquardtResult result = run(problem, x);
  EXPECT_EQ(result.status, LevenbergMarquardtStatus::Done);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.evaluations, 1);
}

TEST(LevenbergMarquardt, takes_1_to_64_variables) {
  EXPECT_THROW(LevenbergMarquardt(0), std::invalid_argument);
  EXPECT_THROW(LevenbergMarquardt(65), std::invalid_argument);
  EXPECT_NO_THROW(LevenbergMarquardt(64));
}

}  // namespace
}  // namespace pdoik
