#include "pdoik/shrink_wrap.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "hulls/nearest_capsule.hpp"

namespace pdoik {
namespace {

using detail::PointGroups;
using detail::PointRun;
using detail::Rod;
using CapsuleRow = Eigen::Matrix<double, 1, 7>;

constexpr int kSamples = 64;              // points on each capsule's surface
constexpr int kPulling = 2500;            // points that pull
constexpr int kPullingSteps = 4;          // after so many they are chosen anew
constexpr double kFirstShift = 2e-3;      // of the first step [m]
constexpr double kThinnestRadius = 1e-3;  // [m]
constexpr double kStiffness = 2e4;        // of the points' pull against the surface's [1/m]
constexpr double kFreeShare = 0.3;        // of the capsules' surface that is free, about
constexpr double kMomentum = 0.8, kSecondMomentum = 0.95;  // Adam's

/// Points evenly over a capsule's surface, by a spiral around its axis: by Archimedes' theorem
/// equal heights along the axis, caps included, are equal areas.
class Spiral {
 public:
  explicit Spiral(double turn) {
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double n = static_cast<double>(i);
      height[i] = static_cast<float>((n + std::fmod(0.5 + turn, 1.0)) / kSamples);
      const double angle = golden * n + 2.0 * std::numbers::pi * turn;
      cosine[i] = static_cast<float>(std::cos(angle));
      sine[i] = static_cast<float>(std::sin(angle));
    }
  }

  std::array<float, kSamples> height, cosine, sine;  // heights as a share of the whole
};

/// Points on a capsule that are outside the solid.
struct OutsideSamples {
  std::array<float, kSamples> x, y, z;  // [m]
  std::array<float, kSamples> nx, ny, nz;
  std::array<float, kSamples> at;     // the place on the segment, 0 at a and 1 at b
  std::array<float, kSamples> depth;  // < 0 [m]
  int count = 0;

  PointRun run() const { return {x.data(), y.data(), z.data(), count}; }
};

float surface_area(const Rod& rod) {
  return 2.0f * std::numbers::pi_v<float> * rod.radius * (rod.length + 2.0f * rod.radius);
}

std::vector<Rod> to_rods(const CapsuleRows& capsules) {
  std::vector<Rod> rods;
  for (Eigen::Index k = 0; k < capsules.rows(); ++k)
    rods.push_back(detail::to_rod(capsules.row(k).transpose()));
  return rods;
}

Eigen::Vector3f middle_of(const Rod& rod) {
  return Eigen::Vector3f(rod.ax, rod.ay, rod.az) +
         rod.length / 2.0f * Eigen::Vector3f(rod.ux, rod.uy, rod.uz);
}

struct Adam {
  explicit Adam(Eigen::Index rows)
      : first(CapsuleRows::Zero(rows, 7)), second(CapsuleRows::Zero(rows, 7)) {}

  /// The n-th step, of a length of about `shift` for each capsule, in the gradient's direction.
  void step(const CapsuleRows& gradient, int n, double shift, CapsuleRows& x) {
    first = kMomentum * first + (1.0 - kMomentum) * gradient;
    second = kSecondMomentum * second + (1.0 - kSecondMomentum) * gradient.cwiseAbs2();
    const double unbias = 1.0 - std::pow(kSecondMomentum, n);
    const double scale = shift / (1.0 - std::pow(kMomentum, n));
    for (Eigen::Index k = 0; k < x.rows(); ++k)
      x.row(k) -= scale / (std::sqrt(second.row(k).sum() / unbias) + 1e-12) * first.row(k);
    x.col(6) = x.col(6).cwiseMax(kThinnestRadius);
  }

  CapsuleRows first, second;
};

}  // namespace

struct ShrinkWrap::Implementation {
  Eigen::Vector3i shape;
  Eigen::Array3f origin;  // from the middle, as all points are
  float per_edge;         // [1/m]
  Eigen::ArrayXf depth;
  float worst;
  Eigen::Vector3d middle;
  PointGroups points;

