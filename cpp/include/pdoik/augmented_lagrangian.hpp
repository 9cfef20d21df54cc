#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <limits>

#include "pdoik/lbfgs.hpp"

namespace pdoik {

/// How a constraint c <= 0 enters the augmented Lagrangian.
enum class PenaltyForm {
  /// Eq. AL as printed, with the update corrected (mu + rho max(0, c)):
  ///
  ///     mu max(0, c) + rho/2 max(0, c)^2.
  ///
  /// It has a kink at c = 0 once mu > 0.
  Printed,
  /// The classic smooth form max(0, mu + rho c)^2 / (2 rho), update max(0, mu + rho c). Up to the
  /// constant
  /// -mu^2 / (2 rho) it equals the printed one where c > 0; it acts for every c > -mu / rho.
  Smooth,
};

/// One constraint's share of the augmented Lagrangian at penalty weight rho.
struct Penalty {
  PenaltyForm form = PenaltyForm::Smooth;  ///< how constraints enter
  double rho = 1.0;                        ///< weight of a constraint's square, positive

  /// What a constraint adds.
  struct Term {
    double value = 0.0;  ///< share of L_rho
    double slope = 0.0;  ///< d value / d c
  };

  /// How far below zero a constraint with multiplier mu still acts.
  double reach(double mu) const { return form == PenaltyForm::Printed ? 0.0 : mu / rho; }
  /// The share of a constraint of value c whose multiplier is mu.
  Term term(double c, double mu) const {
    if (!(c > -reach(mu))) return {};
    const double pull = mu + rho * c;
    if (form == PenaltyForm::Printed) return {mu * c + 0.5 * rho * c * c, pull};
    return {pull * pull / (2.0 * rho), pull};
  }
  /// The multiplier for the next outer iteration of a constraint that came to c.
  double updated_multiplier(double c, double mu) const {
    return form == PenaltyForm::Printed ? mu + rho * std::max(0.0, c) : std::max(0.0, mu + rho * c);
  }
};

/// Algorithm IK's outer loop (Eq. AL).
struct AugmentedLagrangianOptions {
  /// How constraints enter: PenaltyForm::Printed, as in the paper, has a kink at c = 0;
  /// PenaltyForm::Smooth has none. Otherwise they are equal.
  PenaltyForm form = PenaltyForm::Smooth;
  double rho = 1.0;          ///< first penalty weight (paper: 1), in (0, inf)
  double rho_growth = 10.0;  ///< alpha, by which the weight grows (paper: 10), in [1, inf)
  double rho_max = 1e12;     ///< the weight grows no further, in [rho, inf]
  double beta = 0.99;  ///< give up when max c >= beta times its last value (paper: 0.99), in (0, 1]
  double constraint_tolerance = 1e-6;  ///< c_tol, in the constraints' own unit, in [0, inf]
  int max_outer_iterations = 20;       ///< k_max, in [1, inf)
};

/// Why the outer loop ended.
enum class AugmentedLagrangianStatus {
  Feasible,  ///< max c < c_tol
  Stalled,   ///< max c stopped falling: Algorithm IK's second stop condition, which is giving up
  IterationLimit,  ///< k_max reached
  Stopped,         ///< the caller's stop condition held
};

/// How a minimisation ended, and what it took.
struct AugmentedLagrangianResult {
  AugmentedLagrangianStatus status = AugmentedLagrangianStatus::IterationLimit;  ///< why it ended
  /// max(0, max c) at the returned point; infinite, for nobody looked, if the caller stopped it.
  double max_constraint = std::numeric_limits<double>::infinity();
  double rho = 0.0;          ///< the last penalty weight
  int outer_iterations = 0;  ///< begun
  int iterations = 0;        ///< of the inner minimiser, in all
  int evaluations = 0;       ///< of the Lagrangian and its gradient
};

/// Minimise f(x) subject to c(x) <= 0 (Algorithm IK's loop). Knows nothing of robots.
///
/// A Problem provides
///
///     // f + the sum of penalty terms, and its gradient
///     double lagrangian(const VectorXd& x, const Penalty&, VectorXd& gradient);
///     double max_constraint(const VectorXd& x);                     // max(0, max_j c_j(x))
///     void reset_multipliers();                                     // mu <- 0
///     void update_multipliers(const VectorXd& x, const Penalty&);   // Penalty::updated_multiplier
///
/// and keeps its own multipliers, one per constraint, because only it knows which are not zero.
class AugmentedLagrangian {
 public:
  /// All memory is taken here.
  /// @param variables  Number of variables, at least 1.
  /// @throws std::invalid_argument as Lbfgs does.
  explicit AugmentedLagrangian(Eigen::Index variables,
                               const AugmentedLagrangianOptions& options = {},
                               const LbfgsOptions& inner = {})
      : options_(options), lbfgs_(variables, inner) {}

  /// Minimise from x, in place.
  /// @param stop  bool(const VectorXd& x, double lagrangian), asked after every inner iteration.
  /// @param cut  bool(), asked after every evaluation of a line search, see Lbfgs::minimize.
  template <class Problem, class Stop, class Cut>
  AugmentedLagrangianResult minimize(Problem& problem, Eigen::VectorXd& x, Stop&& stop, Cut&& cut) {
    AugmentedLagrangianResult result;
    Penalty penalty{options_.form, options_.rho};
    double last = std::numeric_limits<double>::infinity();
    problem.reset_multipliers();
    for (int k = 0; k < options_.max_outer_iterations; ++k) {
      const auto lagrangian = [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
        return problem.lagrangian(at, penalty, gradient);
      };
      const LbfgsResult inner = lbfgs_.minimize(lagrangian, x, stop, cut);  // Algorithm IK, line 3
      result.iterations += inner.iterations;
      result.evaluations += inner.evaluations;
      result.outer_iterations = k + 1;
      result.rho = penalty.rho;
      result.max_constraint = std::numeric_limits<double>::infinity();
      if (inner.status == LbfgsStatus::Stopped || cut()) {
        result.status = AugmentedLagrangianStatus::Stopped;
        return result;
      }
      result.max_constraint = problem.max_constraint(x);
      if (result.max_constraint < options_.constraint_tolerance) {  // line 4
        result.status = AugmentedLagrangianStatus::Feasible;
        return result;
      }
      if (result.max_constraint >= options_.beta * last) {
        result.status = AugmentedLagrangianStatus::Stalled;
        return result;
      }
      last = result.max_constraint;                                                 // line 8
      problem.update_multipliers(x, penalty);                                       // line 9
      penalty.rho = std::min(options_.rho_growth * penalty.rho, options_.rho_max);  // line 10
    }
    result.status = AugmentedLagrangianStatus::IterationLimit;
    return result;
  }
  /// The same without `cut`.
  template <class Problem, class Stop>
  AugmentedLagrangianResult minimize(Problem& problem, Eigen::VectorXd& x, Stop&& stop) {
    return minimize(problem, x, stop, [] { return false; });
  }
  /// The same to the end.
  template <class Problem>
  AugmentedLagrangianResult minimize(Problem& problem, Eigen::VectorXd& x) {
    return minimize(problem, x, [](const Eigen::VectorXd&, double) { return false; });
  }

  /// Those it was made with.
  const AugmentedLagrangianOptions& options() const { return options_; }

 private:
  AugmentedLagrangianOptions options_;
  Lbfgs lbfgs_;
};

}  // namespace pdoik
