#include "obstacles/placed_travel.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {

double travel_from(const Rollout& rollout, const CollisionState& hulls, const Hull& hull,
                   const Eigen::VectorXd& step, double share, int carrier) {
  const auto [centre, half, semi_major] = hulls.around(hull);
  // Foci may be farther apart than what they hold is long.
  const double size = std::max(semi_major, std::sqrt(dot3(half, half)));
  double farthest = 0.0;
  const auto visit = [&](int body) {
    // Seen from a joint, only those that come after it have moved the hull's centre so far.
    double sum = 0.0;
    const auto add = [&](int dof, double multiplier, bool prismatic, const Frame& at) {
      const double moves = std::abs(multiplier) * share * step[dof];
      if (multiplier == 0.0 || moves == 0.0) return;
      const Vec4 off_axis = cross3(at.z, centre - at.p);
      const double arm = std::sqrt(dot3(off_axis, off_axis)) + size + sum;
      sum += prismatic ? moves : std::min(moves, 2.0) * arm;
    };
    rollout.for_each_joint(body, add, carrier);
    farthest = std::max(farthest, sum);
  };
  if (hull.has_capsules()) {
    visit(hull.body);
  } else {
    for (const int point : {hull.a, hull.b}) visit(hulls.body_of_point(point));
  }
  return farthest;
}

}  // namespace pdoik::detail
