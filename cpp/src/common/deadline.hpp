#pragma once

#include <chrono>
#include <functional>
#include <limits>

namespace pdoik::detail {

/// The time a solve began and must end; now and then it asks whether somebody wants it to end
/// before.
class Deadline {
 public:
  /// One that never strikes.
  Deadline() = default;
  /// @param interrupt  Outlives the deadline.
  Deadline(double seconds, const std::function<bool()>& interrupt)
      : start_(Clock::now()), limit_(seconds), interrupt_(&interrupt) {}

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  /// Time until it strikes, infinite if it never does [s].
  double left() const {
    return interrupt_ == nullptr ? std::numeric_limits<double>::infinity() : limit_ - elapsed();
  }
  /// Looks at the clock, until it has struck.
  bool passed() const { return passed_at(Clock::now()); }
  /// The same, for whoever has just looked.
  bool passed_at(std::chrono::steady_clock::time_point time) const {
    if (struck_ || interrupt_ == nullptr) return struck_;
    if (looks_left > 0 && --looks_left == 0) return struck_ = true;
    const double now = std::chrono::duration<double>(time - start_).count();
    if (now >= limit_) return struck_ = true;
    if (now < next_question_) return false;
    next_question_ = now + kBetweenQuestions;
    return struck_ = *interrupt_ && (*interrupt_)();
  }
  /// Of this thread: how many looks there are until one finds that it has, whatever the time; 0 for
  /// by the time. For tests, which can strike at every look.
  static inline thread_local int looks_left = 0;
  /// Whether a look has found that it has, without another look.
  bool struck() const { return struck_; }

 private:
  static constexpr double kBetweenQuestions = 0.1;  // [s]
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  double limit_ = 0.0;
  const std::function<bool()>* interrupt_ = nullptr;
  mutable double next_question_ = kBetweenQuestions;
  mutable bool struck_ = false;
};

/// For loops whose turns are short: looks at the clock in one of many of them.
/// @param every  A power of two: fewer where turns are longer.
inline bool passed_in(int turn, const Deadline* deadline, int every = 256) {
  return (turn & (every - 1)) == every - 1 && deadline != nullptr && deadline->passed();
}

}  // namespace pdoik::detail
