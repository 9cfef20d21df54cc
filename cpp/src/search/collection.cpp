#include "search/collection.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

/// Nothing new is to be expected when so many ends have come that were known, for each that is, and
/// so many at least.
constexpr int kRepeats = 8, kFewest = 40;

}  // namespace

bool Collection::are_alike(const Eigen::VectorXd& one, const Eigen::VectorXd& other) const {
  for (Eigen::Index i = 0; i < one.size(); ++i) {
    const Model::Turn turn = model_.turns[static_cast<std::size_t>(i)];
    double off = one[i] - other[i];
    if (turn == Model::Turn::Whole || turn == Model::Turn::Wrap)
      off = std::remainder(off, 2.0 * M_PI);
    if (std::abs(off) > distinct_) return false;
  }
  return true;
}

void Collection::note(const Eigen::VectorXd& q) {
  ++noted_;
  const auto known =
      std::find_if(ends_.begin(), ends_.end(), [&](const End& end) { return are_alike(end.q, q); });
  if (known == ends_.end()) {
    ends_.push_back({q, 1});
    ++once_;
    since_new_ = 0;
    return;
  }
  if (known->hits++ == 1) --once_;
  ++since_new_;
}

bool Collection::add(const Result& result) {
  const bool known = std::any_of(results.begin(), results.end(),
                                 [&](const Result& r) { return are_alike(r.q, result.q); });
  if (!known) results.push_back(result);
  return !known;
}

bool Collection::is_full() const {
  if (whole_) return false;  // its starts end by themselves, and the nearest are wanted
  if (wanted_.limit > 0 && static_cast<int>(results.size()) >= wanted_.limit) return true;
  return since_new_ >= std::max(kFewest, kRepeats * static_cast<int>(ends_.size()));
}

double Collection::coverage() const {
  return noted_ == 0 ? 0.0 : 1.0 - static_cast<double>(once_) / noted_;
}

}  // namespace pdoik::detail
