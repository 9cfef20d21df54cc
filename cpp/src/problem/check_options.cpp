#include "problem/check_options.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "common/check_input.hpp"

namespace pdoik::detail {
namespace {

template <class Value>
void require(bool holds, const char* name, Value value, const char* expected) {
  if (holds) return;
  std::ostringstream message;
  message << name << " is " << value << ", expected " << expected;
  throw std::invalid_argument(message.str());
}

void require_positive(const char* name, double value) {
  require(value > 0.0 && std::isfinite(value), name, value, "a positive finite number");
}

void check_lbfgs(const LbfgsOptions& o) {
  require(o.memory >= 1 && o.memory <= 1000, "lbfgs.memory", o.memory, "1 to 1000");
  require(o.max_iterations >= 0, "lbfgs.max_iterations", o.max_iterations, "at least 0");
  require(o.max_line_search >= 1, "lbfgs.max_line_search", o.max_line_search, "at least 1");
  require(o.gradient_tolerance >= 0.0, "lbfgs.gradient_tolerance", o.gradient_tolerance,
          "at least 0");
  require(o.relative_decrease >= 0.0, "lbfgs.relative_decrease", o.relative_decrease, "at least 0");
  require_positive("lbfgs.first_step", o.first_step);
  require(o.max_step > 0.0, "lbfgs.max_step", o.max_step, "a positive number");  // infinity is fine
  require(o.armijo > 0.0 && o.armijo < o.curvature, "lbfgs.armijo", o.armijo,
          "between 0 and curvature");
  require(o.curvature < 1.0, "lbfgs.curvature", o.curvature, "less than 1");
}

void check_augmented_lagrangian(const AugmentedLagrangianOptions& o) {
  require_positive("augmented_lagrangian.rho", o.rho);
  require(o.rho_growth >= 1.0 && std::isfinite(o.rho_growth), "augmented_lagrangian.rho_growth",
          o.rho_growth, "a finite number of at least 1");
  require(o.rho_max >= o.rho, "augmented_lagrangian.rho_max", o.rho_max, "at least rho");
  require(o.beta > 0.0 && o.beta <= 1.0, "augmented_lagrangian.beta", o.beta, "in (0, 1]");
  require(o.constraint_tolerance >= 0.0, "augmented_lagrangian.constraint_tolerance",
          o.constraint_tolerance, "at least 0");
  require(o.max_outer_iterations >= 1, "augmented_lagrangian.max_outer_iterations",
          o.max_outer_iterations, "at least 1");
}

void check_levenberg_marquardt(const LevenbergMarquardtOptions& o) {
  require(o.max_iterations >= 0, "levenberg_marquardt.max_iterations", o.max_iterations,
          "at least 0");
  require_positive("levenberg_marquardt.first_damping", o.first_damping);
  require(o.damping_decrease > 0.0 && o.damping_decrease <= 1.0,
          "levenberg_marquardt.damping_decrease", o.damping_decrease, "in (0, 1]");
  require(o.damping_increase > 1.0 && std::isfinite(o.damping_increase),
          "levenberg_marquardt.damping_increase", o.damping_increase, "a finite number above 1");
  require_positive("levenberg_marquardt.max_damping", o.max_damping);
  require(o.stall_ratio > 0.0, "levenberg_marquardt.stall_ratio", o.stall_ratio,
          "a positive number");
  require(o.stall_window >= 1, "levenberg_marquardt.stall_window", o.stall_window, "at least 1");
}

}  // namespace

void check_options(const Options& o) {
  check_lbfgs(o.lbfgs);
  check_augmented_lagrangian(o.augmented_lagrangian);
  check_levenberg_marquardt(o.levenberg_marquardt);
  require_positive("position_tolerance", o.position_tolerance);
  require_positive("rotation_tolerance", o.rotation_tolerance);
  require(std::abs(o.clearance) <= 1e6, "clearance", o.clearance, "a length within 1e6 m");
  require(o.clearance >= 0.0 ||
              (o.method == Method::Default && o.inner == InnerMethod::LevenbergMarquardt),
          "clearance", o.clearance,
          "at least 0 unless method is 'default' with inner 'levenberg_marquardt'");
  require(o.clearance_tolerance >= 0.0 && std::isfinite(o.clearance_tolerance),
          "clearance_tolerance", o.clearance_tolerance, "a finite length of at least 0 [m]");
  require(o.report_clearance >= 0.0, "report_clearance", o.report_clearance,
          "a length of at least 0 [m]");
  require(o.touch.radius >= 0.0 && std::isfinite(o.touch.radius), "touch.radius", o.touch.radius,
          "a finite length of at least 0 [m]");
  require(o.touch.depth >= 0.0, "touch.depth", o.touch.depth, "a length of at least 0 [m]");
  require(std::abs(o.self_clearance) <= 1e6, "self_clearance", o.self_clearance,
          "a length within 1e6 m");
  require_positive("posture_weight", o.posture_weight);
  require(o.max_time > 0.0, "max_time", o.max_time, "a positive time [s]");  // infinity is fine
  require(o.max_restarts >= 0, "max_restarts", o.max_restarts, "at least 0");
  require(o.max_obstacles >= 0 && o.max_obstacles <= 10'000'000, "max_obstacles", o.max_obstacles,
          "0 to 10 million");
  require(o.rotation_weight >= 0.0 && std::isfinite(o.rotation_weight), "rotation_weight",
          o.rotation_weight, "a finite length of at least 0 [m]");
  require_positive("collision_weight", o.collision_weight);
  require(o.point_distance >= 0.0 && std::isfinite(o.point_distance), "point_distance",
          o.point_distance, "a finite length of at least 0 [m]");
  require(o.start_inset > 0.0 && o.start_inset < 0.5, "start_inset", o.start_inset,
          "a fraction in (0, 0.5)");
  if (!is_rigid(o.T_tip_tool)) throw std::invalid_argument("T_tip_tool is not a rigid transform");
  const double length = o.goal_axis.norm();
  require(length > 1e-9 && std::isfinite(length), "goal_axis", length,
          "a direction, not a vector of this length");
}

}  // namespace pdoik::detail
