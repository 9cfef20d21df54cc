#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "obstacles/obstacle_set.hpp"

namespace pdoik::detail {

/// The points of a cloud, which its handles share: snapshots, of which the last is what is read.
/// An update makes the next one beside it, so that nobody waits for an update, nor an update for
/// those who still read an older one. Only updates make and free snapshots.
class CloudState {
 private:
  struct Snapshot {
    ObstacleSet points;
    int version = 0;
    bool is_whole = true;  ///< or what a change that failed has left
    mutable std::atomic<int> readers = 0;
  };

 public:
  CloudState() : CloudState(std::make_unique<Snapshot>()) {}
  CloudState(const CloudState&) = delete;

  /// The points as they were when somebody began to read: they stay as they are while this lives.
  class Reading {
   public:
    Reading() = default;
    Reading(Reading&& other) noexcept : snapshot_(std::exchange(other.snapshot_, nullptr)) {}
    Reading& operator=(Reading&& other) noexcept {
      std::swap(snapshot_, other.snapshot_);
      return *this;
    }
    ~Reading() {
      if (snapshot_ != nullptr) snapshot_->readers.fetch_sub(1);
    }
    const ObstacleSet& points() const { return snapshot_->points; }
    /// Counts changes: what was derived from the points holds while it stays.
    int version() const { return snapshot_->version; }

   private:
    friend class CloudState;
    explicit Reading(const Snapshot* snapshot) : snapshot_(snapshot) {}
    const Snapshot* snapshot_ = nullptr;
  };

  /// Begin to read. Takes no lock.
  Reading read() const {
    while (true) {
      const Snapshot* const latest = latest_.load();
      latest->readers.fetch_add(1);
      // Once it is counted no update takes it, unless one has before: then it is not the latest.
      if (latest_.load() == latest) return Reading(latest);
      latest->readers.fetch_sub(1);
    }
  }

  /// What a change did: how many points it took out, and how many it touched in all.
  struct Changed {
    int removed;
    std::size_t touched;
  };
  using Change = std::function<Changed(ObstacleSet&)>;

  /// Change the points, in turn with other updates. Where it throws, they are as before.
  /// @param change  Called again, later, for the snapshot that it was not made in.
  /// @returns How many points were taken out.
  int update(Change change) {
    const std::lock_guard turn(turn_);
    const Snapshot& latest = *latest_.load();
    Snapshot& next = spare();
    // What it misses is done to it once more, if that is less than to copy all.
    const bool is_last_but_one = next.is_whole && next.version + 1 == latest.version;
    next.is_whole = false;
    if (is_last_but_one && last_change_)
      last_change_(next.points);
    else
      next.points.copy(latest.points);
    last_change_ = nullptr;
    const Changed changed = change(next.points);
    if (changed.touched < static_cast<std::size_t>(next.points.count()) / kFarDearer)
      last_change_ = std::move(change);
    next.version = latest.version + 1;
    next.is_whole = true;
    latest_.store(&next);
    return changed.removed;
  }
  /// The same for who knows that nobody else has it, in place.
  ObstacleSet& change_unshared() {
    Snapshot* const latest = snapshots_.front().get();
    ++latest->version;
    return latest->points;
  }

  /// The memory that all snapshots take [bytes].
  std::size_t bytes() const {
    const std::lock_guard turn(turn_);
    std::size_t sum = 0;
    for (const auto& each : snapshots_) sum += each->points.bytes();
    return sum;
  }

 private:
  /// To take a point in takes as long as to copy about so many.
  static constexpr std::size_t kFarDearer = 8;

  explicit CloudState(std::unique_ptr<Snapshot> first) : latest_(first.get()) {
    snapshots_.push_back(std::move(first));
  }

  /// A snapshot that nobody reads any more, the one before the latest if that is one. Of others the
  /// memory is given back, but not of what counts their readers: somebody may be about to.
  Snapshot& spare() {
    Snapshot* const latest = latest_.load();
    Snapshot* chosen = nullptr;
    for (const auto& each : snapshots_) {
      if (each.get() == latest || each->readers.load() > 0) continue;
      if (chosen == nullptr || each->version > chosen->version) chosen = each.get();
    }
    for (const auto& each : snapshots_) {
      if (each.get() == latest || each.get() == chosen || each->readers.load() > 0) continue;
      each->points = ObstacleSet();
      each->is_whole = false;
    }
    if (chosen == nullptr) {
      snapshots_.push_back(std::make_unique<Snapshot>());
      chosen = snapshots_.back().get();
      chosen->is_whole = false;
    }
    return *chosen;
  }

  std::vector<std::unique_ptr<Snapshot>> snapshots_;
  std::atomic<Snapshot*> latest_;
  Change last_change_;       ///< what made the latest; null where to copy all is less
  mutable std::mutex turn_;  ///< of updates
};

}  // namespace pdoik::detail
