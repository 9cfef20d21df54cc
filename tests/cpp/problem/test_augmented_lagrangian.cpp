#include <gtest/gtest.h>

#include <functional>

#include "finite_differences.hpp"
#include "pdoik/augmented_lagrangian.hpp"
#include "random_robots.hpp"

namespace pdoik {
namespace {

using Function = std::function<double(const Eigen::VectorXd&,
                                      Eigen::VectorXd&)>;  // value, and gradient by reference

/// f and c_j <= 0 with multipliers, as AugmentedLagrangian wants them.
struct TextbookProblem {
  Function f;
  std::vector<Function> c;
  std::vector<double> mu = std::vector<double>(8, 0.0);
  int multiplier_updates = 0;

  double lagrangian(const Eigen::VectorXd& x, const Penalty& penalty, Eigen::VectorXd& g) {
    double value = f(x, g);
    Eigen::VectorXd gradient(x.size());
    for (std::size_t j = 0; j < c.size(); ++j) {
      const Penalty::Term term = penalty.term(c[j](x, gradient), mu[j]);
      value += term.value;
      g += term.slope * gradient;
    }
    return value;
  }
  double constraint(std::size_t j, const Eigen::VectorXd& x) const {
    Eigen::VectorXd unused(x.size());
    return c[j](x, unused);
  }
  double max_constraint(const Eigen::VectorXd& x) const {
    double largest = 0.0;
    for (std::size_t j = 0; j < c.size(); ++j) largest = std::max(largest, constraint(j, x));
    return largest;
  }
  void reset_multipliers() { mu.assign(c.size(), 0.0); }
  void update_multipliers(const Eigen::VectorXd& x, const Penalty& penalty) {
    ++multiplier_updates;
    for (std::size_t j = 0; j < c.size(); ++j)
      mu[j] = penalty.updated_multiplier(constraint(j, x), mu[j]);
  }
  /// What each constraint pulls with at x: its multiplier, once converged.
  std::vector<double> pulls(const Eigen::VectorXd& x, const Penalty& penalty) const {
    std::vector<double> all;
    for (std::size_t j = 0; j < c.size(); ++j)
      all.push_back(penalty.term(constraint(j, x), mu[j]).slope);
    return all;
  }
};

Function half_plane(const Eigen::VectorXd& normal, double offset) {  // normal.x - offset <= 0
  return [=](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    return g = normal, normal.dot(x) - offset;
  };
}
Function disc(double radius_squared) {
  return [=](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    return g = 2.0 * x, x.squaredNorm() - radius_squared;
  };
}
double rosenbrock(const Eigen::VectorXd& x, Eigen::VectorXd& g) {
  const double r = x[1] - x[0] * x[0], s = 1.0 - x[0];
  g = Eigen::Vector2d(-400.0 * x[0] * r - 2.0 * s, 200.0 * r);
  return 100.0 * r * r + s * s;
}

struct Textbook {
  const char* name;
  TextbookProblem problem;
  Eigen::VectorXd start, solution;
  std::vector<double> multipliers;
};

Eigen::VectorXd vector_of(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(),
                                           static_cast<Eigen::Index>(values.size()));
}

/// Solutions and multipliers were computed beforehand with SciPy 1.17's SLSQP (ftol 1e-15), the
/// multipliers as the least-squares solution of stationarity over the active constraints.
std::vector<Textbook> textbook() {
  const Function sum = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    g = Eigen::Vector2d(1.0, 1.0);
    return x.sum();
  };
  const Function hs35 = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    g = vector_of(
        {-8 + 4 * x[0] + 2 * x[1] + 2 * x[2], -6 + 4 * x[1] + 2 * x[0], -4 + 2 * x[2] + 2 * x[0]});
    return 9 - 8 * x[0] - 6 * x[1] - 4 * x[2] + 2 * x[0] * x[0] + 2 * x[1] * x[1] + x[2] * x[2] +
           2 * x[0] * x[1] + 2 * x[0] * x[2];
  };
  const Function hs43 = [](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
    g = vector_of({2 * x[0] - 5, 2 * x[1] - 5, 4 * x[2] - 21, 2 * x[3] + 7});
    return x[0] * x[0] + x[1] * x[1] + 2 * x[2] * x[2] + x[3] * x[3] - 5 * x[0] - 5 * x[1] -
           21 * x[2] + 7 * x[3];
  };
  const auto quadric = [](Eigen::VectorXd squares, Eigen::VectorXd linear,
                          double offset) -> Function {
    return [=](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
      g = 2.0 * squares.cwiseProduct(x) + linear;
      return squares.dot(x.cwiseProduct(x)) + linear.dot(x) - offset;
    };
  };
  return {
      {"x1 + x2 in a disc",
       {sum, {disc(2.0)}},
       vector_of({0.5, 0.0}),
       vector_of({-1.0, -1.0}),
       {0.5}},
      {"Rosenbrock in the unit disc, with an idle half plane",
       {rosenbrock, {disc(1.0), half_plane(vector_of({1.0, 0.0}), 3.0)}},
       vector_of({0.0, 0.0}),
       vector_of({0.7864151541698263, 0.617698312521613}),
       {0.12149655675157996, 0.0}},
      {"HS35 (Beale)",
       {hs35,
        {half_plane(vector_of({1, 1, 2}), 3.0), half_plane(vector_of({-1, 0, 0}), 0.0),
         half_plane(vector_of({0, -1, 0}), 0.0), half_plane(vector_of({0, 0, -1}), 0.0)}},
       vector_of({0.5, 0.5, 0.5}),
       vector_of({4.0 / 3.0, 7.0 / 9.0, 4.0 / 9.0}),
       {2.0 / 9.0, 0.0, 0.0, 0.0}},
      {"HS43 (Rosen-Suzuki)",
       {hs43,
        {quadric(vector_of({1, 1, 1, 1}), vector_of({1, -1, 1, -1}), 8.0),
         quadric(vector_of({1, 2, 1, 2}), vector_of({-1, 0, 0, -1}), 10.0),
         quadric(vector_of({2, 1, 1, 0}), vector_of({2, -1, 0, -1}), 5.0)}},
       vector_of({0, 0, 0, 0}),
       vector_of({0, 1, 2, -1}),
       {1.0, 0.0, 2.0}},
  };
}

