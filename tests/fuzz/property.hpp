#pragma once

#include <cstdlib>
#include <iostream>

/// What must hold whatever the bytes: else the process ends, which libFuzzer and the replay both
/// take for a crash. Also with NDEBUG.
#define PDOIK_PROPERTY(condition, ...)                                                         \
  do {                                                                                         \
    if (!(condition)) {                                                                        \
      std::cerr << __FILE__ << ':' << __LINE__ << ": does not hold: " #condition << std::endl; \
      __VA_OPT__(std::cerr << __VA_ARGS__ << std::endl;)                                       \
      std::abort();                                                                            \
    }                                                                                          \
  } while (false)
