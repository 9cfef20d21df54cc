#pragma once

#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <stdexcept>
#include <string>

namespace pdoik::detail {

/// What is wrong with an input, in words. It has memory of its own, so that a control loop can
/// report it without an allocation or an exception.
class InputError {
 public:
  bool empty() const { return text_[0] == 0; }
  const char* text() const { return text_; }
  void clear() { text_[0] = 0; }

  /// Say this, cut to what fits. @returns false, for `return error.say(...)` where that means
  /// that something is wrong.
  [[gnu::format(printf, 2, 3)]] bool say(const char* format, ...) {
    clear();
    std::va_list values;
    va_start(values, format);
    append(format, values);
    va_end(values);
    return false;
  }
  /// Say this as well.
  [[gnu::format(printf, 2, 3)]] void add(const char* format, ...) {
    std::va_list values;
    va_start(values, format);
    append(format, values);
    va_end(values);
  }

  /// @throws std::invalid_argument with the text, if there is one.
  void raise() const {
    if (!empty()) throw std::invalid_argument(text_);
  }

 private:
  void append(const char* format, std::va_list values) {
    std::size_t used = 0;
    while (text_[used] != 0) ++used;
    std::vsnprintf(text_ + used, sizeof(text_) - used, format, values);
  }

  char text_[1024] = "";
};

}  // namespace pdoik::detail