AugmentedLagrangianOptions with_form(PenaltyForm form) {
  AugmentedLagrangianOptions options;
  options.form = form;
  return options;
}

TEST(AugmentedLagrangian,
     finds_the_solutions_and_multipliers_of_textbook_problems_in_the_smooth_form) {
  for (Textbook& t : textbook()) {
    SCOPED_TRACE(t.name);
    AugmentedLagrangianOptions options = with_form(PenaltyForm::Smooth);
    options.constraint_tolerance = 1e-9;
    AugmentedLagrangian solver(t.start.size(), options);
    Eigen::VectorXd x = t.start;
    const AugmentedLagrangianResult result = solver.minimize(t.problem, x);
    EXPECT_EQ(result.status, AugmentedLagrangianStatus::Feasible);
    EXPECT_LT((x - t.solution).lpNorm<Eigen::Infinity>(), 1e-6);
    EXPECT_LT(t.problem.max_constraint(x), 1e-9);
    const std::vector<double> pulls = t.problem.pulls(x, {options.form, result.rho});
    for (std::size_t j = 0; j < pulls.size(); ++j)
      EXPECT_NEAR(pulls[j], t.multipliers[j], 1e-4) << "constraint " << j;
  }
}

TEST(AugmentedLagrangian, finds_them_roughly_in_the_printed_form_whose_kink_stops_the_line_search) {
  for (Textbook& t : textbook()) {
    SCOPED_TRACE(t.name);
    AugmentedLagrangian solver(t.start.size(), with_form(PenaltyForm::Printed));
    Eigen::VectorXd x = t.start;
    const AugmentedLagrangianResult result = solver.minimize(t.problem, x);
    EXPECT_LT((x - t.solution).lpNorm<Eigen::Infinity>(), 2e-2);
    EXPECT_LT(t.problem.max_constraint(x), 1e-4);
    EXPECT_EQ(result.status == AugmentedLagrangianStatus::Feasible,
              t.problem.max_constraint(x) < 1e-6);
  }
}

