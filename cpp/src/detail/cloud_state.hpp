#pragma once

#include <mutex>
#include <shared_mutex>

#include "detail/obstacle_set.hpp"

namespace pdoik::detail {

/// The points of a cloud, which its handles share. Solves read them at the same time, an update has
/// them alone: it waits for those that have begun, and those that come meanwhile wait for it.
class CloudState {
 public:
  const ObstacleSet& points() const { return points_; }
  /// Counts changes: what was derived from the points holds while it stays.
  int version() const { return version_; }

  /// Held while the points are read.
  std::shared_lock<std::shared_mutex> read() const {
    const std::lock_guard turn(turn_);  // behind an update that waits: else it might wait for ever
    return std::shared_lock(mutex_);
  }
  /// Change the points, alone: change(ObstacleSet&).
  template <class Change>
  void update(Change&& change) {
    const std::lock_guard turn(turn_);
    const std::unique_lock alone(mutex_);
    change(points_);
    ++version_;
  }
  /// The same for who knows that nobody else has it.
  ObstacleSet& change_unshared() {
    ++version_;
    return points_;
  }

 private:
  ObstacleSet points_;
  int version_ = 0;
  mutable std::mutex turn_;
  mutable std::shared_mutex mutex_;
};

}  // namespace pdoik::detail
