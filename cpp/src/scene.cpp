#include "detail/scene.hpp"

#include <atomic>
#include <cmath>
#include <stdexcept>

#include "detail/rows.hpp"

namespace pdoik::detail {
namespace {

std::uint64_t new_stamp() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

}  // namespace

Scene::Scene(const Model& model)
    : model_(model),
      hulls_(model.hulls),
      fixed_hulls_(model.hulls, model.hulls.fixed),
      margin_(model.options.clearance),
      tolerance_(model.options.clearance_tolerance),
      own_(std::make_shared<CloudState>()),
      cloud_(own_),
      held_stamp_(new_stamp()) {
  fixed_hulls_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  const auto count = static_cast<std::size_t>(model.options.max_obstacles);
  own_->change_unshared().reserve(count);
  copy_.reserve(count);
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
      fixed_to_shapes_(other.fixed_to_shapes_),
      held_(other.held_),
      held_stamp_(new_stamp()) {
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
  HullCapsules fixed(model_.robot, hulls_, hulls_.fixed, margin_);
  fixed.place(fixed_hulls_.positions(), fixed_hulls_.frames());
  fixed_to_shapes_ = least_clearance(fixed, shapes_);
  fixed_to_shapes_.capsule = nullptr;  // which ends here
  hold(held_.solids());
}

void Scene::attach(const std::string& link, std::span<const Shape> shapes,
                   std::span<const std::string> may_touch) {
  Held::Solids solids = held_.solids();
  for (const Shape& shape : shapes) {
    for (const auto& held : solids) {
      if (held->shape.name == shape.name)
        throw std::invalid_argument("'" + shape.name + "' is attached to '" + held->link + "'");
    }
    solids.push_back(std::make_shared<const HeldSolid>(
        model_.robot, link, shape, std::vector(may_touch.begin(), may_touch.end())));
  }
  hold(std::move(solids));
}

void Scene::detach(const std::string& link) {
  model_.robot.link_index(link);
  Held::Solids solids = held_.solids();
  std::erase_if(solids, [&](const auto& held) { return held->link == link; });
  hold(std::move(solids));
}

void Scene::hold(Held::Solids solids) {
  held_ = Held(std::move(solids), model_.robot, hulls_, shapes_);
  held_stamp_ = new_stamp();
  changed_ = true;
}

CloudState::Reading Scene::read() {
  Complaint complaint;
  CloudState::Reading reading = read(complaint);
  complaint.raise();
  return reading;
}

CloudState::Reading Scene::read(Complaint& complaint) {
  CloudState::Reading reading = cloud_->read();
  points_ = &reading.points();
  if (version_ != reading.version()) {
    version_ = reading.version();
    refresh();
  }
  const int things = points_->count() + shapes_.count() + held_.count();
  if (things > 0 && model_.robot.occupancy().empty() &&
      !model_.options.ignore_obstacles_without_hulls) {
    complaint.say(
        "robot '%s' has no hulls to keep off obstacles (%d points, %d shapes, %d things it holds): "
        "fit some with `pdoik occupancy` or Robot.from_urdf(..., hulls=True), and set its "
        "occupancy; Options with ignore_obstacles_without_hulls leave obstacles out of account",
        model_.robot.name().c_str(), points_->count(), shapes_.count(), held_.count());
  }
  return reading;
}

void Scene::refresh() {
  changed_ = true;
  points_stamp_ = new_stamp();
  const ObstacleSet& points = *points_;
  padded_points_ = points.padded();
  within_reach_ =
      std::isfinite(hulls_.reach)
          ? points.count_within(hulls_.reach_centre, hulls_.reach + 2.0 * std::max(margin_, 0.0))
          : points.count();
  fixed_ = least_clearance_within(fixed_hulls_, obstacles(), 0.0, {});
}

}  // namespace pdoik::detail
