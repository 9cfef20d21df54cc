#pragma once

#include <optional>
#include <string>

#include "arrays.hpp"
#include "pdoik/cloud.hpp"

namespace pdoik::python {

/// A cloud and how its points are thinned before it takes them in.
struct ThinnedCloud {
  Cloud cloud;
  std::optional<double> leaf;
  bool radii = false;
};

}  // namespace pdoik::python
