#pragma once

#include <chrono>

namespace pdoik::detail {

/// The time a solve began and must end.
class Deadline {
 public:
  explicit Deadline(double seconds) : start_(Clock::now()), limit_(seconds) {}
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool passed() const { return elapsed() >= limit_; }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_;
  double limit_;
};

}  // namespace pdoik::detail
