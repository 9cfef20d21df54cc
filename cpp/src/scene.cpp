#include "detail/scene.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

/// Cells are not spread over more than this to each side: beyond it a cloud's order hardly matters
/// [m].
constexpr double kLargestCube = 50.0;
/// Rows that are fetched ahead of their turn, since their order in memory is another.
constexpr int kAhead = 16;
/// Out of reach, cells are this much larger: what is farther still matters least.
constexpr double kFarCube = 4.0;
/// Where the arm's reach has no bound, they are where most of a cloud is [m].
constexpr double kUsualCube = 4.0;

}  // namespace

Scene::Scene(const Model& model) : fixed_hulls_(model.hulls, model.hulls.fixed) {
  const auto count = static_cast<std::size_t>(model.options.max_obstacles);
  near.reserve(count);
  far.reserve(count);
  if (count > static_cast<std::size_t>(ObstacleSet::kLarge)) order_.reserve(count);
  assign(Points(Eigen::Matrix<double, 0, 3, Eigen::RowMajor>()), model);
}

void Scene::assign(const Points& points, const Model& model) {
  const HullModel& hulls = model.hulls;
  const double margin = model.options.clearance;
  const auto count = static_cast<int>(points.rows());
  const bool has_radius = points.cols() > 3, large = count > ObstacleSet::kLarge;
  const Eigen::Vector3d& root = hulls.reach_centre;
  const auto radius_of = [&](int i) { return (has_radius ? points(i, 3) : 0.0) + margin; };
  const auto add_to = [&](ObstacleSet& set, int i) {
    set.add(points(i, 0), points(i, 1), points(i, 2), radius_of(i), i);
  };
  far_bound = std::numeric_limits<double>::infinity();
  const auto is_far = [&](int i) {
    const double dx = points(i, 0) - root.x(), dy = points(i, 1) - root.y(),
                 dz = points(i, 2) - root.z(), square = dx * dx + dy * dy + dz * dz;
    const double radius = radius_of(i), within = hulls.reach + hulls.clear_beyond(radius);
    if (within >= 0.0 && square <= within * within) return false;  // most, without a root
    const double distance = hulls.distance_from(std::sqrt(square) - hulls.reach, radius);
    if (!(distance > 0.0)) return false;
    far_bound = std::min(far_bound, distance);
    return true;
  };
  if (large) {
    const double cube =
        std::isfinite(hulls.reach) ? std::min(hulls.reach, kLargestCube) : kUsualCube;
    order_.begin(count, root, cube, std::min(kFarCube * cube, kLargestCube));
    for (int i = 0; i < count; ++i) order_.add(points(i, 0), points(i, 1), points(i, 2), is_far(i));
    const std::vector<int>& sorted = order_.sorted();
    const int near_count = order_.near_count();
    near.begin(near_count, root);
    far.begin(count - near_count, root);
    for (int k = 0; k < count; ++k) {
      const int soon = sorted[static_cast<std::size_t>(std::min(k + kAhead, count - 1))];
      const double* const row = points.data() + soon * points.outerStride();
      __builtin_prefetch(row);
      __builtin_prefetch(row + 2);  // which may lie in another line of the cache
      add_to(k < near_count ? near : far, sorted[static_cast<std::size_t>(k)]);
    }
  } else {
    near.begin(count, root);
    far.begin(count, root);
    for (int i = 0; i < count; ++i) add_to(is_far(i) ? far : near, i);
  }
  fixed_far_bound = far_bound + hulls.distance_from(hulls.reach - hulls.fixed_reach, 0.0);
  near.finish(large);
  far.finish(large);
  fixed_hulls_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  fixed = least_clearance_within(fixed_hulls_, near, 0.0, {});
  if (hulls.fixed_reach > hulls.reach)
    fixed = least_clearance_within(fixed_hulls_, far, 0.0, fixed);
}

Clearance Scene::clearance(CollisionState& moving, CollisionState& fixed_hulls, bool within_limits,
                           double look) const {
  Clearance least = least_clearance(moving, near, {look, -1, -1});
  least = least_clearance(fixed_hulls, near, least);
  if (!within_limits || least.distance > far_bound) least = least_clearance(moving, far, least);
  if (least.distance > fixed_far_bound) least = least_clearance(fixed_hulls, far, least);
  return least;
}

}  // namespace pdoik::detail
