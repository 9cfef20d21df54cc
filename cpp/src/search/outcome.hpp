#pragma once

#include <optional>
#include <span>

#include "common/deadline.hpp"
#include "obstacles/scene.hpp"
#include "pdoik/result.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// Why no answer can exist, if that is known without a search.
/// @param base_collides  Whether an obstacle is in a hull that no joint moves.
std::optional<Status> why_hopeless(const Model& model, std::span<const Goal> goals,
                                   bool base_collides);

/// Where the status is BaseCollision, let the worst constraint be what made it that: the deepest
/// contact of a hull that no joint moves, whatever else is deeper.
void name_base_contact(const Scene& scene, const Options& options, Result& result);

/// Forget how much work an earlier solve took.
/// What of a robot's fixed hulls is deepest in what: what makes a solve hopeless whose status is
/// BaseCollision, whatever else is deeper.
WorstConstraint base_contact(const Scene& scene, const Options& options);
void begin_result(Result& result);
/// Say how a solve ended, and when.
void end_result(const std::optional<Status>& hopeless, const Deadline& deadline, double intake,
                Result& result);

}  // namespace pdoik::detail
