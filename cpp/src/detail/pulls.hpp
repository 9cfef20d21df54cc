#pragma once

#include "detail/rollout.hpp"

namespace pdoik::detail {

/// dc/dpoint of a constraint c, by a point that moves with a body.
struct Pull {
  int body;
  Vec4 point, dc_dpoint;
};

/// What pulls at a constraint: a point may be there twice, and the sum counts.
struct Pulls {
  Pull each[4];
  int count = 0;

  Pull& add(int body, const Vec4& point, const Vec4& dc_dpoint) {
    return each[count++] = {body, point, dc_dpoint};
  }
  const Pull* begin() const { return each; }
  const Pull* end() const { return each + count; }
};

/// The derivatives of a ConstraintFamily whose constraints have `pulls`.
struct ByPulls {
  template <class Near>
  void add_row(const Near& at, const Rollout& rollout, double* row) const {
    for (const auto& [body, point, direction] : at.pulls)
      rollout.add_row(body, direction, cross3(point, direction), row);
  }
  template <class Near>
  void add_wrenches(const Near& at, double slope, Rollout& rollout) const {
    for (const auto& [body, point, direction] : at.pulls)
      rollout.add_force(body, point, broadcast(slope) * direction);
  }
};

}  // namespace pdoik::detail
