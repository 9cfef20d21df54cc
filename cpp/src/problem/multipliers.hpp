#pragma once

#include <algorithm>
#include <vector>

#include "pdoik/augmented_lagrangian.hpp"
#include "problem/constraint_family.hpp"

namespace pdoik::detail {

/// The multipliers of one family's constraints: those that are not zero, in the order of their
/// keys.
class Multipliers {
  struct Multiplier {
    ConstraintKey key;
    double mu;
  };

 public:
  void reserve(int groups, std::size_t most) {
    largest_.assign(static_cast<std::size_t>(groups), 0.0);
    kept_.reserve(most);
    fresh_.reserve(most);
  }
  void reset() {
    kept_.clear();
    std::fill(largest_.begin(), largest_.end(), 0.0);
  }

  /// The largest of a group's.
  double largest(int group) const { return largest_[static_cast<std::size_t>(group)]; }

  /// Tells them to who asks in the order of keys.
  class Reader {
   public:
    explicit Reader(const Multipliers& of) : at_(of.kept_.data()), end_(at_ + of.kept_.size()) {}
    double operator()(ConstraintKey key) {
      while (at_ != end_ && at_->key < key) ++at_;
      return at_ != end_ && at_->key == key ? at_->mu : 0.0;
    }

   private:
    const Multiplier *at_, *end_;
  };

  /// From the constraints that a family has found. The printed update never lowers a multiplier: it
  /// keeps those of constraints that do not act. The smooth one has none left of these.
  template <class Family>
  void update(Family& family, const Penalty& penalty) {
    const bool keep = penalty.form == PenaltyForm::Printed;
    fresh_.clear();
    const auto add = [&](const Multiplier& m) {
      if (m.mu > 0.0 && fresh_.size() < fresh_.capacity()) fresh_.push_back(m);
    };
    auto at = kept_.cbegin();
    for (int k = 0; k < family.count(); ++k) {
      const ConstraintKey key = family.key(k);
      for (; at != kept_.cend() && at->key < key; ++at)
        if (keep) add(*at);
      const double mu = at != kept_.cend() && at->key == key ? (at++)->mu : 0.0;
      add({key, penalty.updated_multiplier(family.at(k).c, mu)});
    }
    for (; keep && at != kept_.cend(); ++at) add(*at);
    kept_.swap(fresh_);
    std::fill(largest_.begin(), largest_.end(), 0.0);
    for (const Multiplier& m : kept_) {
      double& largest = largest_[static_cast<std::size_t>(group_of(m.key))];
      largest = std::max(largest, m.mu);
    }
  }

 private:
  std::vector<Multiplier> kept_, fresh_;
  std::vector<double> largest_;
};

}  // namespace pdoik::detail