  /// Interpolated; off the grid that of its rim.
  float depth_at(float x, float y, float z) const {
    const std::array<float, 3> place{x, y, z};
    std::array<int, 3> cell;
    std::array<float, 3> share;
    for (std::size_t i = 0; i < 3; ++i) {
      const int last = shape[static_cast<Eigen::Index>(i)] - 1;
      const float at = std::clamp((place[i] - origin[static_cast<Eigen::Index>(i)]) * per_edge,
                                  0.0f, static_cast<float>(last));
      cell[i] = std::min(static_cast<int>(at), last - 1);
      share[i] = at - static_cast<float>(cell[i]);
    }
    const Eigen::Index along_y = shape[2], along_x = along_y * shape[1];
    const float* const corner = depth.data() + cell[0] * along_x + cell[1] * along_y + cell[2];
    const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
    const auto along_z = [&](const float* d) { return mix(d[0], d[1], share[2]); };
    const auto in_plane = [&](const float* d) {
      return mix(along_z(d), along_z(d + along_y), share[1]);
    };
    return mix(in_plane(corner), in_plane(corner + along_x), share[0]);
  }

  OutsideSamples outside_samples(const Rod& rod, const Spiral& spiral) const {
    const Eigen::Vector3f u(rod.ux, rod.uy, rod.uz), a(rod.ax, rod.ay, rod.az);
    const Eigen::Vector3f v = u.unitOrthogonal(), w = u.cross(v);
    OutsideSamples result;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const float height = spiral.height[i] * (rod.length + 2.0f * rod.radius) - rod.radius;
      const float on_axis = std::min(std::max(height, 0.0f), rod.length);
      const float sine = (height - on_axis) / rod.radius;
      const float cosine = std::sqrt(std::max(1.0f - sine * sine, 0.0f));
      const Eigen::Vector3f normal =
          sine * u + cosine * spiral.cosine[i] * v + cosine * spiral.sine[i] * w;
      const Eigen::Vector3f point = a + on_axis * u + rod.radius * normal;
      const float depth_here = depth_at(point.x(), point.y(), point.z());
      if (!(depth_here < 0.0f)) continue;
      const auto n = static_cast<std::size_t>(result.count++);
      result.x[n] = point.x(), result.y[n] = point.y(), result.z[n] = point.z();
      result.nx[n] = normal.x(), result.ny[n] = normal.y(), result.nz[n] = normal.z();
      result.at[n] = on_axis / std::max(rod.length, 1e-9f);
      result.depth[n] = depth_here;
    }
    return result;
  }

  CapsuleRow outside_gradient(std::span<const Rod> rods, std::size_t k,
                              const Spiral& spiral) const {
    const Rod& own = rods[k];
    const OutsideSamples on = outside_samples(own, spiral);
    std::array<float, kSamples> gap;
    std::array<int, kSamples> nearest;
    gap.fill(std::numeric_limits<float>::infinity());
    const Eigen::Vector3f around = middle_of(own);
    for (std::size_t j = 0; j < rods.size() && on.count > 0; ++j) {
      const float apart = detail::gap_of(around.x(), around.y(), around.z(), rods[j]);
      if (j == k || apart > own.length / 2.0f + own.radius) continue;
      detail::lower_gaps(on.run(), rods[j], static_cast<int>(j), gap.data(), nearest.data());
    }
    Eigen::Array<float, 7, 1> sum = Eigen::Array<float, 7, 1>::Zero();
    for (std::size_t i = 0; i < static_cast<std::size_t>(on.count); ++i) {
      if (!(gap[i] > 0.0f)) continue;  // in another one
      const float share = on.depth[i] / worst, cubed = share * share * share;
      const float f = 1.0f + cubed * cubed, by_a = f * (1.0f - on.at[i]), by_b = f * on.at[i];
      sum[0] += by_a * on.nx[i], sum[1] += by_a * on.ny[i], sum[2] += by_a * on.nz[i];
      sum[3] += by_b * on.nx[i], sum[4] += by_b * on.ny[i], sum[5] += by_b * on.nz[i];
      sum[6] += f;
    }
    return (surface_area(own) / kSamples * sum).cast<double>().matrix().transpose();
  }

  CapsuleRows outside_gradient(std::span<const Rod> rods, double turn) const {
    const Spiral spiral(turn);
    CapsuleRows result(static_cast<Eigen::Index>(rods.size()), 7);
    for (std::size_t k = 0; k < rods.size(); ++k)
      result.row(static_cast<Eigen::Index>(k)) = outside_gradient(rods, k, spiral);
    return result;
  }

  /// As seen from the middle.
  CapsuleRows taken_in(const CapsuleRows& capsules) const {
    if (!capsules.allFinite() || (capsules.col(6).array() <= 0.0).any())
      throw std::invalid_argument("capsules must be finite, with positive radii");
    return shifted(capsules, -middle);
  }

  static CapsuleRows shifted(CapsuleRows capsules, const Eigen::Vector3d& by) {
    capsules.leftCols<3>().rowwise() += by.transpose();
    capsules.middleCols<3>(3).rowwise() += by.transpose();
    return capsules;
  }
};

