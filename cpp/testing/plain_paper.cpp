#include "plain_paper.hpp"

#include <chrono>

namespace pdoik::testing {
namespace {

AugmentedLagrangianOptions as_printed(AugmentedLagrangianOptions options) {
  options.form = PenaltyForm::Printed;
  return options;
}

}  // namespace

PlainPaper::PlainPaper(const Robot& robot, const Options& options)
    : options_(options),
      problem_(robot, options),
      augmented_lagrangian_(problem_.size(), as_printed(options.augmented_lagrangian),
                            options.lbfgs) {
  omega_.setZero(problem_.size());
}

void PlainPaper::solve(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd* q0,
                       Result& result) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  problem_.set_target(T_base_tip);
  omega_.setZero();
  if (q0 != nullptr) problem_.start_from(*q0, options_.start_inset, omega_);
  const auto stop = [&](const Eigen::VectorXd&, double) {
    const bool done = problem_.position_error() < options_.position_tolerance &&
                      problem_.rotation_error() < options_.rotation_tolerance &&
                      problem_.last_max_constraint() <= 0.5 * options_.clearance_tolerance;
    return done || elapsed() > options_.max_time;
  };
  const AugmentedLagrangianResult inner = augmented_lagrangian_.minimize(problem_, omega_, stop);
  problem_.recover(omega_, result.q);
  result.iterations = inner.iterations;
  result.evaluations = inner.evaluations;
  result.restarts = 0;
  result.time = elapsed();
}

}  // namespace pdoik::testing
