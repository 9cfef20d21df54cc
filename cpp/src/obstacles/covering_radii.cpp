#include <algorithm>

#include "obstacles/nearest_kept.hpp"

namespace pdoik {

Eigen::VectorXd covering_radii(const Obstacles& points, const Points& kept, double leaf) {
  const std::vector<Eigen::Index> owner = detail::nearest_kept(points, kept, leaf);
  Eigen::VectorXd squared = Eigen::VectorXd::Zero(kept.rows());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Index row = owner[static_cast<std::size_t>(i)];
    if (row >= 0)
      squared[row] = std::max(squared[row], (points.row(i) - kept.row(row)).squaredNorm());
  }
  return squared.cwiseSqrt();
}

}  // namespace pdoik
