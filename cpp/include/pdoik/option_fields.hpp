// Written by python/bindings/option_fields.py from the options' headers: edit those.
#pragma once
#include <array>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

#include "pdoik/options.hpp"

namespace pdoik::detail {

/// A member of a struct of options.
template <class Struct, class Value>
struct Field {
  const char* name;              ///< as it is declared
  Value Struct::* member;        ///< where it is
  bool (*holds)(const Struct&);  ///< whether it is in its range; null for any value
  const char* expected;          ///< the range in words
};

template <class Struct, class Value>
Field(const char*, Value Struct::*, std::type_identity_t<bool (*)(const Struct&)>, const char*)
    -> Field<Struct, Value>;

/// All members of a struct of options, in order.
template <class Struct>
inline constexpr std::tuple<> option_fields{};
/// The words for the enumerators of an enum.
template <class Enum>
inline constexpr std::array<std::pair<Enum, const char*>, 0> enumerator_names{};

template <>
inline constexpr std::array enumerator_names<GoalType>{
    std::pair{GoalType::Pose, "pose"}, std::pair{GoalType::Axis, "axis"},
    std::pair{GoalType::Position, "position"}, std::pair{GoalType::LookAt, "look_at"},
    std::pair{GoalType::CenterOfMass, "center_of_mass"}};
template <>
inline constexpr std::array enumerator_names<Priority>{std::pair{Priority::Both, "both"},
                                                       std::pair{Priority::Position, "position"}};
template <>
inline constexpr std::array enumerator_names<PenaltyForm>{
    std::pair{PenaltyForm::Printed, "printed"}, std::pair{PenaltyForm::Smooth, "smooth"}};
template <>
inline constexpr std::array enumerator_names<Method>{std::pair{Method::Default, "default"},
                                                     std::pair{Method::Paper, "paper"}};
template <>
inline constexpr std::array enumerator_names<InnerMethod>{
    std::pair{InnerMethod::LevenbergMarquardt, "levenberg_marquardt"},
    std::pair{InnerMethod::Lbfgs, "lbfgs"}};
template <>
inline constexpr std::array enumerator_names<Prefer>{std::pair{Prefer::First, "first"},
                                                     std::pair{Prefer::Nearest, "nearest"}};

template <>
inline constexpr std::tuple option_fields<LbfgsOptions>{
    Field{"memory", &LbfgsOptions::memory,
          [](const LbfgsOptions& o) { return o.memory >= 1 && o.memory <= 1000; }, "1 to 1000"},
    Field{"max_iterations", &LbfgsOptions::max_iterations,
          [](const LbfgsOptions& o) { return o.max_iterations >= 0; }, "at least 0"},
    Field{"max_line_search", &LbfgsOptions::max_line_search,
          [](const LbfgsOptions& o) { return o.max_line_search >= 1; }, "at least 1"},
    Field{"gradient_tolerance", &LbfgsOptions::gradient_tolerance,
          [](const LbfgsOptions& o) { return o.gradient_tolerance >= 0.0; }, "at least 0"},
    Field{"relative_decrease", &LbfgsOptions::relative_decrease,
          [](const LbfgsOptions& o) { return o.relative_decrease >= 0.0; }, "at least 0"},
    Field{"first_step", &LbfgsOptions::first_step,
          [](const LbfgsOptions& o) { return o.first_step > 0.0 && std::isfinite(o.first_step); },
          "a positive finite number"},
    Field{"max_step", &LbfgsOptions::max_step,
          [](const LbfgsOptions& o) { return o.max_step > 0.0; }, "a positive number"},
    Field{"armijo", &LbfgsOptions::armijo,
          [](const LbfgsOptions& o) { return o.armijo > 0.0 && o.armijo < 1.0; },
          "a number in (0, 1)"},
    Field{"curvature", &LbfgsOptions::curvature,
          [](const LbfgsOptions& o) { return o.curvature > o.armijo && o.curvature < 1.0; },
          "a number in (armijo, 1)"}};

template <>
inline constexpr std::tuple option_fields<AugmentedLagrangianOptions>{
    Field{"form", &AugmentedLagrangianOptions::form, nullptr, ""},
    Field{"rho", &AugmentedLagrangianOptions::rho,
          [](const AugmentedLagrangianOptions& o) { return o.rho > 0.0 && std::isfinite(o.rho); },
          "a positive finite number"},
    Field{"rho_growth", &AugmentedLagrangianOptions::rho_growth,
          [](const AugmentedLagrangianOptions& o) {
            return o.rho_growth >= 1.0 && std::isfinite(o.rho_growth);
          },
          "a finite number of at least 1"},
    Field{"rho_max", &AugmentedLagrangianOptions::rho_max,
          [](const AugmentedLagrangianOptions& o) { return o.rho_max >= o.rho; }, "at least rho"},
    Field{"beta", &AugmentedLagrangianOptions::beta,
          [](const AugmentedLagrangianOptions& o) { return o.beta > 0.0 && o.beta <= 1.0; },
          "a number in (0, 1]"},
    Field{"constraint_tolerance", &AugmentedLagrangianOptions::constraint_tolerance,
          [](const AugmentedLagrangianOptions& o) { return o.constraint_tolerance >= 0.0; },
          "at least 0"},
    Field{"max_outer_iterations", &AugmentedLagrangianOptions::max_outer_iterations,
          [](const AugmentedLagrangianOptions& o) { return o.max_outer_iterations >= 1; },
          "at least 1"}};

template <>
inline constexpr std::tuple option_fields<LevenbergMarquardtOptions>{
    Field{"max_iterations", &LevenbergMarquardtOptions::max_iterations,
          [](const LevenbergMarquardtOptions& o) { return o.max_iterations >= 0; }, "at least 0"},
    Field{"first_damping", &LevenbergMarquardtOptions::first_damping,
          [](const LevenbergMarquardtOptions& o) {
            return o.first_damping > 0.0 && std::isfinite(o.first_damping);
          },
          "a positive finite number"},
    Field{"damping_decrease", &LevenbergMarquardtOptions::damping_decrease,
          [](const LevenbergMarquardtOptions& o) {
            return o.damping_decrease > 0.0 && o.damping_decrease <= 1.0;
          },
          "a number in (0, 1]"},
    Field{"damping_increase", &LevenbergMarquardtOptions::damping_increase,
          [](const LevenbergMarquardtOptions& o) {
            return o.damping_increase > 1.0 && std::isfinite(o.damping_increase);
          },
          "a finite number above 1"},
    Field{"max_damping", &LevenbergMarquardtOptions::max_damping,
          [](const LevenbergMarquardtOptions& o) {
            return o.max_damping > 0.0 && std::isfinite(o.max_damping);
          },
          "a positive finite number"},
    Field{"stall_ratio", &LevenbergMarquardtOptions::stall_ratio,
          [](const LevenbergMarquardtOptions& o) { return o.stall_ratio > 0.0; },
          "a positive number"},
    Field{"stall_window", &LevenbergMarquardtOptions::stall_window,
          [](const LevenbergMarquardtOptions& o) { return o.stall_window >= 1; }, "at least 1"}};

template <>
inline constexpr std::tuple option_fields<BalanceOptions>{
    Field{"com_lower", &BalanceOptions::com_lower, nullptr, ""},
    Field{"com_upper", &BalanceOptions::com_upper, nullptr, ""},
    Field{"contacts", &BalanceOptions::contacts, nullptr, ""},
    Field{"support_margin", &BalanceOptions::support_margin,
          [](const BalanceOptions& o) { return std::isfinite(o.support_margin); },
          "a finite number [m]"},
    Field{"up", &BalanceOptions::up, nullptr, ""}};

template <>
inline constexpr std::tuple option_fields<TouchOptions>{
    Field{"radius", &TouchOptions::radius,
          [](const TouchOptions& o) { return o.radius >= 0.0 && std::isfinite(o.radius); },
          "a finite number of at least 0 [m]"},
    Field{"depth", &TouchOptions::depth, [](const TouchOptions& o) { return o.depth >= 0.0; },
          "at least 0 [m]"},
    Field{"links", &TouchOptions::links, nullptr, ""}};

template <>
inline constexpr std::tuple option_fields<Options>{
    Field{"goal", &Options::goal, nullptr, ""},
    Field{"goal_axis", &Options::goal_axis, nullptr, ""},
    Field{"T_tip_tool", &Options::T_tip_tool, nullptr, ""},
    Field{"priority", &Options::priority, nullptr, ""},
    Field{"method", &Options::method, nullptr, ""},
    Field{"position_tolerance", &Options::position_tolerance,
          [](const Options& o) {
            return o.position_tolerance > 0.0 && std::isfinite(o.position_tolerance);
          },
          "a positive finite number [m]"},
    Field{"rotation_tolerance", &Options::rotation_tolerance,
          [](const Options& o) {
            return o.rotation_tolerance > 0.0 && std::isfinite(o.rotation_tolerance);
          },
          "a positive finite number [rad]"},
    Field{"clearance", &Options::clearance,
          [](const Options& o) { return o.clearance >= -1000000.0 && o.clearance <= 1000000.0; },
          "-1e6 to 1e6 [m]"},
    Field{"clearance_tolerance", &Options::clearance_tolerance,
          [](const Options& o) {
            return o.clearance_tolerance >= 0.0 && std::isfinite(o.clearance_tolerance);
          },
          "a finite number of at least 0 [m]"},
    Field{"report_clearance", &Options::report_clearance,
          [](const Options& o) { return o.report_clearance >= 0.0; }, "at least 0 [m]"},
    Field{"base_collision", &Options::base_collision, nullptr, ""},
    Field{"exact_contact", &Options::exact_contact, nullptr, ""},
    Field{"ignore_obstacles_without_hulls", &Options::ignore_obstacles_without_hulls, nullptr, ""},
    Field{"touch", &Options::touch, nullptr, ""},
    Field{"balance", &Options::balance, nullptr, ""},
    Field{"self_collision", &Options::self_collision, nullptr, ""},
    Field{"self_clearance", &Options::self_clearance,
          [](const Options& o) {
            return o.self_clearance >= -1000000.0 && o.self_clearance <= 1000000.0;
          },
          "-1e6 to 1e6 [m]"},
    Field{"prefer", &Options::prefer, nullptr, ""},
    Field{
        "posture_weight", &Options::posture_weight,
        [](const Options& o) { return o.posture_weight > 0.0 && std::isfinite(o.posture_weight); },
        "a positive finite number [m^2/rad^2]"},
    Field{"joint_weights", &Options::joint_weights, nullptr, ""},
    Field{"max_time", &Options::max_time, [](const Options& o) { return o.max_time > 0.0; },
          "a positive number [s]"},
    Field{"max_restarts", &Options::max_restarts,
          [](const Options& o) { return o.max_restarts >= 0; }, "at least 0"},
    Field{"seed", &Options::seed, nullptr, ""},
    Field{"inner", &Options::inner, nullptr, ""},
    Field{"max_obstacles", &Options::max_obstacles,
          [](const Options& o) { return o.max_obstacles >= 0 && o.max_obstacles <= 10000000; },
          "0 to 1e7"},
    Field{"rotation_weight", &Options::rotation_weight,
          [](const Options& o) {
            return o.rotation_weight >= 0.0 && std::isfinite(o.rotation_weight);
          },
          "a finite number of at least 0 [m]"},
    Field{"collision_weight", &Options::collision_weight,
          [](const Options& o) {
            return o.collision_weight > 0.0 && std::isfinite(o.collision_weight);
          },
          "a positive finite number"},
    Field{"start_inset", &Options::start_inset,
          [](const Options& o) { return o.start_inset > 0.0 && o.start_inset < 0.5; },
          "a number in (0, 0.5)"},
    Field{
        "point_distance", &Options::point_distance,
        [](const Options& o) { return o.point_distance >= 0.0 && std::isfinite(o.point_distance); },
        "a finite number of at least 0 [m]"},
    Field{"lbfgs", &Options::lbfgs, nullptr, ""},
    Field{"augmented_lagrangian", &Options::augmented_lagrangian, nullptr, ""},
    Field{"levenberg_marquardt", &Options::levenberg_marquardt, nullptr, ""}};

}  // namespace pdoik::detail
