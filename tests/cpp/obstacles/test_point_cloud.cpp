#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "arms.hpp"
#include "pdoik/point_cloud.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

/// The mean of each cell's points, by a map over cells.
std::map<std::array<int, 3>, Eigen::Vector3d> cell_means(const ObstacleMatrix& points,
                                                         double leaf) {
  std::map<std::array<int, 3>, std::pair<Eigen::Vector3d, int>> sums;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (!points.row(i).allFinite()) continue;
    std::array<int, 3> cell;
    for (int k = 0; k < 3; ++k)
      cell[static_cast<std::size_t>(k)] = static_cast<int>(std::floor(points(i, k) / leaf));
    auto& [sum, count] = sums.try_emplace(cell, Eigen::Vector3d::Zero(), 0).first->second;
    sum += points.row(i).transpose();
    ++count;
  }
  std::map<std::array<int, 3>, Eigen::Vector3d> means;
  for (const auto& [cell, sum] : sums) means[cell] = sum.first / sum.second;
  return means;
}

TEST(PointCloud, keeps_the_mean_of_each_occupied_cell) {
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const double leaf = random.uniform(0.05, 0.5);
    ObstacleMatrix points = random_obstacles(random, random.integer(1, 400), 1.0);
    for (Eigen::Index i = 0; i < points.rows();
         ++i) {  // off the cells' walls, which PCL sees in float
      for (int k = 0; k < 3; ++k) {
        const double within = points(i, k) / leaf - std::floor(points(i, k) / leaf);
        if (within < 1e-4 || within > 1.0 - 1e-4) points(i, k) += 1e-3 * leaf;
      }
    }
    if (seed % 3 == 0) points(0, 1) = std::nan("");
    const auto expected = cell_means(points, leaf);
    const Points kept = voxel_downsample(points, leaf);
    ASSERT_EQ(static_cast<std::size_t>(kept.rows()), expected.size());
    for (const auto& [cell, mean] : expected) {
      EXPECT_LT((kept.rowwise() - mean.transpose()).rowwise().norm().minCoeff(), 2e-6);
    }
  }
}

TEST(PointCloud, is_empty_without_points_and_refuses_leaves_and_shapes_that_make_no_sense) {
  EXPECT_EQ(voxel_downsample(ObstacleMatrix(0, 3), 0.1).rows(), 0);
  const ObstacleMatrix nothing_finite = ObstacleMatrix::Constant(4, 3, std::nan(""));
  EXPECT_EQ(voxel_downsample(nothing_finite, 0.1).rows(), 0);
  const ObstacleMatrix points = ObstacleMatrix::Random(5, 3);
  for (const double leaf :
       {0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity(), 1e-12}) {
    EXPECT_THROW(voxel_downsample(points, leaf), std::invalid_argument) << leaf;
  }
  EXPECT_THROW(voxel_downsample(ObstacleMatrix::Random(5, 2), 0.1), std::invalid_argument);
  EXPECT_THROW(voxel_downsample(ObstacleMatrix::Constant(1, 3, 1e30), 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace pdoik
