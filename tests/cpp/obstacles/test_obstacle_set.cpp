#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "brute_force.hpp"
#include "hulls/spheroid_distance.hpp"
#include "obstacles/clearance.hpp"
#include "obstacles/obstacle_set.hpp"
#include "obstacles/scene.hpp"
#include "workbench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Points on some patches of surface, as a camera sees them, and some anywhere.
ObstacleMatrix patches(Random& random, int count, double extent, double radius) {
  ObstacleMatrix points(count, radius > 0.0 ? 4 : 3);
  Eigen::Vector3d corner = Eigen::Vector3d::Zero(), u = corner, v = corner;
  for (int i = 0; i < count; ++i) {
    if (i % 700 == 0) {
      corner = random.point(extent);
      u = 0.5 * random.direction();
      v = 0.5 * random.direction();
    }
    Eigen::Vector3d p = corner + random.uniform(0.0, 1.0) * u + random.uniform(0.0, 1.0) * v;
    if (i % 50 == 0) p = random.point(3.0 * extent);
    points.row(i).head<3>() = p.transpose();
    if (radius > 0.0) points(i, 3) = random.uniform(0.0, radius);
  }
  return points;
}

Robot random_arm(Random& random) {
  Robot robot = random_robot(random, {.joints = 7});
  robot.set_occupancy(random_occupancy(robot, random, 4, 6));
  return robot;
}

using Pairs = std::vector<std::pair<int, int>>;

/// Hull and obstacle of those whose half sum of distances may be below the semi-major axis grown.
Pairs near_pairs(CollisionState& state, const ObstacleView& set, double grow) {
  Pairs found;
  state.find_near(set, [grow](std::size_t) { return grow; });
  for (int k = 0; k < state.near_count(); ++k) {
    EXPECT_GE(set->id(state.near(k).obstacle), 0) << "a padding point";
    found.emplace_back(state.near(k).hull, set->id(state.near(k).obstacle));
  }
  return found;
}

/// Of those that may be within a distance.
Pairs pairs_of(CollisionState& state, const ObstacleView& set, double grow) {
  Pairs found;
  state.visit_near(
      set, [grow](std::size_t) { return grow; },
      [&](const NearPair* begin, const NearPair* end) {
        for (const NearPair* p = begin; p != end; ++p) {
          EXPECT_GE(set->id(p->obstacle), 0) << "a padding point";
          found.emplace_back(p->hull, set->id(p->obstacle));
        }
        return true;
      });
  return found;
}

TEST(ObstacleSet, what_is_within_a_distance_is_visited_and_little_else) {
  std::size_t visited = 0, within = 0, by_half_sums = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Workbench bench(random_arm(random), {});
    const double radius = seed % 2 == 0 ? 0.05 : 0.0;
    bench.set_obstacles(patches(random, 3 * ObstacleSet::kLarge, 0.8, radius));
    const ObstacleView set = bench.scene.obstacles();
    ASSERT_TRUE(set->in_order());
    bench.roll_out(random_configuration(bench.robot, random));
    for (const double distance : {0.01, 0.1, 0.4}) {
      visited += pairs_of(bench.moving, set, distance).size();
      by_half_sums += near_pairs(bench.moving, set, distance).size();
      for (std::size_t h = 0; h < bench.hulls.moving.size(); ++h) {
        // Wherever it is expected: along the axis, aside, anywhere.
        const double supports[] = {0.0, 0.02, 0.1, 0.5};
        bench.moving.expect_at(h, supports[(h + static_cast<std::size_t>(seed)) % 4]);
      }
      const Pairs found = pairs_of(bench.moving, set, distance);
      const std::set<std::pair<int, int>> visits(found.begin(), found.end());
      EXPECT_EQ(visits.size(), found.size()) << "twice";
      bench.moving.expect_anywhere();
      for (std::size_t h = 0; h < bench.hulls.moving.size(); ++h) {
        const Hull& hull = bench.hulls.moving[h];
        const Eigen::Vector3d a = to_vector3(bench.moving.position(hull.a)),
                              b = to_vector3(bench.moving.position(hull.b));
        if (!hull.is_sphere() && (a - b).norm() >= 2.0 * hull.semi_major) continue;
        for (int j = 0; j < set->count(); ++j) {
          const Eigen::Vector3d o = to_vector3(set[j]);
          const double gap = hull.is_sphere()
                                 ? (o - a).norm() - hull.semi_major
                                 : spheroid_distance(o, a, b, hull.semi_major).distance;
          if (gap - set[j][3] > distance) continue;
          ++within;
          EXPECT_TRUE(visits.contains({static_cast<int>(h), set->id(j)})) << "hull " << h;
        }
      }
    }
  }
  EXPECT_GT(within, 30000U);
  EXPECT_LT(visited, 1.4 * static_cast<double>(within));
  EXPECT_LT(visited, by_half_sums);
}

