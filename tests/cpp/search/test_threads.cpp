#include <algorithm>
#include <chrono>
#include <functional>
#include <thread>

#include "obstacles/cell_order.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/lagrangian.hpp"
#include "pdoik/tracker.hpp"
#include "solver_settings.hpp"

/// What several threads may do at once; tests/run.sh tsan runs these under ThreadSanitizer too.
namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr int kThreads = 4;

/// work(t) on threads of its own for t = 0 to kThreads - 1, all started before any ends.
void on_threads(const std::function<void(int)>& work) {
  std::vector<std::jthread> pool;
  for (int t = 0; t < kThreads; ++t) pool.emplace_back([&work, t] { work(t); });
}

std::vector<Eigen::Isometry3d> some_targets(const Robot& robot, int seed, int count) {
  Random random(static_cast<std::uint64_t>(seed));
  std::vector<Eigen::Isometry3d> targets;
  for (int k = 0; k < count; ++k) targets.push_back(robot.fk(random_configuration(robot, random)));
  return targets;
}

std::vector<Result> solve_all(Solver& solver, const std::vector<Eigen::Isometry3d>& targets) {
  std::vector<Result> results;
  results.reserve(targets.size());
  for (const Eigen::Isometry3d& target : targets) results.push_back(solver.solve(target));
  return results;
}

void expect_same_all(const std::vector<Result>& a, const std::vector<Result>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) expect_same(a[i], b[i]);
}

TEST(Threads, solvers_that_share_one_robot_answer_as_each_would_alone) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(3);
  const ObstacleMatrix cloud = random_obstacles(random, 30, 0.9, 0.03);
  for_settings([&](Options options) {
    options.max_restarts = 4;
    const auto answers = [&](int t) {
      Solver solver(robot, options);
      solver.set_obstacles(cloud.topRows(10 + 5 * t));
      return solve_all(solver, some_targets(robot, t, 8));
    };
    std::vector<std::vector<Result>> together(kThreads);
    on_threads([&](int t) { together[static_cast<std::size_t>(t)] = answers(t); });
    for (int t = 0; t < kThreads; ++t)
      expect_same_all(together[static_cast<std::size_t>(t)], answers(t));
  });
}

TEST(Threads, a_solver_may_be_copied_by_many_at_once_and_copies_answer_like_it) {
  const Robot robot = with_hulls(Robot::builtin("iiwa14"));
  Options options = timeless();
  options.max_restarts = 4;
  Random random(4);
  const ObstacleMatrix cloud = random_obstacles(random, 30, 0.9, 0.03);
  Solver original(robot, options);
  original.set_obstacles(cloud);
  const std::vector<Eigen::Isometry3d> targets = some_targets(robot, 5, 10);
  std::vector<std::vector<Result>> together(kThreads);
  on_threads([&](int t) {
    Solver own(original);
    together[static_cast<std::size_t>(t)] = solve_all(own, targets);
  });
  const std::vector<Result> alone = solve_all(original, targets);
  for (const std::vector<Result>& results : together) expect_same_all(results, alone);
}

TEST(Threads, solve_batch_may_run_in_several_threads_at_once_on_one_solver_and_on_copies_of_it) {
  const Robot robot = with_hulls(Robot::builtin("ur10"));
  Options options = timeless();
  options.max_restarts = 4;
  Random random(6);
  const ObstacleMatrix cloud = random_obstacles(random, 30, 0.9, 0.03);
  Solver original(robot, options);
  original.set_obstacles(cloud);
  const std::vector<Eigen::Isometry3d> targets = some_targets(robot, 7, 12);
  std::vector<std::vector<Result>> together(kThreads);
  on_threads([&](int t) {
    const Solver copy(original);
    together[static_cast<std::size_t>(t)] =
        (t % 2 == 0 ? original : copy).solve_batch(targets, {}, 1 + t);
  });
  const std::vector<Result> alone = solve_all(original, targets);
  for (const std::vector<Result>& results : together) expect_same_all(results, alone);
}

TEST(Threads, a_batch_that_cannot_be_solved_throws_in_the_thread_that_asked) {
  const Robot robot = Robot::builtin("panda");
  const Solver solver(robot, timeless());
  std::vector<Eigen::Isometry3d> targets = some_targets(robot, 8, 6);
  targets[3].translation().x() = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> said(kThreads);
  on_threads([&](int t) {
    try {
      (void)solver.solve_batch(targets, {}, 3);
    } catch (const std::invalid_argument& error) {
      said[static_cast<std::size_t>(t)] = error.what();
    }
  });
  for (const std::string& words : said)
    EXPECT_NE(words.find("T_base_tip[3]"), std::string::npos) << words;
}

