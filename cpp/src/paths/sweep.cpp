#include "paths/sweep.hpp"

#include <cmath>
#include <numeric>

#include "hulls/travel.hpp"
#include "obstacles/clearance.hpp"
#include "obstacles/placed_travel.hpp"

namespace pdoik::detail {
namespace {

/// A way is halved so often, at most: into pieces of a millionth.
constexpr std::size_t kDeepest = 20;

}  // namespace

Sweep::Sweep(Workspace& workspace)
    : workspace_(workspace),
      model_(workspace.model()),
      state_(model_.hulls, model_.hulls.moving),
      capsules_(model_.robot, model_.hulls, model_.hulls.moving, model_.options.clearance),
      finest_(finest_piece(model_.narrowest)),
      left_(kDeepest + 1),
      displacement_bounds_(model_.displacement_bounds) {
  state_.reserve(static_cast<int>(CollisionState::kChunk), CollisionState::kChunk);
  state_.allow(&workspace.problem.allowed_contact);
  capsules_.allow(&workspace.problem.allowed_contact);
  for (Eigen::VectorXd* each : {&probe_.q, &fault_.q, &at_, &step_, &attachment_bounds_, &fault_q_})
    each->setZero(model_.robot.dof());
  const bool keeps_off = model_.options.keeps_off_itself(model_.robot);
  all_ = keeps_off ? model_.whole.all() : model_.hulls.all();
  if (keeps_off) {
    self_.emplace(model_.robot, model_.whole, model_.options.self_clearance,
                  workspace.scene().pairs().margins);
    for (int k = 0; k < self_->pair_count(); ++k) {
      const auto& [one, other] = self_->pair(k).hull;
      pairs_.push_back({{one, other}, common_body(one, other)});
    }
  }
  const Attachments& attached = workspace.scene().attachments();
  if (attached.count() > 0)
    attachments_.emplace(model_.robot, model_.hulls, model_.options, attached);
  everything_.resize(model_.hulls.moving.size() + pairs_.size() +
                     static_cast<std::size_t>(attached.count()));
  std::iota(everything_.begin(), everything_.end(), 0);
}

int Sweep::common_body(int one, int other) const {
  // Bodies come after those that carry them.
  std::vector<int> bodies;
  for (const int k : {one, other}) {
    const Hull& hull = all_[static_cast<std::size_t>(k)];
    if (hull.has_capsules())
      bodies.push_back(hull.body);
    else
      for (const int point : {hull.a, hull.b})
        bodies.push_back(model_.hulls.points[static_cast<std::size_t>(point)].body);
  }
  for (;;) {
    auto last = std::ranges::max_element(bodies);
    if (std::ranges::all_of(bodies, [&](int body) { return body == *last; })) return *last;
    *last = model_.robot.bodies()[static_cast<std::size_t>(*last)].parent;
  }
}

Sweep::Room Sweep::room(const Result& verdict) const { return {verdict.room, verdict.self_room}; }

Sweep::Room Sweep::room_at(std::span<const Goal> goals, const Eigen::VectorXd& q) {
  ++looks_;
  workspace_.judge(goals, q, probe_, kLook);
  return room(probe_);
}

const Result& Sweep::fault() {
  workspace_.judge(goals_, fault_q_, fault_, kLook);
  return fault_;
}

void Sweep::place(double at) {
  ++looks_;
  at_ = *from_ + at * (*to_ - *from_);
  workspace_.least_squares.place(at_);
  const Rollout& rollout = workspace_.problem.rollout;
  state_.place(rollout);
  capsules_.place(state_.positions(), state_.frames());
  if (self_) self_->place(state_.positions(), state_.frames());
  if (attachments_)
    attachments_->place([&](int body) { return rollout.frame(body); }, state_.positions(),
                        state_.frames());
}

double Sweep::way_of(int hull, int carrier, double share) const {
  return travel_from(workspace_.problem.rollout, state_, all_[static_cast<std::size_t>(hull)],
                     step_, share, carrier);
}

template <class IsNear>
Sweep::Answer Sweep::told_by(double way, double reach, IsNear&& is_near) const {
  if (way > 0.0 && !is_near(reach)) return Answer::Clear;
  if (is_near(-model_.options.clearance_tolerance)) return Answer::Touches;
  return way > finest_ ? Answer::Near : Answer::Clear;
}

double Sweep::by_shapes(double than) const {
  return than > 0.0 ? workspace_.scene().shapes().steepest() * than : than;
}

Sweep::Answer Sweep::of_hull(int hull, double way) {
  const Scene& scene = workspace_.scene();
  return told_by(way, way, [&](double than) {
    if (scene.obstacles()->count() > 0 &&
        any_nearer(state_, static_cast<std::size_t>(hull), scene.obstacles(), than))
      return true;
    // Of pairs without a clearance of their own.
    const double apart = by_shapes(than) + model_.options.clearance;
    bool is_any = false;
    shapes_near(capsules_, hull, scene.shapes(), apart, [&](int part) {
      is_any = hull_clearance(capsules_, hull, scene.shapes(), part, apart).shape >= 0;
      return is_any ? kNoMore : apart;
    });
    return is_any;
  });
}

Sweep::Answer Sweep::of_pair(int pair, double way) {
  return told_by(way, way, [&](double than) { return self_->is_nearer(pair, than); });
}

Sweep::Answer Sweep::of_attached(int attached, double way) {
  const Scene& scene = workspace_.scene();
  // Of what moves against it as much is asked again.
  return told_by(way, 2.0 * way, [&](double than) {
    if (attachments_->nearest_point(attached, scene.obstacles(), than)) return true;
    if (attachments_->nearest_shape(attached, scene.shapes(), by_shapes(than))) return true;
    for (int hull = 0; hull < attachments_->hulls(); ++hull)
      if (attachments_->nearest_of_hull(attached, hull, than)) return true;
    for (int other = 0; other < attached; ++other)
      if (attachments_->nearest_of_attached(attached, other, than)) return true;
    return false;
  });
}

Sweep::Answer Sweep::answer(int asked, double share) {
  const int hulls = static_cast<int>(model_.hulls.moving.size()),
            pairs = static_cast<int>(pairs_.size());
  if (asked < hulls) return of_hull(asked, way_of(asked, 0, share));
  if (asked < hulls + pairs) {
    const Pair& pair = pairs_[static_cast<std::size_t>(asked - hulls)];
    double way = 0.0;
    for (const int hull : pair.hulls) way += way_of(hull, pair.common, share);
    return of_pair(asked - hulls, way);
  }
  return of_attached(asked - hulls - pairs, share * attachment_bounds_.dot(step_));
}

bool Sweep::is_clear_within(double middle, double half, const Asked& asked, std::size_t depth) {
  if (workspace_.problem.deadline->passed()) return false;
  place(middle);
  Asked& left = left_[depth];
  left.clear();
  for (const int each : asked) {
    const Answer found = answer(each, half);
    if (found == Answer::Touches) {
      fault_q_ = at_;
      return false;
    }
    if (found == Answer::Near) left.push_back(each);
  }
  if (left.empty() || depth == kDeepest) return true;
  return is_clear_within(middle - 0.5 * half, 0.5 * half, left, depth + 1) &&
         is_clear_within(middle + 0.5 * half, 0.5 * half, left, depth + 1);
}

bool Sweep::is_clear_between(std::span<const Goal> goals, const Eigen::VectorXd& from,
                             const Eigen::VectorXd& to) {
  goals_ = goals;
  from_ = &from;
  to_ = &to;
  step_ = (to - from).cwiseAbs();
  if (attachments_)
    hull_displacement_bounds(model_.robot, workspace_.scene().attachments().balls(), from, to,
                             attachment_bounds_);
  workspace_.problem.allowed_contact.set_goals(goals);
  return is_clear_within(0.5, 0.5, everything_, 0);
}

bool Sweep::is_clear_between(std::span<const Goal> goals, const Eigen::VectorXd& from,
                             const Eigen::VectorXd& to, const Room& one, const Room& other) {
  // Distances change no faster than hulls move but for those by fields, of two hulls no faster than
  // both.
  step_ = (to - from).cwiseAbs();
  const double way = displacement_bounds_.dot(step_);
  const bool is_far =
      by_shapes(way) <= std::max(one.obstacles, 0.0) + std::max(other.obstacles, 0.0) &&
      2.0 * way <= std::max(one.self, 0.0) + std::max(other.self, 0.0);
  if (is_far && !attachments_) return true;
  return is_clear_between(goals, from, to);
}

}  // namespace pdoik::detail