TEST(ObstacleSet, the_spheroid_about_a_distance_holds_it_and_touches_where_it_is_expected) {
  Random random(3);
  for (int k = 0; k < 2000; ++k) {
    const double a = random.uniform(0.01, 0.6), b = a * random.uniform(0.02, 1.0),
                 g = random.uniform(1e-4, 2.0);
    const auto support = [](double major, double minor, double angle) {
      return std::hypot(major * std::cos(angle), minor * std::sin(angle));
    };
    const double expected_at = support(a, b, random.uniform(0.0, M_PI_2));
    const Offset about = offset_of(a, a * a - b * b, g, k % 3 == 0 ? 0.0 : expected_at);
    const double half = about.foci * std::sqrt(a * a - b * b),
                 minor = std::sqrt(about.semi_major * about.semi_major - half * half);
    for (double angle = 0.0; angle < M_PI_2; angle += 0.05) {
      const double S = support(a, b, angle);
      EXPECT_GE(support(about.semi_major, minor, angle), (S + g) * (1.0 - 1e-12));
    }
    if (k % 3 == 0) continue;
    const double angle = std::asin(std::sqrt(
        std::max(0.0, (a * a - expected_at * expected_at) / std::max(a * a - b * b, 1e-300))));
    if (std::isfinite(angle)) {
      EXPECT_NEAR(support(about.semi_major, minor, angle), expected_at + g, 1e-9);
    }
  }
}

TEST(ObstacleSet, a_large_cloud_in_order_gives_the_pairs_that_it_gives_in_no_order) {
  int found_in_all = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Workbench bench(random_arm(random), {});
    const int count = random.integer(ObstacleSet::kLarge + 1, 30 * ObstacleSet::kLarge);
    bench.set_obstacles(patches(random, count, 0.8, seed % 2 == 0 ? 0.05 : 0.0));
    ASSERT_TRUE(bench.scene.obstacles()->in_order());
    ASSERT_EQ(bench.scene.obstacles()->count(), count);
    ObstacleSet plain;
    plain.begin(bench.scene.obstacles()->count(), to_vector3(bench.scene.obstacles()->origin()));
    for (int j = 0; j < bench.scene.obstacles()->count(); ++j) {
      plain.add(bench.scene.obstacles()[j], bench.scene.obstacles()->id(j));
    }
    plain.finish();
    ASSERT_FALSE(plain.in_order());
    for (const bool baseline : {false, true}) {
      if (baseline) bench.moving.use_baseline();
      bench.roll_out(random_configuration(bench.robot, random));
      for (const double grow : {0.0, 0.05, 0.3}) {
        const Pairs boxed = near_pairs(bench.moving, bench.scene.obstacles(), grow);
        EXPECT_EQ(boxed, near_pairs(bench.moving, plain, grow)) << grow;
        found_in_all += static_cast<int>(boxed.size());
      }
    }
  }
  EXPECT_GT(found_in_all, 100000);
}

TEST(ObstacleSet, every_point_is_kept_once_and_neighbours_lie_close_together) {
  Random random(3);
  CellOrder order;
  for (const int count : {5000, 200000}) {
    const ObstacleMatrix points = patches(random, count, 1.0, 0.0);
    const auto point = [&](int i) { return Vec4{points(i, 0), points(i, 1), points(i, 2), 0.0}; };
    order.begin(count, point);
    for (int i = 0; i < count; ++i) order.add(point(i));
    std::vector<int> rows;
    for (const CellOrder::Entry& entry : order.sorted()) rows.push_back(entry.row);
    double apart = 0.0, apart_before = 0.0;
    for (std::size_t k = 1; k < rows.size(); ++k) {
      apart += (points.row(rows[k]) - points.row(rows[k - 1])).norm();
      apart_before +=
          (points.row(static_cast<Eigen::Index>(k)) - points.row(static_cast<Eigen::Index>(k) - 1))
              .norm();
    }
    EXPECT_LT(apart, 0.3 * apart_before);
    std::sort(rows.begin(), rows.end());
    for (int i = 0; i < count; ++i) ASSERT_EQ(rows[static_cast<std::size_t>(i)], i);
  }
}

TEST(ObstacleSet, a_hull_grown_without_bound_or_by_no_number_meets_every_point_and_no_padding) {
  Random random(5);
  for (const int count : {1, 37, 300, ObstacleSet::kLarge + 5}) {
    Workbench bench(random_arm(random), {});
    // Wide apart too: what the coarse test takes for far must be far.
    ObstacleMatrix points = patches(random, count, 1.0, 0.1);
    if (count > 30) points.row(7) << 9e5, -8e5, 1e6, 0.3;
    bench.set_obstacles(points);
    bench.roll_out(random_configuration(bench.robot, random));
    for (const double grow : {kInfinity, std::nan(""), 1e300, 1e30, 1e12, 1e8}) {
      const auto found = pairs_of(bench.moving, bench.scene.obstacles(), grow);
      EXPECT_EQ(found.size(), bench.moving.hulls().size() * static_cast<std::size_t>(count))
          << grow;
    }
  }
}

