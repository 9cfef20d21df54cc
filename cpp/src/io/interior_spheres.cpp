#include "pdoik/interior_spheres.hpp"

#include <pcl/features/normal_3d.h>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "obstacles/enclosed_space.hpp"
#include "obstacles/nearest_kept.hpp"

namespace pdoik {
namespace {

using Eigen::Vector3d;

/// The finite points of a cloud as PCL has them, relative to their middle: it computes in float32.
class Surface {
 public:
  explicit Surface(const Obstacles& points) : cloud_(new pcl::PointCloud<pcl::PointXYZ>) {
    Vector3d sum = Vector3d::Zero();
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      if (!points.row(i).allFinite()) continue;
      rows_.push_back(i);
      sum += points.row(i).transpose();
    }
    if (rows_.empty()) return;
    middle_ = sum / static_cast<double>(rows_.size());
    cloud_->reserve(rows_.size());
    for (const Eigen::Index row : rows_) cloud_->push_back(to_pcl(points.row(row).transpose()));
    tree_.setInputCloud(cloud_);
  }

  /// Rows of the points within a distance.
  const std::vector<Eigen::Index>& around(const Vector3d& center, double distance) {
    tree_.radiusSearch(to_pcl(center), distance, found_, squared_);
    near_.clear();
    for (const int k : found_) near_.push_back(rows_[static_cast<std::size_t>(k)]);
    return near_;
  }
  /// A unit normal of the points that `around` found last, either way; none of fewer than three.
  std::optional<Vector3d> normal() {
    Eigen::Vector4f plane;
    float curvature;
    if (!pcl::computePointNormal(*cloud_, found_, plane, curvature)) return std::nullopt;
    const Vector3d n = plane.head<3>().cast<double>().normalized();
    return n.allFinite() ? std::optional(n) : std::nullopt;
  }
  double distance_to_nearest(const Vector3d& center) {
    tree_.nearestKSearch(to_pcl(center), 1, found_, squared_);
    return std::sqrt(static_cast<double>(squared_.front()));
  }

 private:
  pcl::PointXYZ to_pcl(const Vector3d& point) const {
    const Eigen::Vector3f p = (point - middle_).cast<float>();
    return {p.x(), p.y(), p.z()};
  }

  Vector3d middle_ = Vector3d::Zero();
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud_;
  std::vector<Eigen::Index> rows_, near_;
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
  std::vector<int> found_;
  std::vector<float> squared_;
};

/// Which way is out.
class Outside {
 public:
  Outside(const Obstacles& points, double leaf, const Points& viewpoints)
      : points_(points), viewpoints_(viewpoints) {
    if (viewpoints.rows() > 0) return;
    for (const double edge : {0.5 * leaf, leaf}) spaces_.emplace_back(points, edge);
  }

  /// The normal turned outward, if that is certain.
  std::optional<Vector3d> turned(const Vector3d& center, const Vector3d& normal,
                                 const std::vector<Eigen::Index>& near) const {
    if (spaces_.empty()) return by_views(normal, near);
    using Kind = detail::EnclosedSpace::Kind;
    for (const detail::EnclosedSpace& space : spaces_) {
      const Kind ahead = space.beyond_surface(center, normal);
      const Kind behind = space.beyond_surface(center, -normal);
      if (ahead == Kind::Open && behind == Kind::Enclosed) return normal;
      if (ahead == Kind::Enclosed && behind == Kind::Open) return -normal;
    }
    return std::nullopt;
  }

 private:
  std::optional<Vector3d> by_views(const Vector3d& normal,
                                   const std::vector<Eigen::Index>& near) const {
    constexpr double kGrazing = 0.17;  // the sine of ten degrees, which noise may turn a normal by
    bool before = false, behind = false;
    for (const Eigen::Index row : near) {
      const Eigen::Index view = viewpoints_.rows() == 1 ? 0 : row;
      const Vector3d towards = (viewpoints_.row(view) - points_.row(row)).transpose();
      const double side = normal.dot(towards), least = kGrazing * towards.norm();
      before |= side >= -least;
      behind |= side <= least;
    }
    if (before == behind) return std::nullopt;
    return before ? normal : Vector3d(-normal);
  }

