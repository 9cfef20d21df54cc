#include <gtest/gtest.h>

#include "arms.hpp"
#include "obstacles/enclosed_space.hpp"
#include "pdoik/interior_spheres.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;
using Kind = detail::EnclosedSpace::Kind;

/// The surface of a cube of edge `size` about the origin, neighbours `spacing` apart.
ObstacleMatrix cube(double size, double spacing) {
  const int n = static_cast<int>(size / spacing + 0.5);
  std::vector<Eigen::RowVector3d> rows;
  for (int x = 0; x <= n; ++x) {
    for (int y = 0; y <= n; ++y) {
      for (int z = 0; z <= n; ++z) {
        const bool on = x % n == 0 || y % n == 0 || z % n == 0;
        if (on) rows.emplace_back(Eigen::RowVector3d(x, y, z) * (size / n));
      }
    }
  }
  ObstacleMatrix points(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) = rows[i].array() - 0.5 * size;
  return points;
}

TEST(EnclosedSpace, a_closed_surface_encloses_its_inside_and_an_open_one_nothing) {
  const ObstacleMatrix closed = cube(0.1, 0.0033);
  const detail::EnclosedSpace space(closed, 0.007);
  EXPECT_EQ(space.at({0.0, 0.0, 0.0}), Kind::Enclosed);
  EXPECT_EQ(space.at({0.0, 0.0, 0.08}), Kind::Open);
  EXPECT_EQ(space.at({5.0, 0.0, 0.0}), Kind::Open);
  EXPECT_EQ(space.beyond_surface({0.05, 0.0, 0.0}, {1.0, 0.0, 0.0}), Kind::Open);
  EXPECT_EQ(space.beyond_surface({0.05, 0.0, 0.0}, {-1.0, 0.0, 0.0}), Kind::Enclosed);

  ObstacleMatrix open = closed;
  for (Eigen::Index i = 0; i < open.rows(); ++i) {
    if (open.row(i).head<2>().norm() < 0.03 && open(i, 2) > 0.0) open.row(i).setConstant(NAN);
  }
  EXPECT_EQ(detail::EnclosedSpace(open, 0.007).at({0.0, 0.0, 0.0}), Kind::Open);
  EXPECT_EQ(detail::EnclosedSpace(ObstacleMatrix(0, 3), 0.007).at({0.0, 0.0, 0.0}), Kind::Open);
}

TEST(EnclosedSpace, gaps_between_points_that_scatter_are_no_inside) {
  ObstacleMatrix around(6, 3);  // all six neighbours of one cell
  around << 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1;
  EXPECT_EQ(detail::EnclosedSpace(around, 1.0).at({0.1, 0.1, 0.1}), Kind::Surface);
}

TEST(EnclosedSpace, wide_clouds_get_wider_cells) {
  ObstacleMatrix points(2, 3);
  points << 0, 0, 0, 100, 100, 100;
  const detail::EnclosedSpace space(points, 1e-3);
  EXPECT_GT(space.edge(), 0.2);
  EXPECT_EQ(space.at({100.0, 100.0, 100.0}), Kind::Surface);
}

TEST(InteriorSpheres, hold_every_point_and_stand_out_little) {
  const ObstacleMatrix points = cube(0.1, 0.0033);
  for (const double leaf : {0.01, 0.013}) {
    const Points kept = voxel_downsample(points, leaf);
    const Balls balls = interior_spheres(points, kept, leaf);
    ASSERT_EQ(balls.rows(), kept.rows());
    for (Eigen::Index i = 0; i < points.rows(); ++i) {
      const Eigen::ArrayXd beyond =
          (balls.leftCols<3>().rowwise() - points.row(i)).rowwise().norm() - balls.col(3);
      EXPECT_LE(beyond.minCoeff(), 1e-12);
    }
    int inside = 0;
    for (Eigen::Index k = 0; k < balls.rows(); ++k) {
      if (balls.row(k).head<3>() == kept.row(k)) continue;
      ++inside;
      EXPECT_LT(balls.row(k).head<3>().cwiseAbs().maxCoeff(), 0.05) << "a centre outside";
    }
    EXPECT_GT(inside, 0.8 * static_cast<double>(balls.rows()));
  }
}

TEST(InteriorSpheres, go_no_deeper_than_asked_and_not_out_of_a_region) {
  const ObstacleMatrix points = cube(0.1, 0.0033);
  const Points kept = voxel_downsample(points, 0.01);
  for (const double depth : {0.004, 0.02}) {
    const Balls balls = interior_spheres(points, kept, 0.01, {.depth = depth});
    EXPECT_LE((balls.leftCols<3>() - kept).rowwise().norm().maxCoeff(), depth + 1e-9);
    EXPECT_GT((balls.leftCols<3>() - kept).rowwise().norm().maxCoeff(), 0.9 * depth);
  }
  const Eigen::AlignedBox3d below(Eigen::Vector3d(-1, -1, -1), Eigen::Vector3d(1, 1, 0));
  const Balls balls = interior_spheres(points, kept, 0.01, {.within = below});
  for (Eigen::Index k = 0; k < balls.rows(); ++k)
    EXPECT_TRUE(balls(k, 2) <= 0.0 || balls.row(k).head<3>() == kept.row(k));
}

TEST(InteriorSpheres, refuse_what_makes_no_sense) {
  const ObstacleMatrix points = cube(0.1, 0.01);
  const Points kept = voxel_downsample(points, 0.02);
  EXPECT_THROW(interior_spheres(points, kept, 0.02, {.viewpoints = Points::Zero(2, 3)}),
               std::invalid_argument);
  EXPECT_THROW(interior_spheres(points, kept, 0.02, {.viewpoints = Points::Constant(1, 3, NAN)}),
               std::invalid_argument);
  for (const double depth : {-0.1, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(interior_spheres(points, kept, 0.02, {.depth = depth}), std::invalid_argument);
  EXPECT_THROW(interior_spheres(points, kept, 0.0), std::invalid_argument);
  EXPECT_EQ(interior_spheres(ObstacleMatrix(0, 3), Points(0, 3), 0.02).rows(), 0);
}

}  // namespace
}  // namespace pdoik
