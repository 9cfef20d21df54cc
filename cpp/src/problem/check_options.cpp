#include "problem/check_options.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "common/check_input.hpp"
#include "pdoik/option_fields.hpp"

namespace pdoik::detail {
namespace {

template <class Value>
[[noreturn]] void refuse(const std::string& name, Value value, const char* expected) {
  std::ostringstream message;
  message << name << " is " << value << ", expected " << expected;
  throw std::invalid_argument(message.str());
}

/// Checks the ranges of a struct's options, and of the structs in it.
template <class Struct>
void check_ranges(const Struct& options, const std::string& prefix = "") {
  const auto check = [&](const auto& field) {
    using Value = std::remove_cvref_t<decltype(options.*field.member)>;
    const Value& value = options.*field.member;
    if constexpr (std::tuple_size_v<decltype(option_fields<Value>)> > 0) {
      check_ranges(value, prefix + field.name + ".");
    } else if constexpr (std::is_arithmetic_v<Value>) {
      if (field.holds != nullptr && !field.holds(options))
        refuse(prefix + field.name, value, field.expected);
    }
  };
  std::apply([&](const auto&... field) { (check(field), ...); }, option_fields<Struct>);
}

}  // namespace

void check_options(const Options& o) {
  check_ranges(o);
  if (o.clearance < 0.0 &&
      (o.method != Method::Default || o.inner != InnerMethod::LevenbergMarquardt))
    refuse("clearance", o.clearance,
           "at least 0 unless method is 'default' with inner 'levenberg_marquardt'");
  if (!is_rigid(o.T_tip_tool)) throw std::invalid_argument("T_tip_tool is not a rigid transform");
  const double length = o.goal_axis.norm();
  if (!(length > 1e-9) || !std::isfinite(length))
    refuse("goal_axis", length, "a direction, not a vector of this length");
}

}  // namespace pdoik::detail