namespace {

/// How points that are outside, or were, draw the capsule nearest to each: the gradient of their
/// part of the Lagrangian, which it returns, added to.
double add_lack(const PointGroups& points, const Eigen::ArrayXd& multipliers, double rho,
                double weight, const CapsuleRows& capsules, std::span<const Rod> rods,
                CapsuleRows& gradient) {
  Eigen::ArrayXf gap;
  Eigen::ArrayXi own;
  points.nearest(rods, gap, own);
  double sum = 0.0;
  for (int i = 0; i < points.size(); ++i) {
    const double force = std::max(multipliers[i] + rho * static_cast<double>(gap[i]), 0.0);
    sum += (force * force - multipliers[i] * multipliers[i]) / (2.0 * rho);
    if (force == 0.0) continue;
    const Eigen::Vector3d p = points.point(i).cast<double>();
    const auto capsule = capsules.row(own[i]);
    const Eigen::Vector3d a = capsule.head<3>(), along = capsule.segment<3>(3).transpose() - a;
    const double t =
        std::clamp((p - a).dot(along) / std::max(along.squaredNorm(), 1e-18), 0.0, 1.0);
    Eigen::Vector3d away = p - a - t * along;
    away *= weight * force / std::max(away.norm(), 1e-9);
    auto row = gradient.row(own[i]);
    row.head<3>() -= (1.0 - t) * away;
    row.segment<3>(3) -= t * away;
    row[6] -= weight * force;
  }
  return weight * sum;
}

/// Places of the largest, ascending.
std::vector<int> largest(const Eigen::ArrayXd& values, int count) {
  std::vector<int> places(static_cast<std::size_t>(values.size()));
  std::iota(places.begin(), places.end(), 0);
  if (count >= static_cast<int>(places.size())) return places;
  std::nth_element(places.begin(), places.begin() + count, places.end(), [&](int i, int j) {
    return values[i] != values[j] ? values[i] > values[j] : i < j;
  });
  places.resize(static_cast<std::size_t>(count));
  std::sort(places.begin(), places.end());
  return places;
}

Eigen::ArrayXd at_places(const Eigen::ArrayXd& values, const std::vector<int>& places) {
  Eigen::ArrayXd result(static_cast<Eigen::Index>(places.size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result[i] = values[places[static_cast<std::size_t>(i)]];
  return result;
}

}  // namespace

ShrinkWrap::ShrinkWrap(const DepthGrid& grid,
                       const Eigen::Matrix<double, Eigen::Dynamic, 3>& points, double worst) {
  if ((grid.shape.array() < 2).any() || grid.depth.size() != grid.shape.cast<Eigen::Index>().prod())
    throw std::invalid_argument("depth has " + std::to_string(grid.depth.size()) +
                                " entries, expected at least two along each axis, all of them");
  if (!(grid.edge > 0.0) || !(worst > 0.0))
    throw std::invalid_argument("edge is " + std::to_string(grid.edge) + " and worst " +
                                std::to_string(worst) + ", expected positive");
  if (!points.allFinite() || !grid.depth.isFinite().all() || !grid.origin.allFinite())
    throw std::invalid_argument("points, depth and origin must be finite");
  const Eigen::Vector3d middle =
      grid.origin + grid.edge / 2.0 * (grid.shape.array() - 1).cast<double>().matrix();
  impl_ = std::make_unique<Implementation>(Implementation{
      grid.shape, (grid.origin - middle).cast<float>().array(), static_cast<float>(1.0 / grid.edge),
      grid.depth, static_cast<float>(worst), middle,
      PointGroups((points.rowwise() - middle.transpose()).transpose().cast<float>())});
}

ShrinkWrap::ShrinkWrap(ShrinkWrap&&) noexcept = default;
ShrinkWrap& ShrinkWrap::operator=(ShrinkWrap&&) noexcept = default;
ShrinkWrap::~ShrinkWrap() = default;

CapsuleRows ShrinkWrap::move(const CapsuleRows& capsules, int steps) const {
  CapsuleRows x = impl_->taken_in(capsules);
  const PointGroups& all = impl_->points;
  if (x.rows() == 0 || all.size() == 0) return capsules;
  double area = 0.0;
  for (const Rod& rod : to_rods(x)) area += kFreeShare * static_cast<double>(surface_area(rod));
  const double weight = 1.0 / all.size();
  Adam adam(x.rows());
  Eigen::ArrayXd multipliers = Eigen::ArrayXd::Zero(all.size()), of_pulling;
  PointGroups pulling;
  for (int n = 1; n <= steps; ++n) {
    const double progress = static_cast<double>(n) / steps;
    const double rho = 2.0 * (0.1 + 0.9 * progress) * kStiffness * area;
    const std::vector<Rod> rods = to_rods(x);
    if (n % kPullingSteps == 1) {  // look only at points that may come out before the next look
      Eigen::ArrayXf gap;
      Eigen::ArrayXi own;
      all.nearest(rods, gap, own);
      multipliers = (multipliers + rho / kPullingSteps * gap.cast<double>()).max(0.0);
      const std::vector<int> places = largest(multipliers + rho * gap.cast<double>(), kPulling);
      pulling = all.at(places);
      of_pulling = at_places(multipliers, places);
    }
    CapsuleRows gradient = impl_->outside_gradient(rods, std::fmod(0.618 * n, 1.0));
    add_lack(pulling, of_pulling, rho, weight, x, rods, gradient);
    adam.step(gradient, n, kFirstShift * (1.01 - progress), x);
  }
  return Implementation::shifted(x, impl_->middle);
}

CapsuleRows ShrinkWrap::outside_gradient(const CapsuleRows& capsules, double turn) const {
  return impl_->outside_gradient(to_rods(impl_->taken_in(capsules)), turn);
}

std::pair<double, CapsuleRows> ShrinkWrap::lack(const CapsuleRows& capsules, double multiplier,
                                                double rho) const {
  const CapsuleRows x = impl_->taken_in(capsules);
  std::pair<double, CapsuleRows> result{0.0, CapsuleRows::Zero(x.rows(), 7)};
  const auto multipliers = Eigen::ArrayXd::Constant(impl_->points.size(), multiplier);
  if (x.rows() > 0)
    result.first = add_lack(impl_->points, multipliers, rho, 1.0, x, to_rods(x), result.second);
  return result;
}

}  // namespace pdoik
