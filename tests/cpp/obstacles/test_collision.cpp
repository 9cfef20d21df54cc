#include <gtest/gtest.h>

#include <set>

#include "brute_force.hpp"
#include "obstacles/clearance.hpp"
#include "workbench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

/// A random robot with hulls among points, on a bench. Even seeds: trees; every third: points with
/// radii.
std::unique_ptr<Workbench> random_bench(int seed, Random& random, int points, double extent) {
  const RobotKind kind = seed % 2 == 0
                             ? kMixedTree
                             : RobotKind{.joints = 7, .fixed = 0.1, .prismatic = 0.2, .mimic = 0.1};
  Robot robot = random_robot(random, kind);
  robot.set_occupancy(random_occupancy(robot, random, 4, 6));
  Options options;
  options.clearance = seed % 5 == 0 ? 0.03 : 0.0;
  auto bench = std::make_unique<Workbench>(robot, options);
  bench->set_obstacles(random_obstacles(random, points, extent, seed % 3 == 0 ? 0.2 : 0.0));
  return bench;
}

template <class Check>
void for_seeds(int count, Check&& check) {
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    check(seed, random);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(Collision, the_near_pairs_include_every_hull_that_an_obstacle_touches) {
  int touching = 0;
  for_seeds(40, [&](int seed, Random& random) {
    const auto bench = random_bench(seed, random, random.integer(1, 200), 1.0);
    const std::vector<bool> moves = hulls_that_move(bench->robot);
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd q = random_configuration(bench->robot, random);
      const double grow = k == 0 ? 0.0 : random.uniform(0.0, 0.1);
      bench->roll_out(q);
      bench->moving.find_near(bench->scene.obstacles(), [&](std::size_t) { return grow; });
      std::set<std::pair<int, int>> found;
      for (int n = 0; n < bench->moving.near_count(); ++n) {
        const NearPair& pair = bench->moving.near(n);
        const auto where =
            std::pair(bench->moving.hull(pair).source, bench->scene.obstacles()->id(pair.obstacle));
        ASSERT_GE(where.second, 0) << "a padding point is said to touch hull " << where.first;
        ASSERT_TRUE(found.insert(where).second) << "a pair is listed twice";
      }
      const Eigen::MatrixXd c =
          paper_constraints(bench->robot, q, bench->obstacles, bench->options.clearance);
      for (int i = 0; i < c.rows(); ++i) {
        if (!moves[static_cast<std::size_t>(i)]) continue;
        const bool sphere = i < static_cast<int>(bench->robot.occupancy().spheres.size());
        for (int j = 0; j < c.cols(); ++j) {
          const double inside = (sphere ? 1.0 : 0.5) * c(i, j) + grow;
          if (inside <= 0.0) continue;
          ++touching;
          EXPECT_TRUE(found.contains({i, j}))
              << "hull " << i << ", obstacle " << j << ", inside by " << inside;
        }
      }
    }
  });
  EXPECT_GT(touching, 500);
}

/// Points just inside a thin spheroid's surface, at its poles, equator and between.
TEST(Collision, the_near_pairs_miss_no_point_just_inside_a_thin_spheroid) {
  for (const double ratio : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 1e-3, 1e-4}) {  // b / a
    for (const double a : {0.1, 0.3, 0.5}) {
      SCOPED_TRACE("b / a = " + std::to_string(ratio) + ", a = " + std::to_string(a));
      Random random(static_cast<std::uint64_t>(1000.0 * ratio * a));
      Robot robot = random_robot(random, kSerial);
      const Eigen::Vector3d half = std::sqrt(1.0 - ratio * ratio) * a * random.direction(),
                            centre = random.point(0.2);
      Occupancy occupancy;
      const std::string link = robot.link_names()[4];
      occupancy.spheroids.push_back({link, centre - half, link, centre + half, a});
      robot.set_occupancy(occupancy);
      Workbench bench(robot, {});
      const Eigen::VectorXd q = random_configuration(robot, random);
      const Eigen::Isometry3d T = robot.fk(q, link);
      ObstacleMatrix points(300, 3);
      for (Eigen::Index k = 0; k < points.rows(); ++k) {
        const double t = k < 20 ? 0.0 : random.uniform(-M_PI, M_PI);
        const Eigen::Vector3d side = half.cross(random.direction()).normalized();
        const double inwards = 1.0 - random.uniform(1e-7, 1e-6);
        const Eigen::Vector3d surface =
            a * std::cos(t) * half.normalized() + ratio * a * std::sin(t) * side;
        points.row(k) = (T * (centre + inwards * surface)).transpose();
      }
      bench.set_obstacles(points);
      bench.roll_out(q);
      bench.moving.find_near(bench.scene.obstacles(), [](std::size_t) { return 0.0; });
      const Eigen::ArrayXXd c = paper_constraints(robot, q, points).array();
      ASSERT_GE(bench.moving.near_count(), (c > 1e-12).count());  // rounding in double apart
      ASSERT_GT((c > 1e-12).count(), 15);
    }
  }
}