TEST(AugmentedLagrangian, gives_constraints_that_are_never_active_no_multiplier) {
  for (const PenaltyForm form : {PenaltyForm::Smooth, PenaltyForm::Printed}) {
    TextbookProblem problem{rosenbrock, {disc(2.5), half_plane(vector_of({1.0, 1.0}), 9.0)}};
    AugmentedLagrangian solver(2, with_form(form));
    Eigen::VectorXd x = Eigen::Vector2d(0.5, 0.3);
    const AugmentedLagrangianResult result = solver.minimize(problem, x);
    EXPECT_EQ(result.status, AugmentedLagrangianStatus::Feasible);
    EXPECT_EQ(result.outer_iterations, 1);
    EXPECT_EQ(result.max_constraint, 0.0);
    EXPECT_LT((x - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-6);
    problem.update_multipliers(x, {form, 10.0});
    EXPECT_EQ(problem.mu, (std::vector<double>{0.0, 0.0}));
  }
}

TEST(AugmentedLagrangian, reports_an_infeasible_problem_as_stalled) {
  for (const PenaltyForm form : {PenaltyForm::Smooth, PenaltyForm::Printed}) {
    TextbookProblem problem{
        rosenbrock,
        {half_plane(vector_of({1.0, 0.0}), -1.0), half_plane(vector_of({-1.0, 0.0}), -1.0)}};
    AugmentedLagrangian solver(2, with_form(form));
    Eigen::VectorXd x = Eigen::Vector2d(0.5, 0.0);
    const AugmentedLagrangianResult result = solver.minimize(problem, x);
    EXPECT_EQ(result.status,
              AugmentedLagrangianStatus::Stalled);  // x <= -1 and x >= 1: c is at least 1
    EXPECT_GE(result.max_constraint, 0.99);
    EXPECT_LT(result.outer_iterations, 20);
  }
}

TEST(AugmentedLagrangian, gives_up_exactly_when_the_worst_constraint_falls_by_less_than_beta) {
  // f = 0 with c = x^2 + 1: at x = 0 from the start, so c is 1 after each outer iteration.
  TextbookProblem problem{
      [](const Eigen::VectorXd& x, Eigen::VectorXd& g) { return g.setZero(x.size()), 0.0; },
      {[](const Eigen::VectorXd& x, Eigen::VectorXd& g) {
        return g = 2.0 * x, x.squaredNorm() + 1.0;
      }}};
  AugmentedLagrangian solver(1);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(1);
  const AugmentedLagrangianResult result = solver.minimize(problem, x);
  EXPECT_EQ(result.status, AugmentedLagrangianStatus::Stalled);
  EXPECT_EQ(result.outer_iterations, 2);
  EXPECT_DOUBLE_EQ(result.max_constraint, 1.0);
}

TEST(AugmentedLagrangian, multiplies_rho_by_its_growth_and_stops_at_k_max) {
  AugmentedLagrangianOptions options;
  options.max_outer_iterations = 3;
  options.constraint_tolerance = 1e-300;
  options.beta = 1e9;  // never gives up
  options.rho = 2.0, options.rho_growth = 5.0;
  Textbook t = textbook().front();
  AugmentedLagrangian solver(2, options);
  Eigen::VectorXd x = t.start;
  const AugmentedLagrangianResult result = solver.minimize(t.problem, x);
  if (result.status == AugmentedLagrangianStatus::IterationLimit) {
    EXPECT_EQ(result.outer_iterations, 3);
    EXPECT_DOUBLE_EQ(result.rho, 2.0 * 5.0 * 5.0);
    EXPECT_EQ(t.problem.multiplier_updates, 3);
  } else {
    FAIL() << "ended with status " << static_cast<int>(result.status);
  }
  options.rho_max = 7.0;
  AugmentedLagrangian capped(2, options);
  x = t.start;
  EXPECT_DOUBLE_EQ(capped.minimize(t.problem, x).rho, 7.0);
}

TEST(AugmentedLagrangian, stops_when_the_caller_says_so) {
  Textbook t = textbook().front();
  AugmentedLagrangian solver(2);
  Eigen::VectorXd x = t.start;
  int asked = 0;
  const AugmentedLagrangianResult result =
      solver.minimize(t.problem, x, [&](const Eigen::VectorXd&, double) { return ++asked == 3; });
  EXPECT_EQ(result.status, AugmentedLagrangianStatus::Stopped);
  EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace pdoik
