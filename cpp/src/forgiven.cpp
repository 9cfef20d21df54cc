#include "detail/forgiven.hpp"

#include <algorithm>

#include "detail/clearance.hpp"

namespace pdoik::detail {
namespace {

/// Whether any capsule of a hull stands beyond its link.
bool overhangs(const Robot& robot, const HullModel& model, const Hull& hull) {
  if (hull.has_pieces()) return false;
  const Occupancy& occupancy = robot.occupancy();
  const int first = static_cast<int>(occupancy.spheres.size() + occupancy.spheroids.size());
  for (int k = 0; k < 4 * hull.blocks; ++k) {
    const int source = model.capsules(hull)[k / 4].source[k % 4];
    if (source >= 0 && occupancy.capsules[static_cast<std::size_t>(source - first)].overhang > 0.0)
      return true;
  }
  return false;
}

}  // namespace

ForgivenContact::ForgivenContact(const Robot& robot, const Options& options)
    : robot_(robot),
      options_(options),
      whole_(robot, options.base_collision, false, options.exact_contact),
      hulls_(whole_.all()),
      state_(whole_, hulls_),
      capsules_(robot, whole_, hulls_, options.clearance) {
  for (std::size_t k = 0; k < hulls_.size(); ++k) {
    const Hull& hull = hulls_[k];
    if (hull.has_capsules() && is_placed_by_goal(robot, hull.body) &&
        overhangs(robot, whole_, hull))
      placed_.push_back(static_cast<int>(k));
  }
  state_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
}

void ForgivenContact::hold(const Scene& scene) {
  held_.reset();
  // How thick capsules are changes nothing of which hulls there are, so what is heeded of the
  // model's hulls is heeded of these.
  if (scene.held().count() > 0) held_.emplace(robot_, whole_, options_, scene.held());
}

WorstConstraint ForgivenContact::deepest(const std::vector<Eigen::Isometry3d>& T_base_body,
                                         const Scene& scene) {
  WorstConstraint deepest;
  if (placed_.empty()) return deepest;
  state_.place(T_base_body);
  capsules_.place(state_.positions(), state_.frames());
  if (held_) {
    held_->place([&](int body) { return to_frame(T_base_body[static_cast<std::size_t>(body)]); },
                 state_.positions(), state_.frames());
  }
  using Kind = WorstConstraint::Kind;
  const double tolerance = options_.clearance_tolerance;
  // Distances are beyond what is wanted. What is less deep than the deepest so far need not be
  // found.
  const auto within = [&] { return -tolerance - deepest.violation; };
  const auto note = [&](Kind kind, int index, int obstacle, double distance) {
    deepest = {kind, index, obstacle, -distance - tolerance};
  };
  for (const int k : placed_) {
    const Clearance point =
        least_clearance_of(state_, static_cast<std::size_t>(k), scene.obstacles(), within());
    if (point.source >= 0) note(Kind::Clearance, point.source, point.obstacle, point.distance);
    shapes_near(capsules_, k, scene.shapes(), within() + options_.clearance, [&](int part) {
      const ShapeClearance found =
          hull_clearance(capsules_, k, scene.shapes(), part, within() + options_.clearance);
      if (found.shape >= 0)
        note(Kind::Shape, found.source, found.shape, found.distance - options_.clearance);
      return within() + options_.clearance;
    });
    for (int held = 0; held_ && held < held_->count(); ++held) {
      if (const auto near = held_->nearest_of_hull(held, k, within()))
        note(near->kind, near->held, near->other, near->distance);
    }
  }
  return deepest;
}

}  // namespace pdoik::detail