TEST(ObstacleSet, clearance_among_many_points_near_and_far_is_that_of_brute_force) {
  int far_ones = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Workbench bench(random_arm(random), {});
    ObstacleMatrix points = patches(random, 6000, 0.6, seed % 2 == 0 ? 0.05 : 0.0);
    if (seed % 3 == 0)  // all of them out of reach
      points.leftCols(3).rowwise() += Eigen::RowVector3d(40.0, -20.0, 10.0);
    bench.set_obstacles(points);
    far_ones += bench.scene.obstacles()->count() - bench.scene.within_reach();
    for (int k = 0; k < 3; ++k) {
      const Eigen::VectorXd q = random_configuration(bench.robot, random);
      bench.roll_out(q);
      EXPECT_NEAR(bench.clearance().distance, brute_force_clearance(bench.robot, q, points, 100),
                  1e-7);
    }
  }
  EXPECT_GT(far_ones, 1000);
}

TEST(ObstacleSet, hulls_that_shrink_keep_what_reaches_deeper_and_little_else) {
  std::size_t deep_ones = 0, kept = 0, touching = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Workbench bench(random_arm(random), {});
    const double largest = seed % 2 == 0 ? 0.05 : 0.0;
    bench.set_obstacles(patches(random, seed % 3 == 0 ? 6000 : 500, 0.4, largest));
    bench.roll_out(random_configuration(bench.robot, random));
    const ObstacleSet& points = *bench.scene.obstacles();
    touching += pairs_of(bench.moving, points, 0.0).size();
    for (const double depth : {0.001, 0.02, 0.05, 0.4}) {
      const auto found = pairs_of(bench.moving, points, -depth);
      const std::set<std::pair<int, int>> deeper(found.begin(), found.end());
      kept += found.size();
      for (std::size_t h = 0; h < bench.moving.hulls().size(); ++h) {
        const Hull& hull = bench.moving.hulls()[h];
        const Eigen::Vector3d a = to_vector3(bench.moving.position(hull.a)),
                              b = to_vector3(bench.moving.position(hull.b));
        if ((b - a).norm() >= 2.0 * hull.semi_major) continue;  // no hull at all
        for (int j = 0; j < points.count(); ++j) {
          const Vec4& o = points[j];
          const double distance =
              spheroid_distance(to_vector3(o), a, b, hull.semi_major).distance - o[3];
          if (distance > -depth) continue;
          ++deep_ones;
          EXPECT_TRUE(deeper.contains({static_cast<int>(h), points.id(j)}))
              << distance << " of " << depth;
        }
      }
    }
  }
  EXPECT_GT(deep_ones, 1000U);
  EXPECT_LT(kept, 2 * deep_ones + touching / 4);
}

TEST(ObstacleSet, a_few_of_a_large_cloud_are_spread_over_all_of_it) {
  Random random(4);
  Workbench bench(random_arm(random), {});
  bench.set_obstacles(patches(random, 300, 0.6, 0.0));
  EXPECT_EQ(bench.scene.obstacles()->few(), nullptr);
  bench.set_obstacles(patches(random, 100000, 0.6, 0.02));
  const ObstacleSet& all = *bench.scene.obstacles();
  const ObstacleSet* few = all.few();
  ASSERT_NE(few, nullptr);
  EXPECT_EQ(few->count(), (all.count() + 15) / 16);
  std::set<int> all_indices, indices;
  for (int j = 0; j < all.count(); ++j) all_indices.insert(all.id(j));
  for (int j = 0; j < few->count(); ++j) indices.insert(few->id(j));
  EXPECT_EQ(static_cast<int>(indices.size()), few->count());
  EXPECT_TRUE(
      std::includes(all_indices.begin(), all_indices.end(), indices.begin(), indices.end()));
  double apart = 0.0;
  for (int j = 0; j < all.count(); ++j) {
    double nearest = kInfinity;
    for (int k = 0; k < few->count(); ++k)
      nearest = std::min(nearest, (to_vector3((*few)[k]) - to_vector3(all[j])).norm());
    apart += nearest;
  }
  EXPECT_LT(apart / all.count(), 0.05);
}

TEST(ObstacleSet, pairs_beyond_the_room_there_is_are_left_out_and_visited_all_the_same) {
  Random random(8);
  Robot robot = Robot::builtin("panda");
  Workbench bench(robot, {});
  // All in one place inside a hull: more pairs than are kept.
  const Eigen::Vector3d at = robot.fk(robot.mid_configuration(), "panda_link4").translation();
  ObstacleMatrix points(100000, 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    points.row(i) = (at + random.point(0.02)).transpose();
  bench.set_obstacles(points);
  bench.roll_out(robot.mid_configuration());
  bench.moving.find_near(bench.scene.obstacles(), [](std::size_t) { return 0.0; });
  EXPECT_LE(bench.moving.near_count(), static_cast<int>(CollisionState::kMostPairs));
  EXPECT_GT(bench.moving.near_count(), static_cast<int>(CollisionState::kMostPairs) - kLanes);
  const auto all = pairs_of(bench.moving, bench.scene.obstacles(), 0.0);
  const std::set<std::pair<int, int>> once(all.begin(), all.end());
  EXPECT_EQ(once.size(), all.size());
  std::set<int> obstacles;
  for (const auto& pair : all) obstacles.insert(pair.second);
  EXPECT_EQ(obstacles.size(), 100000U);
}

}  // namespace
}  // namespace pdoik::detail
