#include "hulls/hull_capsules.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdoik::detail {
namespace {

/// Of a capsule; infinite where nobody knows, or nothing of it needs to be its link's.
double overhang_of(const Robot& robot, int source) {
  const Occupancy& all = robot.occupancy();
  const std::size_t first = all.spheres.size() + all.spheroids.size();
  const Capsule& capsule = all.capsules[static_cast<std::size_t>(source) - first];
  return capsule.overhang > 0.0 && capsule.overhang < capsule.radius
             ? capsule.overhang
             : std::numeric_limits<double>::infinity();
}

}  // namespace

HullCapsules::HullCapsules(const Robot& robot, const HullModel& model,
                           const std::vector<Hull>& hulls, double exact_below)
    : exact_below_(exact_below),
      blocks_(model.blocks),
      pieces_(model.pieces),
      piece_ids_(model.piece_ids) {
  for (const AttachedPoint& point : model.points) body_of_point_.push_back(point.body);
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(robot.mid_configuration(), T_base_body);
  const auto position = [&](int point) {
    const AttachedPoint& p = model.points[static_cast<std::size_t>(point)];
    return Eigen::Vector3d(T_base_body[static_cast<std::size_t>(p.body)] * to_vector3(p.local));
  };
  for (const Hull& each : hulls) {
    const double A = each.semi_major, h = 0.5 * (position(each.b) - position(each.a)).norm();
    const double B = std::sqrt(std::max((A - h) * (A + h), 0.0));
    hulls_.push_back({each.a, each.b, A, each.rigid, B, h / (A + B), Vec4{}, PlacedCapsule{},
                      each.body, each.first_block, each.excess, each.first_piece, each.pieces});
    PlacedHull& hull = hulls_.back();
    hull.around.source = each.source;
    hull.around.reach = A;  // the capsule around a spheroid ends where that does
    hull.first = static_cast<int>(capsules_.size());
    for (int k = 0; k < 4 * each.blocks; ++k) {
      const CapsuleBlock& block = blocks_[static_cast<std::size_t>(each.first_block + k / 4)];
      if (block.source[k % 4] < 0) continue;  // padding, which comes last
      const Vec4 along{block.vx[k % 4], block.vy[k % 4], block.vz[k % 4], 0.0};
      const double radius = block.radius[k % 4];
      capsules_.push_back({Vec4{}, Vec4{}, radius, 0.5 * std::sqrt(dot3(along, along)) + radius,
                           block.source[k % 4], overhang_of(robot, block.source[k % 4])});
      ++hull.count;
    }
  }
  middles_.resize(hulls_.size());
}

std::size_t HullCapsules::most() const {
  int most = 1;
  for (const PlacedHull& hull : hulls_) most = std::max(most, hull.count);
  return static_cast<std::size_t>(most);
}

void HullCapsules::place(const Vec4* positions, const Frame* frames) {
  positions_ = positions;
  frames_ = frames;
  Vec4* middle = middles_.data();
  for (PlacedHull& hull : hulls_) {
    hull.is_placed = false;
    const Vec4 &a = positions[hull.a], &b = positions[hull.b];
    if (hull.a == hull.b) {
      hull.around.middle = *middle++ = a;
      hull.around.radius = hull.semi_major;
      continue;
    }
    hull.between = broadcast(0.5) * (b - a);
    if (!hull.rigid) {
      const double A = hull.semi_major, h = std::sqrt(dot3(hull.between, hull.between));
      hull.minor = h < A ? std::sqrt((A - h) * (A + h)) : 0.0;
      hull.shape = h / (A + hull.minor);
    }
    const bool hollow = !(hull.minor > 0.0);
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    hull.around.middle = *middle++ = hollow ? broadcast(kNaN) : broadcast(0.5) * (a + b);
    hull.around.half = broadcast(hull.shape) * hull.between;
    hull.around.radius = hull.minor;
  }
}

std::span<const PlacedCapsule> HullCapsules::of(int k) {
  PlacedHull& hull = hulls_[static_cast<std::size_t>(k)];
  if (hull.count == 0) return {&hull.around, 1};
  const std::span<PlacedCapsule> capsules(capsules_.data() + hull.first,
                                          static_cast<std::size_t>(hull.count));
  if (hull.is_placed) return capsules;
  hull.is_placed = true;
  const Frame& frame = frames_[hull.body];
  for (std::size_t n = 0; n < capsules.size(); ++n) {
    const CapsuleBlock& block = blocks_[static_cast<std::size_t>(hull.first_block) + n / 4];
    const std::size_t i = n % 4;
    const Vec4 half = broadcast(0.5) * Vec4{block.vx[i], block.vy[i], block.vz[i], 0.0};
    capsules[n].middle = transform(frame, Vec4{block.ax[i], block.ay[i], block.az[i], 0.0} + half);
    capsules[n].half = rotate(frame, half);
  }
  return capsules;
}

void HullCapsules::add_gradient(int k, const PlacedCapsule& capsule, double t, const Vec4& force,
                                PointGradients& gradients) const {
  const PlacedHull& hull = this->hull(k);
  const auto add_focus = [&](int point, const Vec4& dc_dpoint) -> Vec4& {
    const int body = body_of_point_[static_cast<std::size_t>(point)];
    return gradients.add(body, positions_[point], dc_dpoint).dc_dpoint;
  };
  if (hull.count > 0) {
    gradients.add(hull.body, capsule.middle + broadcast(t) * capsule.half, force);
    return;
  }
  if (hull.a == hull.b) {
    add_focus(hull.a, force);
    return;
  }
  // The point is m + t s g. By the envelope theorem t may be held.
  const double lean = t * hull.shape;
  Vec4& by_a = add_focus(hull.a, broadcast(0.5 * (1.0 - lean)) * force);
  Vec4& by_b = add_focus(hull.b, broadcast(0.5 * (1.0 + lean)) * force);
  if (hull.rigid) return;
  const double A = hull.semi_major, B = hull.minor, h = std::sqrt(dot3(hull.between, hull.between));
  if (!(h > 1e-12 * A)) return;  // the derivative with respect to h vanishes with it
  const double dc_dh = t * dot3(force, hull.between) * A / (B * (A + B)) - h / B;
  const Vec4 stretch = broadcast(0.5 * dc_dh / h) * hull.between;  // dh/db = g / 2h = -dh/da
  by_a -= stretch;
  by_b += stretch;
}

}  // namespace pdoik::detail
