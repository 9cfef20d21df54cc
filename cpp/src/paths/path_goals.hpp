#pragma once

#include <span>
#include <vector>

#include "pdoik/path.hpp"

namespace pdoik::detail {

/// What a path asks at its stations and between them: targets on the straight way from one to the
/// next, turning evenly, and slacks in proportion.
class PathGoals {
 public:
  /// The stations outlive it. One that is closed has the first once more at its end.
  PathGoals(std::span<const std::vector<Goal>> stations, bool closed);

  /// Stations, of which a closed path's first and last are the same.
  int count() const { return count_; }
  const std::vector<Goal>& station(int k) const {
    return stations_[static_cast<std::size_t>(k) % stations_.size()];
  }
  /// What is asked at a place, until the next call.
  std::span<const Goal> at(double place);
  /// How far it is from one station to another, in ways of a tool after which joints are looked at
  /// once more.
  double way(int from, int to) const;

 private:
  std::span<const std::vector<Goal>> stations_;
  int count_;
  std::vector<double> ways_;  ///< from each station to the next
  std::vector<Goal> between_;
};

}  // namespace pdoik::detail
