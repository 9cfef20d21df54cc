#include "obstacles/cell_order.hpp"

#include <utility>

namespace pdoik::detail {
namespace {

/// Binary digits of a cell's place along one axis: a few points in each, of a cloud that lies on
/// surfaces.
unsigned bits_for(std::size_t count) {
  return count > (1U << 17U) ? 8 : count > (1U << 14U) ? 7 : count > (1U << 12U) ? 6 : 5;
}

}  // namespace

void CellOrder::reserve(std::size_t count) {
  entries_.reserve(count);
  halfway_.reserve(count);
  const std::size_t digits = std::size_t{1} << ((3 * bits_for(count) + 1) / 2);
  low_digits_.reserve(digits);
  high_digits_.reserve(digits);
}

void CellOrder::begin(int count, std::array<std::span<double>, 3> sample) {
  double reach = 1e-9;
  for (int axis = 0; axis < 3; ++axis) {
    // The middle nine tenths, and a quarter as much again.
    const std::span<double> values = sample[static_cast<std::size_t>(axis)];
    const std::size_t n = values.size(), low = n / 20, high = n - 1 - low;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(low),
                     values.end());
    const double from = values[low];
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(high),
                     values.end());
    const double to = values[high];
    centre_[axis] = 0.5 * (from + to);
    reach = std::max(reach, 0.625 * (to - from));
  }
  const unsigned bits = bits_for(static_cast<std::size_t>(count));
  const double side = 1U << bits;
  half_ = 0.5 * side;
  last_ = side - 1.0;
  scale_ = half_ / reach;
  digit_bits_ = (3 * bits + 1) / 2;
  digit_mask_ = (1U << digit_bits_) - 1U;
  low_digits_.assign(std::size_t{1} << digit_bits_, 0);
  high_digits_.assign(std::size_t{1} << digit_bits_, 0);
  entries_.resize(static_cast<std::size_t>(count));
  halfway_.resize(static_cast<std::size_t>(count));
  count_ = 0;
}

std::span<const CellOrder::Entry> CellOrder::sorted() {
  const auto sort = [&](const LargeVector<Entry>& from, LargeVector<Entry>& to,
                        std::vector<int>& digits, auto&& digit) {
    int next = 0;
    for (int& place : digits) next += std::exchange(place, next);
    for (std::size_t k = 0; k < count_; ++k)
      to[static_cast<std::size_t>(digits[digit(from[k].cell)]++)] = from[k];
  };
  sort(entries_, halfway_, low_digits_, [this](std::uint32_t cell) { return cell & digit_mask_; });
  sort(halfway_, entries_, high_digits_,
       [this](std::uint32_t cell) { return cell >> digit_bits_; });
  return std::span(entries_).first(count_);
}

}  // namespace pdoik::detail
