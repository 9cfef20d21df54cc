#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/typing.h>

#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "pdoik/lagrangian.hpp"
#include "pdoik/option_fields.hpp"
#include "pdoik/result.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

template <>
inline constexpr std::array enumerator_names<Lagrangian::Variables>{
    std::pair{Lagrangian::Variables::Slack, "slack"},
    std::pair{Lagrangian::Variables::Positions, "positions"}};
template <>
inline constexpr std::array enumerator_names<JointType>{
    std::pair{JointType::Fixed, "fixed"}, std::pair{JointType::Revolute, "revolute"},
    std::pair{JointType::Continuous, "continuous"}, std::pair{JointType::Prismatic, "prismatic"}};

}  // namespace pdoik::detail

namespace pdoik::python {

using JointTypeName =
    pybind11::typing::Literal<"'fixed'", "'revolute'", "'continuous'", "'prismatic'">;
using StatusName =
    pybind11::typing::Literal<"'solved'", "'time_limit'", "'exhausted'", "'out_of_reach'",
                              "'base_collision'", "'blocked'", "'nearest'">;

template <class Enum>
const char* to_name(Enum value) {
  for (const auto& [enumerator, name] : detail::enumerator_names<Enum>) {
    if (enumerator == value) return name;
  }
  return "unknown";
}

template <class Enum>
Enum from_name(const std::string& text, const char* argument) {
  std::string expected;
  for (const auto& [enumerator, name] : detail::enumerator_names<Enum>) {
    if (text == name) return enumerator;
    expected += (expected.empty() ? "'" : ", '") + std::string(name) + "'";
  }
  throw std::invalid_argument(std::string(argument) + " is '" + text + "', expected one of " +
                              expected);
}

}  // namespace pdoik::python
