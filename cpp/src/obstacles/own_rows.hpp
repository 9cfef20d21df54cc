#pragma once

#include <algorithm>
#include <cstddef>

#include "common/large_vector.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

/// A copy of rows that are somebody else's. Another thread may write into those at any time: what
/// was checked and what is used afterwards are the same only in a copy.
class OwnRows {
 public:
  /// Room for so many obstacle points.
  void reserve(std::size_t count) { values_.reserve(4 * count); }
  /// Allocates nothing if there is room.
  template <class Rows>
  void take(const Rows& points) {
    rows_ = points.rows();
    columns_ = points.cols();
    values_.resize(static_cast<std::size_t>(rows_ * columns_));
    double* to = values_.data();
    for (Eigen::Index row = 0; row < rows_; ++row) {
      const auto* const from = points.data() + row * points.outerStride();
      to = std::copy(from, from + columns_, to);
    }
  }
  Obstacles rows() const {
    return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        values_.data(), rows_, columns_);
  }

 private:
  LargeVector<double> values_;
  Eigen::Index rows_ = 0, columns_ = 3;
};

}  // namespace pdoik::detail