  const Obstacles& points_;
  const Points& viewpoints_;
  std::vector<detail::EnclosedSpace> spaces_;  // fine cells for boards, wide ones for noise
};

/// How far points reach in a plane from a center, on the side where there are fewest of them:
/// behind an edge of what was seen there may be a face that was not.
double reach_beside(const Obstacles& points, const std::vector<Eigen::Index>& near,
                    const Vector3d& center, const Vector3d& normal) {
  Vector3d mean = Vector3d::Zero();
  for (const Eigen::Index row : near) mean += points.row(row).transpose() - center;
  const Vector3d empty_side = -(mean - normal.dot(mean) * normal).normalized();
  double reach = 0.0;
  for (const Eigen::Index row : near)
    reach = std::max(reach, empty_side.dot(points.row(row).transpose() - center));
  return reach;
}

/// The points that each ball has to hold.
class Patches {
 public:
  Patches(const Obstacles& points, const Points& kept, double leaf) : points_(points) {
    rows_.resize(static_cast<std::size_t>(kept.rows()));
    const std::vector<Eigen::Index> owner = detail::nearest_kept(points, kept, leaf);
    for (std::size_t i = 0; i < owner.size(); ++i) {
      if (owner[i] >= 0)
        rows_[static_cast<std::size_t>(owner[i])].push_back(static_cast<Eigen::Index>(i));
    }
  }

  /// Of the ball about a centre that holds the patch.
  double radius(Eigen::Index patch, const Vector3d& center) const {
    double squared = 0.0;
    for (const Eigen::Index row : rows_[static_cast<std::size_t>(patch)])
      squared = std::max(squared, (points_.row(row).transpose() - center).squaredNorm());
    return std::sqrt(squared);
  }

 private:
  const Obstacles& points_;
  std::vector<std::vector<Eigen::Index>> rows_;
};

void check(const Obstacles& points, const InteriorSphereOptions& options) {
  const Points& views = options.viewpoints;
  if (views.rows() > 1 && views.rows() != points.rows())
    throw std::invalid_argument("viewpoints has " + std::to_string(views.rows()) +
                                " rows, expected 1 or one for each of " +
                                std::to_string(points.rows()) + " points");
  for (Eigen::Index i = 0; i < views.rows(); ++i) {
    const bool counts = views.rows() == 1 || points.row(i).allFinite();
    if (counts && !views.row(i).allFinite())
      throw std::invalid_argument("viewpoints holds NaN or infinity in row " + std::to_string(i));
  }
  if (!(options.depth >= 0.0 && std::isfinite(options.depth)))
    throw std::invalid_argument("depth is " + std::to_string(options.depth) +
                                ", expected a finite length that is not negative [m]");
}

}  // namespace

Balls interior_spheres(const Obstacles& points, const Points& kept, double leaf,
                       const InteriorSphereOptions& options) {
  check(points, options);
  const Patches patches(points, kept, leaf);
  Balls balls(kept.rows(), 4);
  for (Eigen::Index k = 0; k < kept.rows(); ++k)
    balls.row(k) << kept.row(k), patches.radius(k, kept.row(k).transpose());
  if (points.rows() == 0) return balls;

  // Nearer to the surface than this share of its depth, a centre is no longer below its own patch.
  constexpr double kLeastDepth = 0.7;
  const double depth = options.depth > 0.0 ? options.depth : 2.0 * leaf;
  const int steps = static_cast<int>(std::ceil(depth / (0.5 * leaf)));
  Surface surface(points);
  const Outside outside(points, leaf, options.viewpoints);
  for (Eigen::Index k = 0; k < kept.rows(); ++k) {
    const Vector3d start = kept.row(k).transpose();
    double least = balls(k, 3);  // how far the ball stands beyond the points
    if (least == 0.0) continue;
    const std::vector<Eigen::Index>& near = surface.around(start, leaf);
    const std::optional<Vector3d> normal = surface.normal();
    const std::optional<Vector3d> out =
        normal ? outside.turned(start, *normal, near) : std::nullopt;
    if (!out) continue;
    const double beside =
        options.viewpoints.rows() > 0
            ? reach_beside(points, surface.around(start, depth + leaf), start, *out)
            : std::numeric_limits<double>::infinity();
    for (int step = 1; step <= steps; ++step) {
      const double inside = depth * step / steps;
      const Vector3d center = start - inside * *out;
      if (options.within && !options.within->contains(center)) break;
      const double below = std::min(beside, surface.distance_to_nearest(center));
      if (below < kLeastDepth * inside) break;
      const double radius = patches.radius(k, center);
      if (radius - below >= least) continue;
      least = radius - below;
      balls.row(k) << center.transpose(), radius;
    }
  }
  return balls;
}

}  // namespace pdoik
