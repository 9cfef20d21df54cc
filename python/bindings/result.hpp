#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pdoik/result.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::python {

/// A result and the names of its constraints, which take a solver or a tracker to tell.
struct NamedResult : Result {
  std::string worst_constraint;
  std::string message;
  std::optional<Derivatives> derivatives;  ///< where they were asked for
};

/// @param by  Whose result it is.
template <class Solves>
void name_constraints(const Solves& by, NamedResult& result) {
  result.worst_constraint = by.describe(result.worst);
}

inline NamedResult named(const Solver& solver, Result result) {
  NamedResult named{std::move(result), {}, {}, {}};
  name_constraints(solver, named);
  return named;
}
inline NamedResult named(const Solver& solver, const Request& request, Result result) {
  NamedResult told = named(solver, std::move(result));
  told.message = solver.explain(request, told);
  return told;
}

struct NamedSolutions {
  std::vector<NamedResult> results;
  std::vector<int> turns;
  bool complete = false;
  double coverage = 0.0;
  Status status = Status::Exhausted;
  int restarts = 0;
  double time = 0.0;
  Eigen::Index dof = 0;
};

struct BatchResult {
  std::vector<NamedResult> results;
  Eigen::Index dof = 0;
};

}  // namespace pdoik::python
