#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <set>
#include <thread>

#include "brute_force.hpp"
#include "obstacles/cloud_state.hpp"
#include "obstacles/rows.hpp"
#include "obstacles/scene.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/tracker.hpp"
#include "solver_settings.hpp"
#include "workbench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;
using Rows4 = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
using Box = Eigen::AlignedBox3d;

/// On some patches of surface around a robot, with a radius each.
Rows4 surfaces(Random& random, int count, double radius) {
  Rows4 points(count, 4);
  Eigen::Vector3d corner = Eigen::Vector3d::Zero(), u = corner, v = corner;
  for (int i = 0; i < count; ++i) {
    if (i % 1500 == 0) {
      corner = random.point(1.0);
      u = 0.5 * random.direction();
      v = 0.5 * random.direction();
    }
    points.row(i).head<3>() =
        (corner + random.uniform(0.0, 1.0) * u + random.uniform(0.0, 1.0) * v).transpose();
    points(i, 3) = random.uniform(0.0, radius);
  }
  return points;
}

std::vector<std::array<double, 4>> sorted_rows(const Rows4& points) {
  std::vector<std::array<double, 4>> rows;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    rows.push_back({points(i, 0), points(i, 1), points(i, 2), points(i, 3)});
  std::sort(rows.begin(), rows.end());
  return rows;
}

Rows4 rows_where(const Rows4& points, const std::function<bool(Eigen::Index)>& wanted) {
  Rows4 chosen(points.rows(), 4);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    if (wanted(i)) chosen.row(count++) = points.row(i);
  return chosen.topRows(count);
}

Box random_box(Random& random, double size) {
  const Eigen::Vector3d low = random.point(1.0);
  return {low, low + size * Eigen::Vector3d::Ones()};
}

double clearance_among(const Robot& robot, const Eigen::VectorXd& q, const Cloud& cloud) {
  Solver solver(robot);
  solver.set_obstacles(cloud);
  Result result;
  solver.judge(robot.fk(q), q, result);
  return result.clearance;
}

TEST(Cloud, answers_are_those_of_a_solver_that_takes_the_points_in_itself) {
  const Robot robot = Robot::builtin("panda");
  Random random(1);
  for (const int count : {0, 60, 3000, 40000}) {
    const Rows4 points = surfaces(random, count, 0.01);
    const Cloud cloud(points);
    EXPECT_EQ(cloud.size(), static_cast<std::size_t>(count));
    Options options = timeless();
    options.max_restarts = 5;
    options.base_collision = false;
    Solver own(robot, options), shared(robot, options);
    own.set_obstacles(points);
    shared.set_obstacles(cloud);
    for (int k = 0; k < 10; ++k) {
      const Eigen::Isometry3d target = robot.fk(random_configuration(robot, random));
      expect_same(own.solve(target), shared.solve(target));
    }
  }
}

TEST(Cloud, float32_points_are_taken_as_they_are_from_rows_with_gaps) {
  Random random(2);
  Eigen::Matrix<float, Eigen::Dynamic, 8, Eigen::RowMajor> wide(5000, 8);
  wide.leftCols<4>() = surfaces(random, 5000, 0.01).cast<float>();
  const Cloud cloud(ObstaclesF(wide.leftCols<4>()));
  EXPECT_EQ(sorted_rows(cloud.points()), sorted_rows(wide.leftCols<4>().cast<double>()));
}

TEST(Cloud, updates_and_removals_leave_the_points_and_distances_of_a_cloud_made_anew) {
  const Robot robot = without_pieces(Robot::builtin("iiwa14"));
  for (const int count : {0, 500, 5000, 30000}) {
    SCOPED_TRACE(count);
    Random random(static_cast<std::uint64_t>(count) + 3);
    Rows4 points = surfaces(random, count, 0.02);
    Cloud cloud(points);
    int next_id = count;
    for (int k = 0; k < 24; ++k) {
      const Box box = random_box(random, k % 4 == 0 ? 2.0 : 0.4);
      const auto is_outside = [&](Eigen::Index i) {
        return !box.contains(Eigen::Vector3d(points.row(i).head<3>()));
      };
      const Rows4 kept = rows_where(points, is_outside);
      Rows4 more(0, 4);
      if (k % 3 != 0) {
        more.resize(random.integer(0, k % 5 == 0 ? 4000 : 300), 4);
        for (Eigen::Index i = 0; i < more.rows(); ++i) {
          more.row(i).head<3>() =
              (box.min() +
               0.5 * (random.point(1.0) + Eigen::Vector3d::Ones()).cwiseProduct(box.sizes()).eval())
                  .cwiseMax(box.min())
                  .cwiseMin(box.max())
                  .transpose();
          more(i, 3) = random.uniform(0.0, 0.02);
        }
        EXPECT_EQ(cloud.update(Obstacles(more), box), points.rows() - kept.rows());
      } else {
        EXPECT_EQ(cloud.remove(box), points.rows() - kept.rows());
      }
      next_id += static_cast<int>(more.rows());
      points.resize(kept.rows() + more.rows(), 4);
      points << kept, more;
      ASSERT_EQ(cloud.size(), static_cast<std::size_t>(points.rows()));
      ASSERT_EQ(sorted_rows(cloud.points()), sorted_rows(points));
      const std::vector<int> ids = cloud.ids();
      EXPECT_EQ(std::set<int>(ids.begin(), ids.end()).size(), ids.size());
      EXPECT_TRUE(std::all_of(ids.begin(), ids.end(), [&](int id) { return id < next_id; }));
      if (points.rows() == 0) continue;
      const Eigen::VectorXd q = random_configuration(robot, random);
      EXPECT_NEAR(clearance_among(robot, q, cloud), clearance_among(robot, q, Cloud(points)),
                  1e-12);
      if (k % 20 == 7) {
        EXPECT_NEAR(clearance_among(robot, q, cloud),
                    brute_force_clearance(robot, q, ObstacleMatrix(points), 100), 1e-6);
      }
    }
  }
}

