#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace pdoik::detail {

/// The most promising of the configurations that did not solve, for the one to return if none does.
/// Measuring each by all obstacles costs more than another start, so it is put off until then.
class Candidates {
 public:
  explicit Candidates(Eigen::Index dof) {
    for (Entry& entry : entries_) entry.q.setZero(dof);
  }

  void clear() { count_ = 0; }

  /// @param bound  What the configuration falls short by, at least. Of equals the earlier is kept.
  void add(const Eigen::VectorXd& q, double bound) {
    Entry* place = nullptr;
    if (count_ < entries_.size()) {
      place = &entries_[count_++];
    } else {
      place = &*std::max_element(entries_.begin(), entries_.end(),
                                 [](const Entry& a, const Entry& b) { return a.bound < b.bound; });
      if (bound >= place->bound) return;
    }
    place->q = q;
    place->bound = bound;
  }

  /// The least by a measure, double(const VectorXd& q). There must be one.
  template <class Measure>
  const Eigen::VectorXd& best(Measure&& measure) const {
    std::size_t best = 0;
    double least = measure(entries_[0].q);
    for (std::size_t k = 1; k < count_; ++k) {
      const double value = measure(entries_[k].q);
      if (value >= least) continue;
      least = value;
      best = k;
    }
    return entries_[best].q;
  }

 private:
  struct Entry {
    Eigen::VectorXd q;
    double bound = 0.0;
  };
  std::array<Entry, 8> entries_;
  std::size_t count_ = 0;
};

}  // namespace pdoik::detail
