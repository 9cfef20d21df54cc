#pragma once

#include <optional>

#include "pdoik/cloud.hpp"
#include "thinning.hpp"

namespace pdoik::python {

/// A cloud and how its points are thinned before it takes them in.
struct ThinnedCloud {
  Cloud cloud;
  std::optional<Thinning> thinning;
};

}  // namespace pdoik::python