TEST(Cloud, a_solver_sees_updates_of_the_cloud_that_it_was_given_and_names_points_by_their_ids) {
  const Robot robot = Robot::builtin("panda");
  const Eigen::VectorXd q = robot.mid_configuration();
  Eigen::Matrix<double, 2, 3, Eigen::RowMajor> far;
  far << 3.0, 3.0, 3.0, -3.0, 3.0, 3.0;
  Cloud cloud{Obstacles(far)};
  Solver solver(robot);
  solver.set_obstacles(cloud);
  Tracker tracker(robot, {}, {.max_time = 10.0});
  tracker.set_obstacles(cloud);
  tracker.reset(q);
  Result result;
  solver.judge(robot.fk(q), q, result);
  EXPECT_TRUE(result.success);
  EXPECT_EQ(tracker.step(robot.fk(q)).tracking, TrackerStatus::Tracking);
  const Eigen::RowVector3d inside = robot.fk(q, "panda_link4").translation().transpose();
  EXPECT_EQ(cloud.update(Obstacles(inside), Box(inside.transpose(), inside.transpose())), 0);
  solver.judge(robot.fk(q), q, result);
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.worst.kind, WorstConstraint::Kind::Clearance);
  EXPECT_EQ(result.worst.obstacle, 2);
  EXPECT_NE(tracker.step(robot.fk(q)).tracking, TrackerStatus::Tracking);
  EXPECT_EQ(cloud.remove(Box(inside.transpose(), inside.transpose())), 1);
  solver.judge(robot.fk(q), q, result);
  EXPECT_TRUE(result.success);
}

TEST(Cloud, the_robots_own_surface_goes_and_nothing_else) {
  const Robot robot = without_pieces(Robot::builtin("ur10"));
  Random random(5);
  for (const double padding : {0.0, 0.03}) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    Rows4 points = surfaces(random, 20000, 0.0);
    for (Eigen::Index i = 0; i < 10000; ++i)
      points.row(i).head<3>() = random.point(0.8).transpose();
    Cloud cloud(points);
    const int removed = cloud.remove_robot(robot, q, padding);
    EXPECT_GT(removed, 50);
    EXPECT_EQ(cloud.size() + static_cast<std::size_t>(removed), 20000U);
    std::vector<bool> left(20000, false);
    for (const int id : cloud.ids()) left[static_cast<std::size_t>(id)] = true;
    for (Eigen::Index i = 0; i < points.rows(); i += 41) {
      const double distance = brute_force_clearance(robot, q, ObstacleMatrix(points.row(i)), 200);
      if (std::abs(distance - padding) < 1e-6) continue;
      EXPECT_EQ(left[static_cast<std::size_t>(i)], distance > padding) << distance;
    }
  }
}

TEST(Cloud, what_makes_no_sense_is_refused_by_name_and_changes_nothing) {
  Random random(6);
  Cloud cloud(surfaces(random, 2000, 0.0));
  const Rows4 before = cloud.points();
  const auto refuses = [&](const std::string& words, const std::function<void()>& what) {
    try {
      what();
      ADD_FAILURE() << "took it: " << words;
    } catch (const std::invalid_argument& refused) {
      EXPECT_NE(std::string(refused.what()).find(words), std::string::npos) << refused.what();
    }
    EXPECT_EQ(sorted_rows(cloud.points()), sorted_rows(before));
  };
  const double nan = std::nan("");
  const Box unit(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones());
  ObstacleMatrix bad(1, 4);
  bad << 0.5, nan, 0.5, 0.0;
  refuses("NaN or infinity in row 0", [&] { Cloud{Obstacles(bad)}; });
  refuses("NaN or infinity in row 0", [&] { cloud.update(Obstacles(bad), unit); });
  bad << 0.5, 0.5, 0.5, -0.1;
  refuses("negative radius in row 0", [&] { cloud.update(Obstacles(bad), unit); });
  bad << 0.5, 1.5, 0.5, 0.0;
  refuses("row 0 outside of the region", [&] { cloud.update(Obstacles(bad), unit); });
  refuses("shape (1, 2)", [&] { Cloud{Obstacles(ObstacleMatrix(bad.leftCols(2)))}; });
  const ObstacleMatrix none(0, 3);
  refuses("along y", [&] {
    cloud.update(Obstacles(none), Box(Eigen::Vector3d::Zero(), Eigen::Vector3d(1.0, -1.0, 1.0)));
  });
  refuses("along z",
          [&] { cloud.remove(Box(Eigen::Vector3d(0.0, 0.0, nan), Eigen::Vector3d::Ones())); });
  refuses("along x", [&] { cloud.remove(Box()); });
  const Robot robot = Robot::builtin("panda");
  refuses("padding", [&] { cloud.remove_robot(robot, robot.mid_configuration(), -1.0); });
  refuses("q has 3 entries", [&] { cloud.remove_robot(robot, Eigen::VectorXd::Zero(3)); });
}

