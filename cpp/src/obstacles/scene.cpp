#include "obstacles/scene.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>

#include "common/named_things.hpp"
#include "common/text.hpp"
#include "obstacles/rows.hpp"

namespace pdoik::detail {
namespace {

std::uint64_t new_stamp() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

}  // namespace

Scene::Scene(const Robot& robot, const HullModel& hulls, const Options& options)
    : robot_(robot),
      hulls_(hulls),
      options_(options),
      fixed_hulls_(hulls, hulls.fixed),
      margin_(options.clearance),
      tolerance_(options.clearance_tolerance),
      own_(std::make_shared<CloudState>()),
      cloud_(own_),
      alone_(robot),
      pairs_(alone_),
      attachments_stamp_(new_stamp()) {
  fixed_hulls_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  const auto count = static_cast<std::size_t>(options.max_obstacles);
  own_->change_unshared().reserve(count);
  copy_.reserve(count);
  if (count > static_cast<std::size_t>(ObstacleSet::kLarge)) order_.reserve(count);
  assign(Eigen::Matrix<double, 0, 3, Eigen::RowMajor>());
}

Scene::Scene(const Scene& other)
    : robot_(other.robot_),
      hulls_(other.hulls_),
      options_(other.options_),
      fixed_hulls_(hulls_, hulls_.fixed),
      margin_(other.margin_),
      tolerance_(other.tolerance_),
      own_(other.own_),
      cloud_(other.cloud_),
      alone_(other.alone_),
      pairs_(other.pairs_),
      plain_(other.plain_),
      attachments_stamp_(new_stamp()),
      links_stamp_(other.links_stamp_) {
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
  if (shapes != pairs_.shapes.set()) take(std::move(shapes), pairs_.attachments.solids(), true);
}

void Scene::attach(std::span<const Attachment> things) {
  Attachments::Solids solids = pairs_.attachments.solids();
  for (const Attachment& thing : things) {
    std::ranges::for_each(thing.contacts, check_contact_rule);
    const auto rules = std::make_shared<const std::vector<ContactRule>>(thing.contacts);
    for (const Shape& shape : thing.shapes) {
      for (const auto& attached : solids) {
        if (attached->shape.name == shape.name)
          throw std::invalid_argument("'" + shape.name + "' is attached to '" +
                                      attached->links.front() + "'");
      }
      solids.push_back(std::make_shared<const AttachedSolid>(robot_, thing.links, shape, rules));
    }
  }
  take(pairs_.shapes.set(), std::move(solids), false);
}

void Scene::attach(const std::string& link, std::span<const Shape> shapes,
                   std::span<const std::string> may_touch) {
  Attachment thing{{link}, {shapes.begin(), shapes.end()}};
  for (const Shape& shape : shapes)
    for (const std::string& name : may_touch) thing.contacts.push_back({shape.name, name});
  attach({&thing, 1});
}

std::vector<Attachment> Scene::attached() const {
  std::vector<Attachment> things;
  const AttachedSolid* last = nullptr;
  for (const auto& attached : pairs_.attachments.solids()) {
    const bool is_more =
        last != nullptr && last->rules == attached->rules && last->links == attached->links;
    if (!is_more) things.push_back({attached->links, {}, *attached->rules});
    things.back().shapes.push_back(attached->shape);
    last = attached.get();
  }
  return things;
}

void Scene::detach(const std::string& name) {
  Attachments::Solids solids;
  const bool is_link = robot_.find_link(name).has_value();
  bool is_there = is_link;
  for (const auto& attached : pairs_.attachments.solids()) {
    const auto at = std::ranges::find(attached->links, name);
    const bool is_it = attached->shape.name == name || object_of(attached->shape.name) == name;
    is_there = is_there || is_it;
    if (is_link && at != attached->links.end() && at != attached->links.begin()) {
      std::vector<std::string> others = attached->links;
      std::erase(others, name);
      solids.push_back(std::make_shared<const AttachedSolid>(robot_, std::move(others),
                                                             attached->shape, attached->rules));
    } else if (is_link ? at == attached->links.end() : !is_it) {
      solids.push_back(attached);
    }
  }
  if (!is_there) {
    std::vector<std::string> names = robot_.link_names();
    for (const auto& attached : pairs_.attachments.solids()) names.push_back(attached->shape.name);
    const std::vector<std::string> near = nearest_names(name, names);
    throw std::invalid_argument(
        "'" + name + "' is neither a link of '" + robot_.name() + "' nor attached to one (" +
        (near.empty() ? "there are: " + join(names) : "nearest: " + join(near)) + ")");
  }
  take(pairs_.shapes.set(), std::move(solids), false);
}

void Scene::detach() { take(pairs_.shapes.set(), {}, false); }

PairMargins Scene::margins_of(const ShapeSet& shapes, const Attachments::Solids& solids,
                              bool anew) const {
  PairMargins::Things things{{}, shapes.names};
  std::vector<ContactRule> of_attached;
  const std::vector<ContactRule>* last = nullptr;
  for (const auto& attached : solids) {
    things.attached.push_back(attached->shape.name);
    if (attached->rules.get() != last)
      of_attached.insert(of_attached.end(), attached->rules->begin(), attached->rules->end());
    last = attached->rules.get();
  }
  std::vector<ContactRule> of_scene = shapes.contacts;
  // Rules that were taken in may speak of what has been put down since.
  for (ContactRule& rule : of_scene) rule.optional = rule.optional || !anew;
  const PairMargins::Rules rules{of_scene, of_attached};
  if (rules.empty()) return alone_;
  return PairMargins(robot_, options_, things, rules);
}

void Scene::take(std::shared_ptr<const ShapeSet> shapes, Attachments::Solids solids, bool anew) {
  PairMargins margins = margins_of(*shapes, solids, anew);
  HullCapsules fixed(robot_, hulls_, hulls_.fixed, margin_);
  fixed.place(fixed_hulls_.positions(), fixed_hulls_.frames());
  std::optional<Pairs> plain;
  if (margins.have_own())
    plain.emplace(robot_, hulls_, shapes, solids, margins.without_own(), fixed);
  Pairs pairs(robot_, hulls_, std::move(shapes), std::move(solids), std::move(margins), fixed);
  const bool lets_in = std::ranges::any_of(pairs.points, [&](double margin) {
    return std::isfinite(margin) && options_.clearance + margin < 0.0;
  });
  if (lets_in &&
      (options_.method == Method::Paper || options_.inner != InnerMethod::LevenbergMarquardt))
    throw std::invalid_argument(
        "a contact rule gives points a negative clearance, which is for method 'default' with "
        "inner 'levenberg_marquardt'");
  if (!pairs.margins.are_alike_of_links(pairs_.margins)) links_stamp_ = new_stamp();
  if (pairs.points != pairs_.points) version_ = -1;
  pairs_ = std::move(pairs);
  plain_ = std::move(plain);
  attachments_stamp_ = new_stamp();
  changed_ = true;
}

CloudState::Reading Scene::read() {
  InputError error;
  CloudState::Reading reading = read(error);
  error.raise();
  return reading;
}

CloudState::Reading Scene::read(InputError& error) {
  CloudState::Reading reading = cloud_->read();
  points_ = &reading.points();
  if (version_ != reading.version()) {
    version_ = reading.version();
    refresh();
  }
  const int things = points_->count() + shapes().count() + attachments().count();
  if (things > 0 && robot_.occupancy().empty() && !options_.ignore_obstacles_without_hulls) {
    error.say(
        "robot '%s' has no hulls to keep off obstacles (%d points, %d shapes, %d attached things): "
        "fit some with `pdoik occupancy` or Robot.from_urdf(..., hulls=True), and set its "
        "occupancy; Options with ignore_obstacles_without_hulls leave obstacles out of account",
        robot_.name().c_str(), points_->count(), shapes().count(), attachments().count());
  }
  return reading;
}

void Scene::refresh() {
  changed_ = true;
  points_stamp_ = new_stamp();
  const ObstacleSet& points = *points_;
  padded_points_ = points.padded();
  within_reach_ = std::isfinite(hulls_.reach)
                      ? points.count_within(
                            hulls_.reach_centre,
                            hulls_.reach + 2.0 * std::max(margin_ + pairs_.most_point_margin, 0.0))
                      : points.count();
  fixed_ = least_clearance_within(fixed_hulls_, obstacles(), 0.0, {});
}

}  // namespace pdoik::detail
