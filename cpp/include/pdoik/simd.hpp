#pragma once

namespace pdoik {

/// The instructions that this process's kernels use: "avx512", "avx2" or "baseline". The best that
/// the processor has, or what the environment variable PDOIK_SIMD names if that is less; any other
/// value of it counts as none. Chosen once, when first needed.
const char* simd_name();

}  // namespace pdoik
