#include "hulls/nearest_capsule.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace pdoik::detail {
namespace {

constexpr int kNeighborhood = 32;     // points
constexpr float kBoundSlack = 1e-5f;  // what rounding may take from a bound [m]

/// Orders indices so that each run of kNeighborhood of them, from the front, are neighbours:
/// halves, at multiples of it, along the longest side.
void order_by_halves(const Eigen::Matrix3Xf& points, int* first, int* last) {
  const auto count = last - first;
  if (count <= kNeighborhood) return;
  Eigen::Vector3f low = points.col(*first), high = low;
  for (const int* i = first; i != last; ++i) {
    low = low.cwiseMin(points.col(*i));
    high = high.cwiseMax(points.col(*i));
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  int* const middle = first + ((count + kNeighborhood - 1) / kNeighborhood + 1) / 2 * kNeighborhood;
  const auto before = [&](int i, int j) {
    return points(axis, i) != points(axis, j) ? points(axis, i) < points(axis, j) : i < j;
  };
  std::nth_element(first, middle, last, before);
  order_by_halves(points, first, middle);
  order_by_halves(points, middle, last);
}

}  // namespace

Rod to_rod(const Eigen::Matrix<double, 7, 1>& capsule) {
  const Eigen::Vector3d a = capsule.head<3>(), along = capsule.segment<3>(3) - a;
  const double length = along.norm();
  const Eigen::Vector3d u = length > 1e-9 ? (along / length).eval() : Eigen::Vector3d::UnitZ();
  const auto to = [](double value) { return static_cast<float>(value); };
  return {to(a.x()), to(a.y()), to(a.z()),  to(u.x()),
          to(u.y()), to(u.z()), to(length), to(capsule[6])};
}

float gap_of(float x, float y, float z, const Rod& rod) {
  const float dx = x - rod.ax, dy = y - rod.ay, dz = z - rod.az;
  const float along = dx * rod.ux + dy * rod.uy + dz * rod.uz;
  const float from_a = along > 0.0f ? along : 0.0f;
  const float t = from_a < rod.length ? from_a : rod.length;
  const float ex = dx - t * rod.ux, ey = dy - t * rod.uy, ez = dz - t * rod.uz;
  return std::sqrt(ex * ex + ey * ey + ez * ez) - rod.radius;
}

void lower_gaps(const PointRun& points, const Rod& rod, int k, float* gap, int* own) {
  const Rod r = rod;
  for (int first = 0; first < points.count; first += kNeighborhood) {
    const float *const x = points.x + first, *const y = points.y + first,
                       *const z = points.z + first;
    const int count = std::min(kNeighborhood, points.count - first);
    std::array<float, kNeighborhood> found;
    for (int i = 0; i < count; ++i)
      found[static_cast<std::size_t>(i)] = gap_of(x[i], y[i], z[i], r);
    for (int i = 0; i < count; ++i) {
      const float here = found[static_cast<std::size_t>(i)];
      const int nearer = -static_cast<int>(here < gap[first + i]);  // all bits, or none
      own[first + i] = (k & nearer) | (own[first + i] & ~nearer);
      gap[first + i] = std::min(gap[first + i], here);
    }
  }
}

PointGroups::PointGroups(const Eigen::Matrix3Xf& points) : points_(points.cols(), 3) {
  std::vector<int> order(static_cast<std::size_t>(points.cols()));
  std::iota(order.begin(), order.end(), 0);
  order_by_halves(points, order.data(), order.data() + order.size());
  for (int i = 0; i < size(); ++i)
    points_.row(i) = points.col(order[static_cast<std::size_t>(i)]).transpose();
  bound();
}

PointGroups PointGroups::at(std::span<const int> places) const {
  PointGroups result;
  result.points_.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (int i = 0; i < result.size(); ++i)
    result.points_.row(i) = points_.row(places[static_cast<std::size_t>(i)]);
  result.bound();
  return result;
}

void PointGroups::bound() {
  const int count = (size() + kNeighborhood - 1) / kNeighborhood;
  centers_.resize(count, 3);
  reach_.resize(count);
  for (int g = 0; g < count; ++g) {
    const auto of_group =
        points_.middleRows(g * kNeighborhood, std::min(kNeighborhood, size() - g * kNeighborhood));
    centers_.row(g) = (of_group.colwise().minCoeff() + of_group.colwise().maxCoeff()) / 2.0f;
    reach_[g] = (of_group.rowwise() - centers_.row(g)).rowwise().norm().maxCoeff() + kBoundSlack;
  }
}

void PointGroups::nearest(std::span<const Rod> rods, Eigen::ArrayXf& gap,
                          Eigen::ArrayXi& own) const {
  constexpr float kNoGap = std::numeric_limits<float>::infinity();
  gap.setConstant(size(), kNoGap);
  own.setConstant(size(), -1);
  const int count = static_cast<int>(rods.size());
  Eigen::ArrayXXf of_center(groups(), count);
  Eigen::ArrayXf least = Eigen::ArrayXf::Constant(groups(), kNoGap);
  const PointRun centers{centers_.col(0).data(), centers_.col(1).data(), centers_.col(2).data(),
                         groups()};
  for (int k = 0; k < count; ++k) {
    const Rod rod = rods[static_cast<std::size_t>(k)];
    float* const found = of_center.col(k).data();
    for (int g = 0; g < centers.count; ++g)
      found[g] = gap_of(centers.x[g], centers.y[g], centers.z[g], rod);
    least = least.min(of_center.col(k));
  }
  least += 2.0f * reach_;  // each point's least gap is less by the reach at least
  for (int g = 0; g < groups(); ++g) {
    const int first = g * kNeighborhood;
    const PointRun run{points_.col(0).data() + first, points_.col(1).data() + first,
                       points_.col(2).data() + first, std::min(kNeighborhood, size() - first)};
    for (int k = 0; k < count; ++k) {
      if (of_center(g, k) <= least[g])
        lower_gaps(run, rods[static_cast<std::size_t>(k)], k, gap.data() + first,
                   own.data() + first);
    }
  }
}

}  // namespace pdoik::detail