TEST(Cloud, takes_no_more_than_64_bytes_a_point_when_large) {
  Random random(9);
  for (const int count : {20000, 300000}) {
    const Cloud cloud(surfaces(random, count, 0.0));
    EXPECT_LT(static_cast<double>(cloud.bytes()) / count, 64.0) << count;
  }
}

TEST(Cloud, what_is_being_read_stays_as_it_is_whatever_updates_come_and_none_waits_for_another) {
  // All in one thread: whoever waited would wait for ever.
  Random random(11);
  detail::CloudState state;
  const auto filled_with = [&](int count) {
    return [=, points = surfaces(random, count, 0.01)](detail::ObstacleSet& set) {
      detail::CellOrder order;
      set.assign(count, order, detail::RowsOf<Rows4>{points, true});
      return detail::CloudState::Changed{0, static_cast<std::size_t>(count)};
    };
  };
  std::vector<detail::CloudState::Reading> readings;
  std::vector<int> counts;
  readings.push_back(state.read());
  counts.push_back(0);
  for (int k = 0; k < 6; ++k) {
    counts.push_back(1000 * (k + 1) + k);
    state.update(filled_with(counts.back()));
    readings.push_back(state.read());
    EXPECT_THROW(state.update([](detail::ObstacleSet& set) -> detail::CloudState::Changed {
      set.remove(Box(Eigen::Vector3d::Constant(-1.0), Eigen::Vector3d::Ones()));
      throw std::invalid_argument("no");
    }),
                 std::invalid_argument);
    EXPECT_EQ(state.read().version(), readings.back().version());
  }
  for (std::size_t k = 0; k < readings.size(); ++k) {
    EXPECT_EQ(readings[k].points().count(), counts[k]);
    EXPECT_EQ(readings[k].version(), static_cast<int>(k));
  }
  const std::size_t all = state.bytes();
  readings.clear();
  for (int k = 0; k < 3; ++k) state.update(filled_with(1000));
  EXPECT_LT(state.bytes(), all / 2);  // what nobody reads any more is given back
}

TEST(Cloud, updates_one_after_the_other_leave_the_points_of_a_cloud_that_is_made_anew_between) {
  for (int seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Rows4 points = surfaces(random, seed % 2 == 0 ? 300 : 6000, 0.02);
    Cloud watched{Obstacles(points)}, alone{Obstacles(points)};
    const Robot robot = Robot::builtin("panda");
    for (int k = 0; k < 25; ++k) {
      const Box region = random_box(random, random.uniform(0.05, 1.2));
      const Rows4 all = surfaces(random, 400, 0.02);
      const Rows4 more = rows_where(
          all, [&](Eigen::Index i) { return region.contains(all.row(i).head<3>().transpose()); });
      if (k % 4 == 3) {
        EXPECT_EQ(watched.remove(region), alone.remove(region));
      } else {
        EXPECT_EQ(watched.update(Obstacles(more), region), alone.update(Obstacles(more), region));
      }
      if (k % 3 == 0) alone = Cloud{Obstacles(alone.points())};  // never anything to repeat
      EXPECT_EQ(sorted_rows(watched.points()), sorted_rows(alone.points()));
      EXPECT_EQ(clearance_among(robot, robot.mid_configuration(), watched),
                clearance_among(robot, robot.mid_configuration(), alone));
    }
  }
}

TEST(Cloud, a_step_does_not_wait_for_an_update) {
  using Clock = std::chrono::steady_clock;
  const Robot robot = Robot::builtin("panda");
  const detail::Model model(robot, {});
  detail::Scene scene(model.robot, model.hulls, model.options);
  const auto state = std::make_shared<detail::CloudState>();
  scene.use(state);
  std::atomic<bool> begun = false, may_end = false;
  std::jthread updates([&] {
    state->update([&](detail::ObstacleSet&) {
      begun = true;
      while (!may_end) std::this_thread::yield();
      return detail::CloudState::Changed{0, 0};
    });
  });
  while (!begun) std::this_thread::yield();
  std::jthread watchdog([&] {  // or the test would never end
    const auto until = Clock::now() + std::chrono::seconds(5);
    while (!may_end && Clock::now() < until) std::this_thread::yield();
    EXPECT_TRUE(may_end.exchange(true)) << "it waits";
  });
  for (int k = 0; k < 100; ++k) EXPECT_EQ(scene.read().points().count(), 0);
  may_end = true;
}

}  // namespace
}  // namespace pdoik
