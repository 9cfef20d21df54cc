#include "obstacles/check_obstacles.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "common/check_input.hpp"
#include "pdoik/cloud.hpp"

namespace pdoik::detail {

template <class Rows>
bool accepts_obstacles(const Rows& points, InputError& error, const char* name) {
  error.clear();
  if (points.rows() == 0) return true;
  const auto row = [](Eigen::Index i) { return static_cast<long long>(i); };
  if (points.cols() != 3 && points.cols() != 4)
    return error.say("%s has shape (%lld, %lld), expected (N, 3) or (N, 4)", name,
                     row(points.rows()), row(points.cols()));
  // Zero times a finite number is zero: one pass without a branch finds whether anything is wrong.
  using Scalar = typename Rows::Scalar;
  const bool has_radius = points.cols() == 4;
  Scalar poison = 0, least_radius = 0, largest = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Scalar x = points(i, 0), y = points(i, 1), z = points(i, 2),
                 r = has_radius ? points(i, 3) : Scalar{0};
    poison += Scalar{0} * x + Scalar{0} * y + Scalar{0} * z + Scalar{0} * r;
    largest =
        std::max(largest, std::max(std::max(std::abs(x), std::abs(y)), std::max(std::abs(z), r)));
    least_radius = std::min(least_radius, r);
  }
  if (poison == Scalar{0} && least_radius >= Scalar{0} && largest <= Scalar{kLargestNumber})
    return true;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (!points.row(i).allFinite())
      return error.say("%s holds NaN or infinity in row %lld", name, row(i));
    if (points.row(i).cwiseAbs().maxCoeff() > Scalar{kLargestNumber})
      return error.say("%s has a number beyond 1e6 m in row %lld", name, row(i));
    if (points.cols() == 4 && points(i, 3) < Scalar{0})
      return error.say("%s has a negative radius in row %lld", name, row(i));
  }
  return true;
}
template bool accepts_obstacles(const Obstacles&, InputError&, const char*);
template bool accepts_obstacles(const ObstaclesF&, InputError&, const char*);

void check_obstacles(const Obstacles& points) {
  InputError error;
  accepts_obstacles(points, error);
  error.raise();
}

void check_count(Eigen::Index points, const char* name) {
  if (static_cast<std::size_t>(points) <= Cloud::kMostPoints) return;
  throw std::invalid_argument(std::string(name) + " has " + std::to_string(points) +
                              " rows, expected at most " + std::to_string(Cloud::kMostPoints) +
                              ": thin them out first (voxel_downsample)");
}

}  // namespace pdoik::detail
