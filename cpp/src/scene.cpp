#include "detail/scene.hpp"

#include <cmath>

#include "detail/rows.hpp"

namespace pdoik::detail {
Scene::Scene(const Model& model)
    : model_(model),
      hulls_(model.hulls),
      fixed_hulls_(model.hulls, model.hulls.fixed),
      margin_(model.options.clearance),
      tolerance_(model.options.clearance_tolerance),
      own_(std::make_shared<CloudState>()),
      cloud_(own_) {
  fixed_hulls_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  const auto count = static_cast<std::size_t>(model.options.max_obstacles);
  own_->change_unshared().reserve(count);
  if (count > static_cast<std::size_t>(ObstacleSet::kLarge)) order_.reserve(count);
  assign(Eigen::Matrix<double, 0, 3, Eigen::RowMajor>());
}

Scene::Scene(const Model& model, const Scene& other)
    : model_(model),
      hulls_(model.hulls),
      fixed_hulls_(model.hulls, model.hulls.fixed),
      margin_(other.margin_),
      tolerance_(other.tolerance_),
      own_(other.own_),
      cloud_(other.cloud_),
      shapes_(other.shapes_),
      fixed_to_shapes_(other.fixed_to_shapes_) {
  fixed_hulls_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  intake = other.intake;
}

void Scene::assign(const Points& points) {
  // One of the two is this scene's other handle.
  if (own_ == nullptr || own_.use_count() > 2) own_ = std::make_shared<CloudState>();
  cloud_ = own_;
  own_->change_unshared().assign(static_cast<int>(points.rows()), order_,
                                 RowsOf<Points>{points, points.cols() > 3});
  version_ = -1;
}

void Scene::use(std::shared_ptr<const CloudState> cloud) {
  intake = 0.0;
  if (cloud == cloud_ && own_ == nullptr) return;
  own_ = nullptr;
  cloud_ = std::move(cloud);
  version_ = -1;
}

void Scene::use(std::shared_ptr<const ShapeSet> shapes) {
  if (shapes == shapes_.set()) return;
  shapes_ = ShapePairs(std::move(shapes), model_.robot);
  HullCapsules fixed(model_.robot, hulls_, hulls_.fixed);
  fixed.place(fixed_hulls_.positions(), fixed_hulls_.frames());
  fixed_to_shapes_ = least_clearance(fixed, shapes_);
  fixed_to_shapes_.capsule = nullptr;  // which ends here
  changed_ = true;
}

std::shared_lock<std::shared_mutex> Scene::read() {
  std::shared_lock<std::shared_mutex> lock;
  if (own_ == nullptr) lock = cloud_->read();  // nobody updates one of its own
  if (version_ != cloud_->version()) refresh();
  return lock;
}

void Scene::refresh() {
  version_ = cloud_->version();
  changed_ = true;
  const ObstacleSet& points = cloud_->points();
  within_reach_ =
      std::isfinite(hulls_.reach)
          ? points.count_within(hulls_.reach_centre, hulls_.reach + 2.0 * std::max(margin_, 0.0))
          : points.count();
  fixed_ = least_clearance_within(fixed_hulls_, obstacles(), 0.0, {});
}

Clearance Scene::clearance(CollisionState& moving, CollisionState& fixed_hulls, double look) const {
  const Clearance least = least_clearance(moving, obstacles(), {look, -1, -1});
  return least_clearance(fixed_hulls, obstacles(), least);
}

}  // namespace pdoik::detail