/// Two balls' centres joined by a spheroid too short for them: empty, whatever the obstacles.
TEST(Collision,
     a_spheroid_whose_foci_are_too_far_apart_touches_nothing_and_no_padding_or_forgotten_point) {
  Robot robot = Robot::builtin("ur10");
  Occupancy occupancy;
  occupancy.spheroids.push_back(
      {"base_link", Eigen::Vector3d::Zero(), "wrist_3_link", Eigen::Vector3d::Zero(), 0.1});
  robot.set_occupancy(occupancy);
  Random random(1);
  for (int k = 0; k < 50; ++k) {
    SCOPED_TRACE(k);
    Workbench bench(robot, {});
    const Eigen::VectorXd q = random_configuration(robot, random);
    const double apart = robot.fk(q).translation().norm();
    if (apart < 0.3) continue;
    ObstacleMatrix many = random_obstacles(random, 30, 1.0, 2.0), one(1, 3);
    one << 0.9, -0.8, 0.7;
    if (k % 2 == 0) bench.set_obstacles(many);  // radii that reach everything, then forgotten
    bench.set_obstacles(one);
    bench.roll_out(q);
    const Clearance found = bench.clearance();
    ASSERT_EQ(found.obstacle, 0);
    ASSERT_NEAR(found.distance, brute_force_clearance(robot, q, one), 1e-9);
    ASSERT_EQ(bench.lagrangian.max_constraint(random.vector(bench.map.size(), -1.0, 1.0)), 0.0);
  }
}

TEST(Collision, the_near_pairs_hold_none_farther_than_the_coarse_tests_slack) {
  for_seeds(20, [](int seed, Random& random) {
    const auto bench = random_bench(seed, random, 200, 1.0);
    bench->roll_out(random_configuration(bench->robot, random));
    bench->moving.find_near(bench->scene.obstacles(), [](std::size_t) { return 0.0; });
    for (int n = 0; n < bench->moving.near_count(); ++n) {
      const Hull& hull = bench->moving.hull(bench->moving.near(n));
      const Vec4 o = bench->scene.obstacles()[bench->moving.near(n).obstacle];
      const Eigen::Vector3d a = to_vector3(bench->moving.position(hull.a)),
                            b = to_vector3(bench->moving.position(hull.b));
      if ((b - a).norm() >= 2.0 * (hull.semi_major + o[3]))
        continue;  // foci too far apart: no hull, but a cheap test
      const double half_sum = 0.5 * ((to_vector3(o) - a).norm() + (to_vector3(o) - b).norm());
      EXPECT_LT(half_sum, hull.semi_major + o[3] + 2e-4);
    }
  });
}

