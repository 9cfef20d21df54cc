#pragma once

#include "kinematics/rollout.hpp"

namespace pdoik::detail {

/// dc/dpoint of a constraint c, by a point that moves with a body.
struct PointGradient {
  int body;
  Vec4 point, dc_dpoint;
};

/// The gradients of a constraint by points: a point may be there twice, and the sum counts.
struct PointGradients {
  PointGradient each[4];
  int count = 0;

  PointGradient& add(int body, const Vec4& point, const Vec4& dc_dpoint) {
    return each[count++] = {body, point, dc_dpoint};
  }
  const PointGradient* begin() const { return each; }
  const PointGradient* end() const { return each + count; }
};

/// The derivatives of a ConstraintFamily whose constraints have `gradients`.
struct ByPointGradients {
  template <class Near>
  void add_row(const Near& at, const Rollout& rollout, double* row) const {
    for (const auto& [body, point, direction] : at.gradients)
      rollout.add_row(body, direction, cross3(point, direction), row);
  }
  template <class Near>
  void add_wrenches(const Near& at, double slope, Rollout& rollout) const {
    for (const auto& [body, point, direction] : at.gradients)
      rollout.add_force(body, point, broadcast(slope) * direction);
  }
};

}  // namespace pdoik::detail
