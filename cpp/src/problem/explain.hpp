#pragma once

#include <string>

#include "obstacles/scene.hpp"
#include "pdoik/solver.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// How a request went, as Solver::explain says.
std::string explain(const Model& model, const Scene& scene, const Request& request,
                    const Result& result);
/// What ends a motion along a path.
std::string explain(const Model& model, const Scene& scene, const PathEnd& end);
/// How a path went.
std::string explain(const Model& model, const Scene& scene, const PathRequest& request,
                    const PathResult& result);

}  // namespace pdoik::detail
