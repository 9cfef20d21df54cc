#pragma once

#include <chrono>
#include <functional>

namespace pdoik::detail {

/// The time a solve began and must end; now and then it asks whether somebody wants it to end
/// before.
class Deadline {
 public:
  Deadline(double seconds, const std::function<bool()>& interrupt)
      : start_(Clock::now()), limit_(seconds), interrupt_(interrupt) {}
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool passed() const {
    const double now = elapsed();
    if (now >= limit_ || interrupted_) return true;
    if (now < next_question_) return false;
    next_question_ = now + kBetweenQuestions;
    return interrupted_ = interrupt_ && interrupt_();
  }

 private:
  static constexpr double kBetweenQuestions = 0.1;  // [s]
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_;
  double limit_;
  const std::function<bool()>& interrupt_;
  mutable double next_question_ = kBetweenQuestions;
  mutable bool interrupted_ = false;
};

}  // namespace pdoik::detail
