#pragma once

#include <string>
#include <vector>

#include "pdoik/result.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::python {

/// A result and its worst constraint's name, which takes a solver to tell.
struct NamedResult : Result {
  std::string worst_constraint;
};

inline NamedResult named(const Solver& solver, Result result) {
  std::string worst = solver.describe(result.worst);
  return {std::move(result), std::move(worst)};
}

struct BatchResult {
  std::vector<NamedResult> results;
  Eigen::Index dof = 0;
};

}  // namespace pdoik::python
