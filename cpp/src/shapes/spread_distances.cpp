#include "shapes/spread_distances.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pdoik::detail {
namespace {

constexpr float kNowhere = std::numeric_limits<float>::infinity();

/// By how little less than the truncation a value counts as truncated, as a share of it: means of
/// truncated values are rounded.
constexpr double kNearlyTruncated = 1e-3;
/// Passes over all cells, there and back: after the second hardly any changes.
constexpr int kMostRounds = 3;

/// What is known of a cell.
enum class Known : std::uint8_t {
  Exactly,
  Beyond,  ///< outside, at least as far as the truncation
  Within,  ///< inside, at least as deep
  Nothing,
};

/// Distances on one side, outside or inside, which are positive there.
class Side {
 public:
  /// @param sign  1 for outside, -1 for inside.
  Side(const LargeVector<float>& values, const std::vector<Known>& known,
       const std::array<int, 3>& counts, double cell, int sign, DistanceField::Unknown unknown)
      : values_(values),
        known_(known),
        counts_(counts),
        cell_(cell),
        sign_(static_cast<float>(sign)),
        // Where nothing is known something solid is assumed, or nothing: inside or outside.
        fills_unknown_((unknown == DistanceField::Unknown::Occupied) == (sign < 0)),
        // What is known to be clear of all that is known may be near to what is not.
        lowers_known_(unknown == DistanceField::Unknown::Occupied && sign > 0),
        nearest_(values.size(), kNone),
        distance_(values.size(), kNowhere) {}

  bool is_wanted(std::size_t c) const {
    switch (known_[c]) {
      case Known::Exactly:
        return lowers_known_ && values_[c] > 0.0F;
      case Known::Beyond:
        return sign_ > 0.0F;
      case Known::Within:
        return sign_ < 0.0F;
      case Known::Nothing:
        return fills_unknown_;
    }
    return false;
  }
  float distance(std::size_t c) const { return distance_[c]; }

  void find() {
    for (std::size_t c = 0; c < values_.size(); ++c) {
      if (is_wanted(c) && known_[c] != Known::Exactly) continue;
      nearest_[c] = static_cast<std::int32_t>(c);
      distance_[c] = weight(c);
    }
    for (int round = 0; round < kMostRounds; ++round) {
      const bool there = pass(1), back = pass(-1);
      if (!there && !back) break;
    }
  }

 private:
  static constexpr std::int32_t kNone = -1;

  /// What a cell says of how far others are at most, less how far those are from it: of one on the
  /// other side that its border is half a cell nearer.
  float weight(std::size_t c) const {
    const float border = -0.5F * static_cast<float>(cell_);
    return known_[c] == Known::Exactly ? std::max(sign_ * values_[c], border) : border;
  }

  /// Hand on, in the order of the cells or against it. @returns Whether any has changed.
  bool pass(int way) {
    const auto [I, J, K] = counts_;
    const auto begin = [&](int count) { return way > 0 ? 0 : count - 1; };
    bool changed = false;
    for (int i = begin(I); i >= 0 && i < I; i += way) {
      for (int j = begin(J); j >= 0 && j < J; j += way) {
        for (int k = begin(K); k >= 0 && k < K; k += way) {
          const std::size_t c = at(i, j, k);
          if (!is_wanted(c)) continue;
          // Those that have had their turn.
          for (int dj = -1; dj <= 1; ++dj) {
            for (int dk = -1; dk <= 1; ++dk) changed |= take(c, i, j, k, i - way, j + dj, k + dk);
          }
          for (int dk = -1; dk <= 1; ++dk) changed |= take(c, i, j, k, i, j - way, k + dk);
          changed |= take(c, i, j, k, i, j, k - way);
        }
      }
    }
    return changed;
  }

  bool take(std::size_t c, int i, int j, int k, int ni, int nj, int nk) {
    const auto is_in = [](int n, int count) { return n >= 0 && n < count; };
    if (!is_in(ni, counts_[0]) || !is_in(nj, counts_[1]) || !is_in(nk, counts_[2])) return false;
    const std::int32_t source = nearest_[at(ni, nj, nk)];
    if (source == kNone || source == nearest_[c]) return false;
    const auto s = static_cast<std::uint32_t>(source);
    const auto J = static_cast<std::uint32_t>(counts_[1]),
               K = static_cast<std::uint32_t>(counts_[2]);
    const std::uint32_t row = s / K;
    const double dk = static_cast<double>(s - row * K) - k, dj = static_cast<double>(row % J) - j,
                 di = static_cast<double>(row / J) - i;
    const auto found = static_cast<float>(static_cast<double>(weight(s)) +
                                          cell_ * std::sqrt(di * di + dj * dj + dk * dk));
    if (!(found < distance_[c])) return false;
    distance_[c] = found;
    nearest_[c] = source;
    return true;
  }

  std::size_t at(int i, int j, int k) const {
    return (static_cast<std::size_t>(i) * static_cast<std::size_t>(counts_[1]) +
            static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(counts_[2]) +
           static_cast<std::size_t>(k);
  }

  const LargeVector<float>& values_;
  const std::vector<Known>& known_;
  const std::array<int, 3>& counts_;
  double cell_;
  float sign_;
  bool fills_unknown_, lowers_known_;
  std::vector<std::int32_t> nearest_;
  std::vector<float> distance_;
};

}  // namespace

void spread_distances(LargeVector<float>& values, const std::array<int, 3>& counts, double cell,
                      double truncation, DistanceField::Unknown unknown) {
  const auto most = static_cast<float>((1.0 - kNearlyTruncated) * truncation);
  std::vector<Known> known(values.size(), Known::Exactly);
  bool is_all = true;
  for (std::size_t c = 0; c < values.size(); ++c) {
    const float value = values[c];
    if (!std::isfinite(value))
      known[c] = Known::Nothing;
    else if (std::abs(value) >= most)
      known[c] = value > 0.0F ? Known::Beyond : Known::Within;
    is_all = is_all && known[c] == Known::Exactly;
  }
  if (is_all) return;
  const double diagonal = cell * std::hypot(counts[0], counts[1], counts[2]);
  LargeVector<float> found(values);
  for (const int sign : {1, -1}) {
    Side side(values, known, counts, cell, sign, unknown);
    side.find();
    for (std::size_t c = 0; c < values.size(); ++c) {
      if (side.is_wanted(c))
        found[c] =
            static_cast<float>(sign) * std::min(side.distance(c), static_cast<float>(diagonal));
    }
  }
  values.swap(found);
}

}  // namespace pdoik::detail
