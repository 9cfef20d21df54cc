#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/typing.h>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "pdoik/lagrangian.hpp"
#include "pdoik/options.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::python {

/// What Python calls the enumerators of an enum.
template <class Enum>
inline constexpr std::array<std::pair<Enum, const char*>, 0> names{};

template <>
inline constexpr std::array names<GoalType>{
    std::pair{GoalType::Pose, "pose"}, std::pair{GoalType::Axis, "axis"},
    std::pair{GoalType::Position, "position"}, std::pair{GoalType::LookAt, "look_at"},
    std::pair{GoalType::CenterOfMass, "center_of_mass"}};
template <>
inline constexpr std::array names<Priority>{std::pair{Priority::Both, "both"},
                                            std::pair{Priority::Position, "position"}};
template <>
inline constexpr std::array names<Method>{std::pair{Method::Default, "default"},
                                          std::pair{Method::Paper, "paper"}};
template <>
inline constexpr std::array names<Prefer>{std::pair{Prefer::First, "first"},
                                          std::pair{Prefer::Nearest, "nearest"}};
template <>
inline constexpr std::array names<InnerMethod>{
    std::pair{InnerMethod::LevenbergMarquardt, "levenberg_marquardt"},
    std::pair{InnerMethod::Lbfgs, "lbfgs"}};
template <>
inline constexpr std::array names<PenaltyForm>{std::pair{PenaltyForm::Printed, "printed"},
                                               std::pair{PenaltyForm::Smooth, "smooth"}};
template <>
inline constexpr std::array names<Lagrangian::Variables>{
    std::pair{Lagrangian::Variables::Slack, "slack"},
    std::pair{Lagrangian::Variables::Positions, "positions"}};
template <>
inline constexpr std::array names<JointType>{
    std::pair{JointType::Fixed, "fixed"}, std::pair{JointType::Revolute, "revolute"},
    std::pair{JointType::Continuous, "continuous"}, std::pair{JointType::Prismatic, "prismatic"}};

using JointTypeName =
    pybind11::typing::Literal<"'fixed'", "'revolute'", "'continuous'", "'prismatic'">;
using StatusName =
    pybind11::typing::Literal<"'solved'", "'time_limit'", "'exhausted'", "'out_of_reach'",
                              "'base_collision'", "'blocked'", "'nearest'">;

template <class Enum>
const char* to_name(Enum value) {
  for (const auto& [enumerator, name] : names<Enum>) {
    if (enumerator == value) return name;
  }
  return "unknown";
}

template <class Enum>
Enum from_name(const std::string& text, const char* argument) {
  std::string expected;
  for (const auto& [enumerator, name] : names<Enum>) {
    if (text == name) return enumerator;
    expected += (expected.empty() ? "'" : ", '") + std::string(name) + "'";
  }
  throw std::invalid_argument(std::string(argument) + " is '" + text + "', expected one of " +
                              expected);
}

}  // namespace pdoik::python
