#include "search/common_contacts.hpp"

#include <algorithm>

#include "obstacles/clearance.hpp"

namespace pdoik::detail {
namespace {

/// What of a hull touches a part of a shape or, where that is negative, points; none if nothing
/// does.
std::optional<WorstConstraint> contact(Problem& problem, int hull, int part) {
  using Kind = WorstConstraint::Kind;
  const Options& options = problem.model.options;
  Constraints& constraints = problem.constraints;
  const double tolerance = options.clearance_tolerance;
  if (part >= 0) {
    const ShapeClearance found = constraints.shapes.clearance(problem.scene->shapes(), hull, part,
                                                              options.clearance - tolerance);
    if (found.shape < 0) return std::nullopt;
    return WorstConstraint{Kind::Shape, found.source, found.shape,
                           options.clearance - found.distance - tolerance};
  }
  const Clearance found = least_clearance_of(constraints.hulls, static_cast<std::size_t>(hull),
                                             problem.scene->obstacles(), -tolerance);
  if (found.source < 0) return std::nullopt;
  return WorstConstraint{Kind::Clearance, found.source, found.obstacle,
                         -found.distance - tolerance};
}

/// Whether there is such a contact.
bool touches(Problem& problem, int hull, int part) {
  if (part >= 0) return contact(problem, hull, part).has_value();
  return any_nearer(problem.constraints.hulls, static_cast<std::size_t>(hull),
                    problem.scene->obstacles(), -problem.model.options.clearance_tolerance);
}

}  // namespace

void CommonContacts::note(Problem& problem) {
  if (++starts_ < kFirstFew || (starts_ > kFirstFew && pairs_.empty())) return;
  problem.constraints.hulls.place(problem.rollout);
  problem.constraints.shapes.place(problem.constraints.hulls);
  if (starts_ > kFirstFew) {
    std::erase_if(pairs_,
                  [&](const Pair& pair) { return !touches(problem, pair.hull, pair.part); });
    return;
  }
  const int hulls = static_cast<int>(problem.model.hulls.moving.size());
  const double than = problem.model.options.clearance - problem.model.options.clearance_tolerance;
  const auto keep_if_touching = [&](int hull, int part) {
    if (pairs_.size() < kMost && touches(problem, hull, part)) pairs_.push_back({hull, part});
  };
  int turn = 0;
  for (int hull = 0; hull < hulls; ++hull) {
    if (problem.is_late(turn++)) return;
    if (problem.scene->within_reach() > 0) keep_if_touching(hull, -1);
    problem.constraints.shapes.near(problem.scene->shapes(), hull, than, [&](int part) {
      // A field is many things: to touch it twice need not be the same contact.
      if (!problem.scene->shapes().part(part).is_field()) keep_if_touching(hull, part);
      return problem.is_late(turn++) ? kNoMore : than;
    });
  }
}

std::optional<WorstConstraint> CommonContacts::deepest(Problem& problem) const {
  problem.constraints.hulls.place(problem.rollout);
  problem.constraints.shapes.place(problem.constraints.hulls);
  std::optional<WorstConstraint> deepest;
  for (const Pair& pair : pairs_) {
    const auto found = contact(problem, pair.hull, pair.part);
    if (found && (!deepest || found->violation > deepest->violation)) deepest = found;
  }
  return deepest;
}

}  // namespace pdoik::detail
