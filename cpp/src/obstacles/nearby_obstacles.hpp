#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "obstacles/collision_state.hpp"

namespace pdoik::detail {

/// Copies of the obstacles about one configuration, which are few.
class NearbyObstacles {
 public:
  /// Room for copies out of this many: called at set-up.
  void reserve(int padded_obstacles) {
    const auto count = static_cast<std::size_t>(padded_obstacles);
    copies_.reserve(std::min(count, kMost));
    const std::size_t words = count / 64 + 1;
    if (is_near_.size() < words) is_near_.resize(words);
  }

  /// Take those within `margin` of a hull where the hulls are placed [m]. @returns Whether they are
  /// few enough; if not, nothing is taken.
  bool gather(CollisionState& hulls, const ObstacleView& all, double margin) {
    const std::size_t words = static_cast<std::size_t>(all->places()) / 64 + 1;
    std::fill_n(is_near_.begin(), words, 0U);
    std::size_t count = 0;
    const auto note = [&](const NearPair* begin, const NearPair* end) {
      for (const NearPair* pair = begin; pair != end; ++pair) {
        const auto j = static_cast<std::size_t>(pair->obstacle);
        const std::uint64_t bit = std::uint64_t{1} << (j % 64);
        if ((is_near_[j / 64] & bit) == 0) ++count;
        is_near_[j / 64] |= bit;
      }
      return count <= kMost;
    };
    if (!hulls.visit_near(all, [margin](std::size_t) { return margin; }, note)) return false;
    own_ = all.own;
    copies_.begin(static_cast<int>(count), to_vector3(all->origin()));
    for (std::size_t w = 0; w < words; ++w) {
      for (std::uint64_t bits = is_near_[w]; bits != 0; bits &= bits - 1) {
        const int j = static_cast<int>(64 * w) + __builtin_ctzll(bits);
        copies_.add(all[j], all->id(j));
      }
    }
    copies_.finish(all->in_order());
    return true;
  }

  ObstacleView view() const { return {&copies_, 0.0, own_}; }

 private:
  /// Copies of more save nothing.
  static constexpr std::size_t kMost = 16384;

  ObstacleSet copies_;
  const double* own_ = nullptr;         ///< what hulls have of their own, which the copies have not
  std::vector<std::uint64_t> is_near_;  ///< a bit for each of all
};

}  // namespace pdoik::detail
