#pragma once

#include <Eigen/Geometry>
#include <cstddef>

namespace pdoik {

/// How Eigen aligns, allocates and lays out what crosses from the library to its user. Compiler
/// flags change it: with AVX (`-march=native`) Eigen aligns to 32 or 64 bytes and allocates by
/// other means, and a vector that one side made and the other frees crashes. So every file that
/// includes a public header names the kind that it was compiled with, and the library defines its
/// own kind only:
///
///     undefined reference to `pdoik::EigenAbi<64ul, 64, 0, 8ul, false, 3,
///     4>::library_was_built_for_this()'
///
/// means that the file was compiled otherwise than the library. Link the CMake target
/// `pdoik::eigen_abi` to all of the program that uses Eigen, or compile it with
/// `-mno-avx -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MALLOC_ALREADY_ALIGNED=1`.
///
/// @tparam static_alignment  alignof(Eigen::Isometry3d), of fixed-size members [bytes].
/// @tparam max_alignment     EIGEN_MAX_ALIGN_BYTES, of what is allocated.
/// @tparam plain_malloc      EIGEN_MALLOC_ALREADY_ALIGNED: whether blocks are those of malloc.
/// @tparam index_size        sizeof(Eigen::Index).
/// @tparam row_major         Whether matrices are by rows if nothing else is said.
/// @tparam world, major      Eigen's version.
template <std::size_t static_alignment, int max_alignment, int plain_malloc, std::size_t index_size,
          bool row_major, int world, int major>
struct EigenAbi {
  /// Does nothing. Defined for the library's own kind alone, in abi.cpp.
  static void library_was_built_for_this() noexcept;
};

/// The kind of the file that includes this.
using EigenAbiOfThisFile =
    EigenAbi<alignof(Eigen::Isometry3d), EIGEN_MAX_ALIGN_BYTES, EIGEN_MALLOC_ALREADY_ALIGNED,
             sizeof(Eigen::Index), Eigen::MatrixXd::IsRowMajor, EIGEN_WORLD_VERSION,
             EIGEN_MAJOR_VERSION>;

namespace {
/// The reference that the linker must find. In every file a variable of its own, which neither the
/// optimiser nor --gc-sections takes away.
[[gnu::used, gnu::retain]] constexpr auto* const eigen_abi_reference =
    &EigenAbiOfThisFile::library_was_built_for_this;
}  // namespace

}  // namespace pdoik
