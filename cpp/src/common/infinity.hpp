#pragma once

#include <limits>

namespace pdoik::detail {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace pdoik::detail
