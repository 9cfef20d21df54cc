#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "problem/balance.hpp"
#include "problem/constraint_family.hpp"
#include "problem/model.hpp"

namespace pdoik::detail {

/// The centre of mass in its box and over its polygon, if that is asked for: each side and each
/// edge a group of its own.
class BalanceConstraints {
 public:
  explicit BalanceConstraints(const Model& model) : balance_(model.robot, model.options.balance) {
    terms_.reserve(static_cast<std::size_t>(balance_.slots()));
  }

  /// What goals ask of the centre of mass from now on, beside the options.
  void ask(std::span<const Goal> goals) { balance_.ask(goals); }

  bool wants_points() const { return false; }
  int groups() const { return balance_.wanted() ? balance_.slots() : 0; }

  template <class Reach>
  void find(const Rollout& rollout, Reach&& reach) {
    terms_.clear();
    if (!balance_.wanted()) return;
    balance_.place([&](int body) -> const Frame& { return rollout.frame(body); });
    balance_.for_each(reach, [&](const Balance::Term& term) { terms_.push_back(term); });
    // Edges come as the polygon goes round.
    std::sort(terms_.begin(), terms_.end(),
              [](const auto& one, const auto& other) { return one.slot < other.slot; });
  }
  int count() const { return static_cast<int>(terms_.size()); }
  ConstraintKey key(int k) const { return constraint_key(at(k).slot, 0); }
  const Balance::Term& at(int k) const { return terms_[static_cast<std::size_t>(k)]; }

  void add_row(const Balance::Term& at, const Rollout& rollout, double* row) {
    balance_.add_row(at, rollout, row);
  }
  void add_wrenches(const Balance::Term& at, double slope, Rollout& rollout) const {
    balance_.add_wrenches(at, slope, rollout);
  }

 private:
  Balance balance_;
  std::vector<Balance::Term> terms_;
};

}  // namespace pdoik::detail
