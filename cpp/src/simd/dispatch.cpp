#include "simd/cull.hpp"
#include "simd/roll_out.hpp"

namespace pdoik::detail {
namespace {

enum class Level { Baseline, Avx2, Avx512 };

Level level() {
#ifndef PDOIK_NO_X86_SIMD
  static const Level found =
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
              __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")
          ? Level::Avx512
      : __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? Level::Avx2
                                                                        : Level::Baseline;
  return found;
#else
  return Level::Baseline;
#endif
}

}  // namespace

CullFunction best_cull() {
#ifndef PDOIK_NO_X86_SIMD
  if (level() == Level::Avx512) return cull_avx512;
  if (level() == Level::Avx2) return cull_avx2;
#endif
  return cull_baseline;
}

RollOutFunction best_roll_out() {
#ifndef PDOIK_NO_X86_SIMD
  if (level() != Level::Baseline) return roll_out_avx2;
#endif
  return roll_out_baseline;
}

const char* simd_name() {
  return level() == Level::Avx512 ? "avx512" : level() == Level::Avx2 ? "avx2" : "baseline";
}

}  // namespace pdoik::detail
