#pragma once

#include "pdoik/options.hpp"

namespace pdoik::detail {

/// @throws std::invalid_argument naming the first option out of range, what is expected and what
/// came.
void check_options(const Options& options);

}  // namespace pdoik::detail
