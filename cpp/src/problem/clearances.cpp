#include "problem/clearances.hpp"

#include "obstacles/attachment_clearance.hpp"

namespace pdoik::detail {

std::vector<ObstacleClearance> clearances(const Model& model, const Scene& scene,
                                          const Eigen::VectorXd& q) {
  std::vector<Eigen::Isometry3d> T_base_body(model.robot.bodies().size());
  model.robot.body_poses(q, T_base_body);
  const std::vector<Hull> hulls = model.hulls.all();
  CollisionState state(model.hulls, hulls);
  state.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  state.place(T_base_body);
  HullCapsules capsules(model.robot, model.hulls, hulls, model.options.clearance);
  capsules.place(state.positions(), state.frames());
  const Pairs& pairs = scene.plain_pairs();
  AttachmentClearance attached(model.robot, model.hulls, model.options, pairs.attachments);
  attached.place([&](int body) { return to_frame(T_base_body[static_cast<std::size_t>(body)]); },
                 state.positions(), state.frames());

  const double wanted = model.options.clearance;
  std::vector<ObstacleClearance> result;
  const auto add = [&](ObstacleClearance nearest, auto&& of_attached) {
    for (int k = 0; k < attached.count(); ++k) {
      const std::optional<AttachmentNear> near = of_attached(k, nearest.distance - wanted);
      if (near) nearest = {nearest.shape, near->distance + wanted, -1, k, near->other};
    }
    if (nearest.shape >= 0) nearest.point = -1;
    result.push_back(nearest);
  };
  const ShapePairs& shapes = pairs.shapes;
  for (int part = 0; part < shapes.parts();) {
    const int shape = shapes.owner(part), first = part;
    ObstacleClearance nearest{shape, std::numeric_limits<double>::infinity(), -1, -1, -1};
    for (; part < shapes.parts() && shapes.owner(part) == shape; ++part) {
      for (int k = 0; k < capsules.count(); ++k) {
        const ShapeClearance found = hull_clearance(capsules, k, shapes, part, nearest.distance);
        if (found.shape >= 0) nearest = {shape, found.distance, found.source, -1, -1};
      }
    }
    add(nearest, [&](int k, double within) {
      std::optional<AttachmentNear> least;
      for (int of = first; of < part; ++of) {
        if (auto near = attached.nearest_of_part(k, shapes, of, within)) {
          within = near->distance;
          least = near;
        }
      }
      return least;
    });
  }
  if (scene.obstacles()->count() > 0) {
    const ObstacleView points = scene.obstacles(pairs);
    const Clearance least = least_clearance(state, points);
    add({-1, least.distance + wanted, least.source, -1, least.obstacle},
        [&](int k, double within) { return attached.nearest_point(k, points, within); });
  }
  return result;
}

}  // namespace pdoik::detail
