#include "pdoik/point_cloud.hpp"

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace pdoik {
namespace {

/// The cell numbers PCL would use must fit its 32-bit index, or it hands the cloud back unfiltered.
void check_grid(const Eigen::Array3d& low, const Eigen::Array3d& high, double leaf) {
  const Eigen::Array3d cells = (high / leaf).floor() - (low / leaf).floor() + 1.0;
  const double index_limit = static_cast<double>(std::numeric_limits<std::int32_t>::max());
  const bool coordinates_fit =
      (low / leaf).minCoeff() > -index_limit && (high / leaf).maxCoeff() < index_limit;
  if (cells.prod() < 0.999 * index_limit && coordinates_fit) return;
  std::ostringstream message;
  message << "leaf is " << leaf << " m, too small for a cloud from " << low.transpose() << " to "
          << high.transpose() << " m: PCL numbers cells with 32 bits";
  throw std::invalid_argument(message.str());
}

}  // namespace

Points voxel_downsample(const Obstacles& points, double leaf) {
  if (!(leaf > 0.0 && std::isfinite(leaf))) {
    std::ostringstream message;
    message << "leaf is " << leaf << ", expected a positive finite length [m]";
    throw std::invalid_argument(message.str());
  }
  if (points.rows() == 0) return Points(0, 3);
  if (points.cols() != 3) {
    throw std::invalid_argument("points has shape (" + std::to_string(points.rows()) + ", " +
                                std::to_string(points.cols()) + "), expected (N, 3)");
  }
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->reserve(static_cast<std::size_t>(points.rows()));
  constexpr double kFloatMax = 1e15;  // PCL squares coordinates in float32
  Eigen::Array3d low = Eigen::Array3d::Constant(1e300), high = -low;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    const Eigen::Array3d p = points.row(i).transpose();
    if (!p.isFinite().all()) continue;
    if (p.abs().maxCoeff() > kFloatMax) {
      throw std::invalid_argument("points has a coordinate beyond 1e15 m in row " +
                                  std::to_string(i));
    }
    low = low.min(p);
    high = high.max(p);
    cloud->emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                        static_cast<float>(p.z()));
  }
  if (cloud->empty()) return Points(0, 3);
  check_grid(low, high, leaf);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  const auto edge = static_cast<float>(leaf);
  grid.setLeafSize(edge, edge, edge);
  grid.setInputCloud(cloud);
  pcl::PointCloud<pcl::PointXYZ> kept;
  grid.filter(kept);
  Points result(static_cast<Eigen::Index>(kept.size()), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    result.row(static_cast<Eigen::Index>(i)) << kept[i].x, kept[i].y, kept[i].z;
  }
  return result;
}

}  // namespace pdoik
