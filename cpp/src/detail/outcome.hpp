#pragma once

#include <optional>
#include <span>

#include "detail/deadline.hpp"
#include "detail/model.hpp"
#include "pdoik/result.hpp"

namespace pdoik::detail {

/// Why no answer can exist, if that is known without a search.
/// @param base_collides  Whether an obstacle is in a hull that no joint moves.
std::optional<Status> why_hopeless(const Model& model, std::span<const Goal> goals,
                                   bool base_collides);

/// Forget how much work an earlier solve took.
void begin_result(Result& result);
/// Say how a solve ended, and when.
void end_result(const std::optional<Status>& hopeless, const Deadline& deadline, double intake,
                Result& result);

}  // namespace pdoik::detail
