#pragma once

#include <optional>
#include <vector>

#include "detail/balance.hpp"
#include "detail/collision.hpp"
#include "detail/self_collision.hpp"
#include "pdoik/options.hpp"

namespace pdoik::detail {

/// The constraints on the robot itself, whatever the obstacles: balance, and its hulls off one
/// another. All are c <= 0 in metres. Slots number them: balance's first, then pairs of hulls.
class OwnConstraints {
 public:
  OwnConstraints(const Robot& robot, const Options& options) : balance_(robot, options.balance) {
    if (options.self_collision) self_.emplace(robot, HullModel(robot), options.self_clearance);
    first_pair_ = balance_.wanted() ? balance_.slots() : 0;
    terms_.reserve(static_cast<std::size_t>(first_pair_));
    active_.reserve(static_cast<std::size_t>(slots()));
  }

  bool any() const { return balance_.wanted() || self_; }
  bool any_self() const { return self_.has_value(); }
  int slots() const { return first_pair_ + (self_ ? self_->pair_count() : 0); }

  struct Active {
    int slot;
    double c;
    int index;  ///< among balance's terms, or among the near pairs from terms' number on
  };

  /// Find those with c > -reach(slot), where a rollout is, and its attached points.
  template <class Reach>
  void find(const Rollout& rollout, const CollisionState& points, Reach&& reach) {
    active_.clear();
    terms_.clear();
    if (balance_.wanted()) {
      balance_.place([&](int body) -> const Frame& { return rollout.frame(body); });
      balance_.for_each(reach, [&](const Balance::Term& term) {
        active_.push_back({term.slot, term.c, static_cast<int>(terms_.size())});
        terms_.push_back(term);
      });
    }
    if (!self_) return;
    self_->place(points.positions());
    self_->find_near([&](int pair) { return reach(first_pair_ + pair); });
    const int before = static_cast<int>(terms_.size());
    for (int k = 0; k < self_->near_count(); ++k)
      active_.push_back({first_pair_ + self_->near(k).pair, self_->near(k).c, before + k});
  }

  /// Whether any is violated there. Forgets those that were found.
  bool is_violated(const Rollout& rollout, const CollisionState& points) {
    find(rollout, points, [](int) { return 0.0; });
    return !active_.empty();
  }

  const std::vector<Active>& active() const { return active_; }

  /// Add dc/dq of an active one to row, shape (n,).
  void add_row(const Active& active, const Rollout& rollout, const CollisionState& points,
               double* row) {
    const auto index = static_cast<std::size_t>(active.index);
    if (index < terms_.size()) {
      balance_.add_row(terms_[index], rollout, row);
      return;
    }
    for_each_point(active, [&](int point, const Vec4& direction) {
      rollout.add_row(points.body_of_point(point), direction,
                      cross3(points.position(point), direction), row);
    });
  }

  /// Add the wrenches of dL/dc = slope.
  void add_wrenches(const Active& active, double slope, const CollisionState& points,
                    Rollout& rollout) const {
    const auto index = static_cast<std::size_t>(active.index);
    if (index < terms_.size()) {
      balance_.add_wrenches(terms_[index], slope, rollout);
      return;
    }
    for_each_point(active, [&](int point, const Vec4& direction) {
      rollout.add_force(points.body_of_point(point), points.position(point),
                        broadcast(slope) * direction);
    });
  }

 private:
  template <class Visit>
  void for_each_point(const Active& active, Visit&& visit) const {
    const SelfCollision::Near& near = self_->near(active.index - static_cast<int>(terms_.size()));
    for (int k = 0; k < 4; ++k)
      if (near.point[k] >= 0) visit(near.point[k], near.dc_dpoint[k]);
  }

  Balance balance_;
  std::optional<SelfCollision> self_;
  int first_pair_ = 0;
  std::vector<Balance::Term> terms_;
  std::vector<Active> active_;
};

}  // namespace pdoik::detail
