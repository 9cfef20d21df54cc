#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>

namespace pdoik::detail {

/// The most promising of the configurations that did not solve, for the one to return if none does.
/// Measuring one by all obstacles may cost more than another start, so each comes with a bound at
/// first.
class Candidates {
 public:
  explicit Candidates(Eigen::Index dof) {
    for (Entry& entry : entries_) entry.q.setZero(dof);
  }

  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }

  /// @param shortfall  What the configuration falls short by; at least, unless it was `measured`.
  /// Of equals the earlier is kept. @param alternative  Whose goals.
  void add(const Eigen::VectorXd& q, int alternative, double shortfall, bool measured) {
    Entry* place = nullptr;
    if (count_ < entries_.size()) {
      place = &entries_[count_++];
    } else {
      place = &*std::max_element(
          entries_.begin(), entries_.end(),
          [](const Entry& a, const Entry& b) { return a.shortfall < b.shortfall; });
      if (!(shortfall < place->shortfall)) return;
    }
    place->q = q;
    place->alternative = alternative;
    place->shortfall = shortfall;
    place->measured = measured;
  }

  struct Entry {
    Eigen::VectorXd q;
    int alternative = 0;
    double shortfall = 0.0;
    bool measured = false;
  };

  /// Measure those that are not, by double(const Entry&), the most promising first, until the
  /// best of them is known or `stop`, bool(), holds.
  template <class Measure, class Stop>
  void measure(Measure&& measure, Stop&& stop) {
    for (Entry* next = most_promising(); next != nullptr && !stop(); next = most_promising()) {
      next->shortfall = measure(*next);
      next->measured = true;
    }
  }

  /// The least shortfall, where those that were not measured are taken for touching something as
  /// they usually do. There must be one.
  const Entry& best() const {
    const auto expected = [](const Entry& entry) {
      return entry.shortfall + (entry.measured ? 0.0 : kUsualTouch);
    };
    return *std::min_element(
        entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(count_),
        [&](const Entry& a, const Entry& b) { return expected(a) < expected(b); });
  }

 private:
  template <class Counts>
  const Entry* least(Counts&& counts) const {
    const Entry* best = nullptr;
    for (std::size_t k = 0; k < count_; ++k) {
      const Entry& entry = entries_[k];
      if (counts(entry) && (best == nullptr || entry.shortfall < best->shortfall)) best = &entry;
    }
    return best;
  }
  /// One that is not measured and may be better than those that are.
  Entry* most_promising() {
    const Entry* best = least([](const Entry& entry) { return entry.measured; });
    const Entry* next = least([](const Entry& entry) { return !entry.measured; });
    const bool better = next != nullptr && (best == nullptr || next->shortfall < best->shortfall);
    return better ? &entries_[static_cast<std::size_t>(next - entries_.data())] : nullptr;
  }

  /// The share in least squares of a point some centimetres deep in a hull.
  static constexpr double kUsualTouch = 3e-4;

  std::array<Entry, 8> entries_;
  std::size_t count_ = 0;
};

}  // namespace pdoik::detail
