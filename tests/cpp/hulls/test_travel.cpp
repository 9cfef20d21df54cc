#include <gtest/gtest.h>

#include "hulls/travel.hpp"
#include "obstacles/placed_travel.hpp"
#include "problem/model.hpp"
#include "workbench.hpp"

/// How far hulls get: bounds that a gate relies on.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

/// Points of what a hull fills, where bodies are: its capsules' ends, or its foci.
std::vector<Eigen::Vector3d> points_of(const HullModel& model, const Hull& hull,
                                       const std::vector<Eigen::Isometry3d>& T_base_body) {
  std::vector<Eigen::Vector3d> points;
  const auto& T = T_base_body[static_cast<std::size_t>(hull.body)];
  for (int k = 0; k < 4 * hull.blocks; ++k) {
    const CapsuleBlock& block = model.capsules(hull)[k / 4];
    const int i = k % 4;
    if (block.source[i] < 0) continue;
    const Eigen::Vector3d a(block.ax[i], block.ay[i], block.az[i]),
        v(block.vx[i], block.vy[i], block.vz[i]);
    points.push_back(T * a);
    points.push_back(T * (a + v));
  }
  for (const int at : {hull.a, hull.b}) {
    if (hull.has_capsules()) break;
    const AttachedPoint& point = model.points[static_cast<std::size_t>(at)];
    points.push_back(T_base_body[static_cast<std::size_t>(point.body)] * to_vector3(point.local));
  }
  return points;
}

TEST(Travel, no_part_of_a_hull_gets_farther_than_either_bound_says) {
  double closest = 0.0;
  for (int seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Robot robot = random_robot(random, seed % 3 == 0 ? kSerial : kMixedTree);
    robot.set_occupancy(
        with_capsules(robot, random_occupancy(robot, random, 3, 3), random, seed % 2 == 0 ? 9 : 0));
    Workbench bench(robot, {});
    const HullModel& model = bench.hulls;
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::VectorXd q = random_configuration(robot, random);
      const Eigen::VectorXd step =
          std::pow(10.0, random.uniform(-3.0, 0.3)) * random.vector(robot.dof(), 0.0, 1.0);
      const Eigen::VectorXd way = step.cwiseProduct(random.vector(robot.dof(), -1.0, 1.0));
      const Eigen::VectorXd to = (q + way).cwiseMax(robot.lower()).cwiseMin(robot.upper());
      bench.roll_out(q);
      std::vector<Eigen::Isometry3d> before(robot.bodies().size()), after(robot.bodies().size());
      robot.body_poses(q, before);
      robot.body_poses(to, after);
      Eigen::VectorXd displacement_bounds;
      hull_displacement_bounds(robot, model, q, to, displacement_bounds);
      const double by_bounds = displacement_bounds.dot((to - q).cwiseAbs());
      for (std::size_t h = 0; h < model.moving.size(); ++h) {
        const Hull& hull = model.moving[h];
        const double bound = travel_from(bench.problem.rollout, bench.moving, hull, step);
        const auto from = points_of(model, hull, before), there = points_of(model, hull, after);
        for (std::size_t k = 0; k < from.size(); ++k) {
          const double got = (there[k] - from[k]).norm();
          ASSERT_LE(got, bound + 1e-12) << "hull " << h;
          ASSERT_LE(got, by_bounds + 1e-12) << "hull " << h;
          if (bound > 0.0) closest = std::max(closest, got / bound);
        }
      }
    }
  }
  EXPECT_GT(closest, 0.5) << "the bound says nothing";
}

}  // namespace
}  // namespace pdoik::detail