TEST(Collision, clearance_is_the_brute_force_least_distance_over_all_pairs) {
  int inside = 0, outside = 0, far_away = 0;
  for_seeds(60, [&](int seed, Random& random) {
    const double extent = seed % 4 == 0 ? 30.0 : seed % 4 == 1 ? 4.0 : 1.0;
    const auto bench = random_bench(seed, random, random.integer(1, 60), extent);
    for (int k = 0; k < 3; ++k) {
      const Eigen::VectorXd q = random_configuration(bench->robot, random);
      bench->roll_out(q);
      const Clearance found = bench->clearance();
      const double expected =
          brute_force_clearance(bench->robot, q, bench->obstacles) - bench->options.clearance;
      ASSERT_NEAR(found.distance, expected, 1e-9 * std::max(1.0, extent))
          << "obstacle " << found.obstacle;
      ASSERT_GE(found.obstacle, 0);
      // The pair it names is as near as it says.
      ObstacleMatrix one = bench->obstacles.row(found.obstacle);
      Robot with_one = bench->robot;
      const Occupancy& all = bench->robot.occupancy();
      const auto source = static_cast<std::size_t>(found.source);
      Occupancy alone;
      if (source < all.spheres.size())
        alone.spheres = {all.spheres[source]};
      else
        alone.spheroids = {all.spheroids[source - all.spheres.size()]};
      with_one.set_occupancy(alone);
      ASSERT_NEAR(brute_force_clearance(with_one, q, one) - bench->options.clearance, expected,
                  1e-9 * std::max(1.0, extent));
      if (expected < 0.0) ++inside;
      if (expected > 0.0) ++outside;
      if (bench->scene.within_reach() < bench->scene.obstacles()->count()) ++far_away;
    }
  });
  EXPECT_GT(inside, 20);
  EXPECT_GT(outside, 20);
  EXPECT_GT(far_away, 20);
}

TEST(Collision, no_obstacle_out_of_reach_touches_a_moving_hull) {
  int dropped = 0;
  for_seeds(30, [&](int seed, Random& random) {
    const auto bench = random_bench(2 * seed + 1, random, 40, 4.0);
    const ObstacleView all = bench->scene.obstacles();
    ASSERT_EQ(all->count(), 40);
    ObstacleMatrix far_ones(40 - bench->scene.within_reach(), 4);
    Eigen::Index far_count = 0;
    for (int j = 0; j < all->places(); ++j) {
      const Vec4 o = all[j];
      const double away = (to_vector3(o) - bench->hulls.reach_centre).norm();
      if (away <= bench->hulls.reach + 2.0 * o[3]) continue;
      ASSERT_LT(far_count, far_ones.rows());
      for (int i = 0; i < 4; ++i) far_ones(far_count, i) = o[i];
      ++far_count;
    }
    ASSERT_EQ(far_count, far_ones.rows());
    dropped += static_cast<int>(far_count);
    if (far_count == 0) return;
    const std::vector<bool> moves = hulls_that_move(bench->robot);
    for (int k = 0; k < 20; ++k) {
      Eigen::VectorXd q = random_configuration(bench->robot, random);
      for (Eigen::Index i = 0; i < q.size(); ++i) {  // corners of the ranges reach farthest
        if (k % 2 == 0 && std::isfinite(bench->robot.lower()[i])) {
          q[i] = random.chance(0.5) ? bench->robot.lower()[i] : bench->robot.upper()[i];
        }
      }
      const Eigen::MatrixXd c = paper_constraints(bench->robot, q, far_ones);
      for (Eigen::Index i = 0; i < c.rows(); ++i) {
        if (!moves[static_cast<std::size_t>(i)]) continue;
        const bool sphere = i < static_cast<Eigen::Index>(bench->robot.occupancy().spheres.size());
        EXPECT_LT(c.row(i).maxCoeff() * (sphere ? 1.0 : 0.5), 0.0);
      }
    }
  });
  EXPECT_GT(dropped, 100);
}

TEST(Collision, a_stretched_arms_farthest_point_is_in_reach_and_what_lies_well_beyond_is_not) {
  // Links of 0.3 m in a row along x after a base of 0.5 m along z.
  std::vector<DhRow> rows(4, DhRow{.a = 0.3, .lower = -2.0, .upper = 2.0});
  rows[0].a = 0.0, rows[0].d = 0.5;
  Robot robot = Robot::from_dh(rows, Eigen::Isometry3d(Eigen::Translation3d(0.3, 0.0, 0.0)));
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  for (const bool sphere : {true, false}) {
    Occupancy occupancy;
    if (sphere)
      occupancy.spheres.push_back({"tool", Eigen::Vector3d::Zero(), 0.1});
    else
      occupancy.spheroids.push_back({"tool", -0.2 * x, "tool", 0.05 * x, 0.25});
    robot.set_occupancy(occupancy);
    Workbench bench(robot, {});
    const double farthest = 1.2 + (sphere ? 0.1 : -0.075 + 0.25);
    for (const double radius : {0.0, 0.2}) {
      ObstacleMatrix points(2, 4);
      points << farthest + radius - 1e-6, 0.0, 0.5, radius, 2.0 * farthest + radius, 0.0, 0.5,
          radius;
      bench.set_obstacles(points);
      ASSERT_EQ(bench.scene.within_reach(), 1) << sphere << " " << radius;
      bench.roll_out(Eigen::VectorXd::Zero(4));
      EXPECT_NEAR(bench.clearance().distance, -1e-6, 1e-9);
    }
  }
}

