#include "search/workspace.hpp"

#include <algorithm>

#include "kinematics/reach.hpp"

namespace pdoik::detail {
namespace {

/// The last verdict comes after the clock has struck: time is kept for it, but no more than this
/// share.
constexpr double kMostReserved = 0.5;

AugmentedLagrangianOptions lagrangian_options(const Options& options) {
  AugmentedLagrangianOptions result = options.augmented_lagrangian;
  if (options.method == Method::Paper) result.form = PenaltyForm::Printed;
  return result;
}

/// The cost is in square metres, and so is what is small of it.
LbfgsOptions lbfgs_options(const Model& model) {
  LbfgsOptions result = model.options.lbfgs;
  const double size = std::min(1.0, relative_size(model.robot));
  result.gradient_tolerance *= size * size;
  return result;
}

/// Where the cost has no zero, it goes on while there is anything to gain.
LevenbergMarquardtOptions settling_options(LevenbergMarquardtOptions options) {
  options.first_damping = 1e-3;
  options.stall_ratio = 0.999;
  options.stall_window = 2;
  return options;
}

/// Where wishes weigh so little that damping must be less still to let them count.
LevenbergMarquardtOptions wishing_options(LevenbergMarquardtOptions options) {
  options.first_damping = 1e-9;
  options.stall_ratio = 0.9999;
  options.max_iterations = std::max(options.max_iterations, 200);
  options.stall_window = 3;
  return options;
}

}  // namespace

LevenbergMarquardtOptions patient(LevenbergMarquardtOptions options) {
  options.stall_ratio = std::max(options.stall_ratio, 0.95);
  options.stall_window = std::max(options.stall_window, 4);
  return options;
}

void restore(const Result& earlier, Result& result) {
  const int iterations = result.iterations, evaluations = result.evaluations,
            restarts = result.restarts, late = result.late_evaluations;
  result = earlier;
  result.iterations = iterations;
  result.evaluations = evaluations;
  result.restarts = restarts;
  result.late_evaluations = late;
}

Workspace::Workspace(std::shared_ptr<const Model> model_in, const Scene& scene)
    : model_(std::move(model_in)),
      judge_(model().robot, model().options, model().hulls, model().whole),
      augmented_lagrangian_(model().robot.dof(), lagrangian_options(model().options),
                            lbfgs_options(model())),
      problem(model(), scene),
      map(model().robot),
      lagrangian(map, problem),
      least_squares(problem),
      brisk(model().robot.dof(), model().options.levenberg_marquardt),
      patient(model().robot.dof(), detail::patient(model().options.levenberg_marquardt)),
      settling(model().robot.dof(), settling_options(model().options.levenberg_marquardt)),
      wishing(model().robot.dof(), wishing_options(model().options.levenberg_marquardt)),
      lanes(model().robot, model().options),
      tool(model()) {
  omega.setZero(map.size());
  for (Eigen::VectorXd* each : {&saved.q, &q, &start}) each->setZero(model().robot.dof());
  judge_.allow(&problem.allowed_contact);
  tool.allow(&problem.allowed_contact);
  use(scene);
}

void Workspace::use(const Scene& scene) {
  problem.scene = &scene;
  const Options& options = model().options;
  const int padded =
      std::max(scene.padded_points(), (options.max_obstacles + kLanes - 1) / kLanes * kLanes);
  problem.constraints.hulls.reserve(padded);
  problem.constraints.shapes.reserve(scene.shapes().parts());
  if (links_stamp_ != scene.links_stamp()) {
    links_stamp_ = scene.links_stamp();
    problem.constraints.self.use(scene.pairs().margins);
    judge_.keep_off_itself(scene);
  }
  if (attachments_stamp_ != scene.attachments_stamp()) {
    attachments_stamp_ = scene.attachments_stamp();
    problem.constraints.attachments.attach(scene);
    judge_.attach(scene);
    tool.attach(scene);
  }
  least_squares.reserve(padded);
  least_squares.count_all_obstacles();
  if (options.method == Method::Paper || options.inner == InnerMethod::Lbfgs)
    lagrangian.reserve(padded);
  lagrangian.reset_multipliers();
}

Deadline Workspace::deadline_in(double max_time, int verdicts) const {
  return {max_time - std::min(verdicts * verdict_time_, kMostReserved * max_time), interrupt};
}

void Workspace::judge(std::span<const Goal> asked, const Eigen::VectorXd& at, Result& result,
                      double look) {
  if (problem.deadline->struck()) ++result.late_evaluations;
  const double began = problem.deadline->elapsed();
  problem.allowed_contact.set_goals(asked);
  judge_(asked, at, scene(), result, look);
  const double took = problem.deadline->elapsed() - began;
  verdict_time_ = std::max(took, 0.5 * (took + verdict_time_));
}

double Workspace::minimise(LevenbergMarquardt& minimiser, Eigen::VectorXd& x,
                           const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                           Result& result) {
  if (problem.deadline->struck()) return std::numeric_limits<double>::infinity();
  const LevenbergMarquardtResult inner = minimiser.minimize(
      least_squares, x, lower, upper, [&] { return problem.deadline->passed(); });
  result.iterations += inner.iterations;
  result.evaluations += inner.evaluations;
  return inner.value;
}

void Workspace::minimise_lagrangian(Result& result) {
  const Options& options = model().options;
  const auto struck = [&] { return problem.deadline->passed(); };
  const auto stop = [&](const Eigen::VectorXd&, double) {
    if (lagrangian.last_max_constraint() <= 0.5 * options.clearance_tolerance &&
        std::ranges::all_of(problem.goals, &GoalTerm::is_met)) {
      return true;
    }
    return struck();
  };
  const AugmentedLagrangianResult inner =
      augmented_lagrangian_.minimize(lagrangian, omega, stop, struck);
  result.iterations += inner.iterations;
  result.evaluations += inner.evaluations;
}

}  // namespace pdoik::detail
