#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "common/frame.hpp"
#include "kinematics/goal_of.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// What some links may touch: obstacles about the targets. One thread's. Allocates at construction
/// only.
class AllowedContact {
 public:
  /// @throws std::invalid_argument  A link is not there.
  AllowedContact(const Robot& robot, const TouchOptions& options);

  /// Where the targets are from now on; those that move with a tip are nowhere.
  void set_goals(std::span<const Goal> goals) {
    count_ = 0;
    for (const Goal& goal : goals) {
      if (has_place(goal) && count_ < centres_.size())
        centres_[count_++] = to_vec4(goal.T_base_tip.translation());
    }
  }
  bool wanted() const { return !may_touch_.empty(); }
  /// Whether a hull may touch what is at a point, up to a depth.
  /// @param source  The hull's or capsule's place in the occupancy.
  bool lets(int source, const Vec4& point) const {
    return may_touch_[static_cast<std::size_t>(source)] &&
           std::any_of(centres_.begin(), centres_.begin() + static_cast<std::ptrdiff_t>(count_),
                       [&](const Vec4& centre) {
                         const Vec4 from = point - centre;
                         return dot3(from, from) <= radius2_;
                       });
  }
  double depth() const { return depth_; }

 private:
  std::vector<bool> may_touch_;  ///< by the hull's place in the occupancy; empty if none may
  std::vector<Vec4> centres_;
  std::size_t count_ = 0;
  double radius2_, depth_;
};

}  // namespace pdoik::detail
