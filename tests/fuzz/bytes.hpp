#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

namespace pdoik::fuzz {

/// A fuzzer's bytes taken one after another as numbers and choices; zeros once they are used up.
/// As libFuzzer's FuzzedDataProvider, but free of clang's headers, so that any compiler replays
/// the corpus and reads the same from it.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

  bool empty() const { return next_ == end_; }
  std::uint8_t byte() { return next_ == end_ ? std::uint8_t{0} : *next_++; }
  std::uint16_t word() {
    const unsigned high = byte();
    return static_cast<std::uint16_t>(high << 8 | byte());
  }

  /// One in `many` of all bytes; a byte of zero never is.
  bool one_in(int many) { return byte() >= 256 - 256 / many; }
  /// low to high, both included, at most 256 of them.
  int integer(int low, int high) { return low + byte() % (high - low + 1); }
  template <class Value, std::size_t n>
  Value pick(const Value (&values)[n]) {
    return values[byte() % n];
  }
  /// low for bytes of zero.
  double uniform(double low, double high) { return low + (high - low) * word() / 65535.0; }

  /// Any double there is, the awkward ones often.
  double any_double() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kAwkward[] = {std::numeric_limits<double>::quiet_NaN(),
                                   kInfinity,
                                   -kInfinity,
                                   0.0,
                                   -0.0,
                                   1e300,
                                   -1e300,
                                   std::numeric_limits<double>::max(),
                                   std::numeric_limits<double>::denorm_min(),
                                   1e-300,
                                   1e-9,
                                   -1e-9,
                                   -1.0,
                                   1.0,
                                   1e6,
                                   -1e6,
                                   1e16,
                                   3.141592653589793};
    const std::uint8_t kind = byte();
    if (kind < 128) return kAwkward[kind % (sizeof(kAwkward) / sizeof(double))];
    if (kind < 192) return uniform(-10.0, 10.0);
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8 | byte();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }

  /// From now on one number in `many` is any double, whatever was asked for; 0 for none.
  void be_wild(int many) { wild_ = many; }
  /// Between low and high, but for what be_wild lets through.
  double number(double low, double high) {
    return wild_ > 0 && one_in(wild_) ? any_double() : uniform(low, high);
  }

 private:
  const std::uint8_t* next_;
  const std::uint8_t* end_;
  int wild_ = 0;
};

}  // namespace pdoik::fuzz
