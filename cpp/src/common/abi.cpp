#include "pdoik/abi.hpp"

namespace pdoik {

template <std::size_t static_alignment, int max_alignment, int plain_malloc, std::size_t index_size,
          bool row_major, int world, int major>
void EigenAbi<static_alignment, max_alignment, plain_malloc, index_size, row_major, world,
              major>::library_was_built_for_this() noexcept {}

template struct EigenAbi<alignof(Eigen::Isometry3d), EIGEN_MAX_ALIGN_BYTES,
                         EIGEN_MALLOC_ALREADY_ALIGNED, sizeof(Eigen::Index),
                         Eigen::MatrixXd::IsRowMajor, EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION>;

}  // namespace pdoik