TEST(Threads, trackers_of_one_robot_step_side_by_side_as_each_would_alone) {
  const Robot robot = Robot::builtin("panda");
  Options options;
  options.max_time = 1.0;
  Random random(9);
  const ObstacleMatrix cloud = random_obstacles(random, 60, 0.9, 0.03);
  const auto path_of = [&](int t) {
    Tracker tracker(robot, options, {.period = 0.001, .max_time = 10.0});
    Random own(static_cast<std::uint64_t>(20 + t));
    Eigen::VectorXd q = robot.mid_configuration();
    tracker.reset(q);
    const Eigen::Isometry3d target = robot.fk(random_configuration(robot, own));
    std::vector<Eigen::VectorXd> path;
    for (int k = 0; k < 60; ++k) {
      const bool taken = k % 20 != t || tracker.set_obstacles(cloud.topRows(k));
      EXPECT_TRUE(taken);
      path.push_back(tracker.step(target).q);
    }
    EXPECT_EQ(tracker.latency().count(), 60U);
    EXPECT_GT((path.back() - q).norm(), 0.01);
    return path;
  };
  std::vector<std::vector<Eigen::VectorXd>> together(kThreads);
  on_threads([&](int t) { together[static_cast<std::size_t>(t)] = path_of(t); });
  for (int t = 0; t < kThreads; ++t) EXPECT_EQ(together[static_cast<std::size_t>(t)], path_of(t));
}

TEST(Threads, lagrangians_and_robots_are_made_and_used_side_by_side) {
  const auto value = [](int t) {
    const Robot robot = Robot::builtin(arm_names()[static_cast<std::size_t>(t % 3)]);
    Lagrangian lagrangian(robot, {});
    Random random(static_cast<std::uint64_t>(30 + t));
    lagrangian.set_target(robot.fk(random_configuration(robot, random)));
    lagrangian.set_obstacles(random_obstacles(random, 20, 0.8));
    const Eigen::VectorXd x = random.vector(lagrangian.size(), -1.0, 1.0);
    Eigen::VectorXd gradient(lagrangian.size());
    return lagrangian.lagrangian(x, Penalty{}, gradient);
  };
  std::vector<double> together(kThreads);
  on_threads([&](int t) { together[static_cast<std::size_t>(t)] = value(t); });
  for (int t = 0; t < kThreads; ++t) EXPECT_EQ(together[static_cast<std::size_t>(t)], value(t));
}

TEST(Threads, a_cloud_may_be_updated_while_others_solve_among_it) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(6);
  const ObstacleMatrix points = random_obstacles(random, 3000, 1.5, 0.0);
  Cloud cloud{Obstacles(points)};
  const Eigen::AlignedBox3d region(Eigen::Vector3d::Constant(-0.3), Eigen::Vector3d::Constant(0.9));
  ObstacleMatrix within(0, points.cols());
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (!region.contains(Eigen::Vector3d(points.row(i).head<3>()))) continue;
    within.conservativeResize(within.rows() + 1, Eigen::NoChange);
    within.row(within.rows() - 1) = points.row(i);
  }
  Options options;
  options.max_restarts = 2;
  on_threads([&](int t) {
    if (t == 0) {
      for (int k = 0; k < 20; ++k) {
        cloud.remove(region);
        cloud.update(Obstacles(within), region);
      }
      return;
    }
    Solver solver(robot, options);
    solver.set_obstacles(cloud);
    for (const Result& result : solve_all(solver, some_targets(robot, t, 10)))
      EXPECT_TRUE(result.q.allFinite());
    solver.solve_batch(some_targets(robot, t, 10), {}, 2);
  });
  EXPECT_EQ(cloud.size(), static_cast<std::size_t>(points.rows()));
}

TEST(Threads, who_wants_a_batch_to_end_is_asked_by_the_thread_that_called_and_heard_at_once) {
  const Robot robot = Robot::builtin("ur10");
  Options options;
  options.max_restarts = std::numeric_limits<int>::max();
  options.prefer = Prefer::Nearest;  // all of the time
  for (const double max_time : {20.0, 0.05}) {
    options.max_time = max_time;
    Solver solver(robot, options);
    const auto started = std::chrono::steady_clock::now();
    const auto passed = [&] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    };
    const std::thread::id caller = std::this_thread::get_id();
    solver.set_interrupt([&] {
      EXPECT_EQ(std::this_thread::get_id(), caller);
      return passed() > 0.3;
    });
    const std::vector<Result> results = solver.solve_batch(some_targets(robot, 3, 200), {}, 2);
    EXPECT_LT(passed(), 3.0);
    ASSERT_EQ(results.size(), 200U);
    for (const Result& result : results) EXPECT_TRUE(result.q.allFinite());
    EXPECT_EQ(results.back().status, Status::TimeLimit);
    EXPECT_FALSE(results.back().success);
  }
}

TEST(Threads, points_that_are_no_numbers_by_now_have_cells_all_the_same) {
  Random random(8);
  const ObstacleMatrix points = random_obstacles(random, 3000, 1.5, 0.0);
  for (int place = 0; place < 3000; place += 97) {
    detail::CellOrder order;
    ObstacleMatrix soiled = points;
    soiled(place, place % 3) = place % 2 == 0 ? std::nan("") : 1e300;
    const auto row = [&](int k) {
      return detail::Vec4{soiled(k, 0), soiled(k, 1), soiled(k, 2), 0.0};
    };
    order.begin(3000,
                [&](int k) { return detail::Vec4{points(k, 0), points(k, 1), points(k, 2), 0.0}; });
    for (int k = 0; k < 3000; ++k) order.add(row(k));
    std::vector<bool> there(3000, false);
    for (const auto& entry : order.sorted()) there[static_cast<std::size_t>(entry.row)] = true;
    EXPECT_EQ(std::count(there.begin(), there.end(), true), 3000);
  }
}

}  // namespace
}  // namespace pdoik
