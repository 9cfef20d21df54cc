#pragma once

#include <concepts>
#include <cstdint>

#include "kinematics/rollout.hpp"

namespace pdoik::detail {

/// Which constraint of a family it is, the same from one configuration to another: its group, which
/// says together how near is near, and its place in that.
using ConstraintKey = std::uint64_t;
inline ConstraintKey constraint_key(int group, int member) {
  return static_cast<ConstraintKey>(group) << 32U | static_cast<std::uint32_t>(member);
}
inline int group_of(ConstraintKey key) { return static_cast<int>(key >> 32U); }

/// Constraints c <= 0 of one kind [m], as both forms of the problem use them. Another kind is one
/// class like this, and a place in `Constraints`.
///
///     wants_points()                whether it looks at the hulls' points: they are placed before
///     groups()                      how many
///     find(rollout, reach)          finds those with c > -reach(group), where a rollout is
///     count(), key(k)               how many were found, and which the k-th is: keys ascend
///     at(k)                         its value c, and what its derivatives are made of
///     add_row(at, rollout, row)     adds dc/dq to row, shape (n,)
///     add_wrenches(at, slope, rollout)  adds the wrenches of dL/dc = slope
///
/// Nothing of this allocates.
template <class F>
concept ConstraintFamily =
    requires(F family, Rollout& rollout, double (*reach)(int), int k, double slope, double* row) {
      { family.wants_points() } -> std::same_as<bool>;
      { family.groups() } -> std::same_as<int>;
      family.find(rollout, reach);
      { family.count() } -> std::same_as<int>;
      { family.key(k) } -> std::same_as<ConstraintKey>;
      { family.at(k).c } -> std::convertible_to<double>;
      family.add_row(family.at(k), rollout, row);
      family.add_wrenches(family.at(k), slope, rollout);
    };

}  // namespace pdoik::detail