TEST(Collision, hulls_that_no_joint_moves_are_kept_apart_from_those_that_some_joint_moves) {
  int fixed_ones = 0;
  for_seeds(40, [&](int seed, Random& random) {
    const auto bench = random_bench(seed, random, 1, 1.0);
    const std::vector<bool> moves = hulls_that_move(bench->robot);
    std::vector<bool> said(moves.size(), false);
    for (const Hull& hull : bench->hulls.moving) said[static_cast<std::size_t>(hull.source)] = true;
    EXPECT_EQ(said, moves);
    EXPECT_EQ(bench->hulls.moving.size() + bench->hulls.fixed.size(), moves.size());
    fixed_ones += static_cast<int>(bench->hulls.fixed.size());
  });
  EXPECT_GT(fixed_ones, 10);
}

TEST(Collision, a_hull_centred_on_the_first_joints_axis_does_not_move_but_one_beside_it_does) {
  Robot robot = Robot::builtin("panda");
  Occupancy occupancy;
  occupancy.spheres.push_back({"panda_link1", {0.0, 0.0, -0.1}, 0.1});
  occupancy.spheres.push_back({"panda_link1", {0.01, 0.0, -0.1}, 0.1});
  occupancy.spheroids.push_back(
      {"panda_link0", {0.0, 0.0, 0.1}, "panda_link1", {0.0, 0.0, 0.0}, 0.3});
  robot.set_occupancy(occupancy);
  const HullModel model(robot);
  ASSERT_EQ(model.fixed.size(), 2U);
  ASSERT_EQ(model.moving.size(), 1U);
  EXPECT_EQ(model.moving.front().source, 1);
}

TEST(Collision, foci_at_one_point_make_a_sphere_and_points_are_attached_once) {
  Robot robot = Robot::builtin("ur10");
  Occupancy occupancy;
  const Eigen::Vector3d p(0.1, 0.2, 0.3);
  occupancy.spheres.push_back({"forearm_link", p, 0.1});
  occupancy.spheroids.push_back({"forearm_link", p, "forearm_link", p, 0.2});
  occupancy.spheroids.push_back({"forearm_link", p, "forearm_link", -p, 0.6});
  robot.set_occupancy(occupancy);
  const HullModel model(robot);
  EXPECT_EQ(model.points.size(), 2U);
  EXPECT_TRUE(model.moving[1].is_sphere());
  EXPECT_FALSE(model.moving[2].is_sphere());
}

TEST(Collision, obstacles_are_padded_to_whole_lanes_with_points_that_touch_nothing) {
  for (int count = 0; count <= 40; ++count) {
    ObstacleSet set;
    set.begin(count, Eigen::Vector3d(0.5, 0.0, 0.0));
    for (int k = 0; k < count; ++k) set.add(Vec4{0.1 * k, 0.0, 0.0, 0.01}, 7 * k);
    set.finish();
    EXPECT_EQ(set.count(), count);
    EXPECT_EQ(set.padded() % kLanes, 0);
    EXPECT_LT(set.padded() - count, kLanes);
    for (int k = 0; k < count; ++k) {
      EXPECT_EQ(set.id(k), 7 * k);
      EXPECT_NEAR(set.arrays().x[k], 0.1 * k - 0.5, 1e-6);
    }
    for (int k = count; k < set.padded(); ++k) EXPECT_GT(set.arrays().x[k], 1e9F);
  }
}

}  // namespace
}  // namespace pdoik::detail
