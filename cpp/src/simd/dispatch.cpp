#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "pdoik/simd.hpp"
#include "simd/cull.hpp"
#include "simd/lanes.hpp"
#include "simd/roll_out.hpp"

namespace pdoik::detail {
namespace {

enum class Level { Baseline, Avx2, Avx512 };

#ifndef PDOIK_NO_X86_SIMD
Level level_of_processor() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return Level::Baseline;
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                 __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
             ? Level::Avx512
             : Level::Avx2;
}

/// At most what PDOIK_SIMD names. A value that names no level counts as none: a misspelt variable
/// must not keep a robot from starting, and simd_name() says what was chosen.
Level level_allowed() {
  const char* const asked = std::getenv("PDOIK_SIMD");
  if (asked == nullptr) return Level::Avx512;
  if (std::strcmp(asked, "baseline") == 0) return Level::Baseline;
  return std::strcmp(asked, "avx2") == 0 ? Level::Avx2 : Level::Avx512;
}
#endif

Level level() {
#ifndef PDOIK_NO_X86_SIMD
  static const Level chosen = std::min(level_of_processor(), level_allowed());
  return chosen;
#else
  return Level::Baseline;
#endif
}

}  // namespace

CoarseKernels baseline_coarse() {
  return {cull_baseline, bound_distances_baseline, capsule_gaps_baseline};
}

CoarseKernels best_coarse() {
#ifndef PDOIK_NO_X86_SIMD
  if (level() == Level::Avx512) return {cull_avx512, bound_distances_avx512, capsule_gaps_avx512};
  if (level() == Level::Avx2) return {cull_avx2, bound_distances_avx2, capsule_gaps_avx2};
#endif
  return baseline_coarse();
}

RollOutFunction best_roll_out() {
#ifndef PDOIK_NO_X86_SIMD
  if (level() != Level::Baseline) return roll_out_avx2;
#endif
  return roll_out_baseline;
}

LaneKernel best_lane_kernel() {
#ifndef PDOIK_NO_X86_SIMD
  // Eight lanes were no faster per target where 512 bits take two turns, and slower for one.
  if (level() != Level::Baseline) return {lane_tick_avx2, 4};
#endif
  return {lane_tick_baseline, 2};
}

const char* simd_name() {
  return level() == Level::Avx512 ? "avx512" : level() == Level::Avx2 ? "avx2" : "baseline";
}

}  // namespace pdoik::detail

namespace pdoik {
const char* simd_name() { return detail::simd_name(); }
}  // namespace pdoik
