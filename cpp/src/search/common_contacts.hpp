#pragma once

#include <optional>
#include <vector>

#include "pdoik/result.hpp"
#include "problem/problem.hpp"

namespace pdoik::detail {

/// Which hulls touch which obstacles wherever a request's starts have reached its goals: if some
/// pair does after many, there is little hope. All points count as one obstacle.
class CommonContacts {
 public:
  CommonContacts() { pairs_.reserve(kMost); }

  /// Begin anew, with each request.
  void forget() {
    pairs_.clear();
    starts_ = 0;
  }
  /// A start that reached the goals ended where the problem's rollout is, and touches something.
  void note(Problem& problem);
  /// How many starts have been noted, as long as all of them but the first few, which most requests
  /// do with and are not looked at, touch by one pair; else 0.
  int starts() const { return pairs_.empty() ? 0 : starts_; }
  /// The deepest of the pairs that touched each time, where the problem's rollout is now.
  std::optional<WorstConstraint> deepest(Problem& problem) const;

 private:
  struct Pair {
    int hull, part;  ///< a place among the moving hulls; of a shape, and -1 for points
  };
  /// More are not needed: each start leaves fewer.
  static constexpr std::size_t kMost = 256;
  static constexpr int kFirstFew = 8;

  std::vector<Pair> pairs_;
  int starts_ = 0;
};

}  // namespace pdoik::detail
