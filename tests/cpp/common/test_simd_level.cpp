#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "simd/cull.hpp"
#include "simd/roll_out.hpp"

/// Which kernels are chosen, against what Linux says of the processor.
namespace pdoik::detail {
namespace {

/// Level numbers: 0 baseline, 1 avx2, 2 avx512.
const std::vector<std::string> kNames{"baseline", "avx2", "avx512"};

#ifdef __x86_64__
std::set<std::string> processor_flags() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("flags", 0) != 0) continue;
    std::istringstream words(line.substr(line.find(':') + 1));
    return {std::istream_iterator<std::string>(words), {}};
  }
  return {};
}

std::size_t level_of_processor() {
  const std::set<std::string> flags = processor_flags();
  const auto all = [&](std::initializer_list<const char*> wanted) {
    return std::all_of(wanted.begin(), wanted.end(),
                       [&](const char* flag) { return flags.contains(flag); });
  };
  if (!all({"avx2", "fma"})) return 0;
  return all({"avx512f", "avx512dq", "avx512vl", "avx512bw"}) ? 2 : 1;
}

bool kernels_are_those_of(std::size_t level) {
  const std::vector<CullFunction> culls{cull_baseline, cull_avx2, cull_avx512};
  const std::vector<RollOutFunction> roll_outs{roll_out_baseline, roll_out_avx2, roll_out_avx2};
  return best_coarse().cull == culls[level] && best_roll_out() == roll_outs[level];
}
#else
std::size_t level_of_processor() { return 0; }
bool kernels_are_those_of(std::size_t level) {
  return level == 0 && best_coarse().cull == cull_baseline && best_roll_out() == roll_out_baseline;
}
#endif

/// The level is chosen once in a process: each choice is made in a process of its own, which the
/// death test starts. nullptr: the variable is not set.
void expect_chosen(const char* variable, std::size_t level) {
  SCOPED_TRACE(std::string("PDOIK_SIMD ") + (variable == nullptr ? "not set" : variable));
  if (variable == nullptr) {
    unsetenv("PDOIK_SIMD");
  } else {
    setenv("PDOIK_SIMD", variable, 1);
  }
  EXPECT_EXIT(
      {
        std::fprintf(stderr, "%s, %s kernels", simd_name(),
                     kernels_are_those_of(level) ? "its" : "other");
        std::_Exit(0);
      },
      ::testing::ExitedWithCode(0), "^" + kNames[level] + ", its kernels$");
}

TEST(SimdLevel, is_the_highest_that_the_processor_has_unless_the_environment_lowers_it) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");  // starts this program again
  const char* const before = std::getenv("PDOIK_SIMD");
  const std::string kept = before == nullptr ? "" : before;
  const std::size_t widest = level_of_processor();
  expect_chosen(nullptr, widest);
  expect_chosen("avx512", widest);
  expect_chosen("avx2", std::min<std::size_t>(widest, 1));
  expect_chosen("baseline", 0);
  expect_chosen("", widest);
  expect_chosen("AVX2", widest);
  expect_chosen("sse2", widest);
  if (before == nullptr) {
    unsetenv("PDOIK_SIMD");
  } else {
    setenv("PDOIK_SIMD", kept.c_str(), 1);
  }
}

// What tests/run.sh simd relies on.
TEST(SimdLevel, of_this_very_process_is_the_one_its_environment_asks_for) {
  const char* const asked = std::getenv("PDOIK_SIMD");
  std::size_t expected = level_of_processor();
  for (std::size_t level = 0; level < kNames.size(); ++level) {
    if (asked != nullptr && asked == kNames[level]) expected = std::min(expected, level);
  }
  EXPECT_EQ(simd_name(), kNames[expected]);
  EXPECT_TRUE(kernels_are_those_of(expected));
  RecordProperty("level", simd_name());
}

}  // namespace
}  // namespace pdoik::detail
