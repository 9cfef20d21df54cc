// What happens to a cloud before a solve.
#include <benchmark/benchmark.h>

#include <cmath>

#include "arms.hpp"

namespace pdoik::bench {
namespace {

void VoxelFilter(benchmark::State& state) {
  const Points points = random_cloud(static_cast<int>(state.range(0)));
  Eigen::Index kept = 0;
  for (auto _ : state) kept = voxel_downsample(points, 0.1).rows();
  state.counters["kept"] = static_cast<double>(kept);
}

/// The same table and seven balls on it, seen with this many points.
Points table_and_balls(int count) {
  testing::Random random(7);
  std::vector<Eigen::Vector4d> balls;
  for (int k = 0; k < 7; ++k) {
    const double angle = 0.9 * k, away = random.uniform(0.45, 0.75), r = random.uniform(0.04, 0.1);
    balls.emplace_back(away * std::cos(angle), away * std::sin(angle), r - 0.1, r);
  }
  Points points(count, 3);
  for (int i = 0; i < count; ++i) {
    if (i % 2 == 0) {
      const double angle = random.uniform(-M_PI, M_PI), away = std::sqrt(random.uniform(0.04, 1.5));
      points.row(i) << away * std::cos(angle), away * std::sin(angle), -0.1;
    } else {
      const Eigen::Vector4d& ball = balls[static_cast<std::size_t>(i / 2) % balls.size()];
      points.row(i) = (ball.head<3>() + ball[3] * random.direction()).transpose();
    }
  }
  return points;
}

/// One solve after the other among the same cloud, each from mid-range to the pose of a random
/// configuration that is clear.
void SolveAmong(benchmark::State& state) {
  const Robot robot = Robot::builtin(kArms[static_cast<std::size_t>(state.range(0))]);
  Options options;
  options.base_collision = false;
  options.self_collision = false;
  Solver solver(robot, options);
  solver.set_obstacles(table_and_balls(1000000));
  testing::Random random(8);
  Result result;
  std::vector<Eigen::Isometry3d> targets;
  while (targets.size() < 256) {
    const Eigen::VectorXd q = testing::random_configuration(robot, random);
    solver.judge(robot.fk(q), q, result);
    if (result.success) targets.push_back(robot.fk(q));
  }
  solver.set_obstacles(table_and_balls(static_cast<int>(state.range(1))));
  const Eigen::VectorXd q0 = robot.mid_configuration();
  std::size_t turn = 0;
  double solved = 0.0, restarts = 0.0;
  for (auto _ : state) {
    solver.solve(targets[turn++ % targets.size()], &q0, result);
    solved += result.success ? 1.0 : 0.0;
    restarts += result.restarts;
  }
  using benchmark::Counter;
  state.counters["solved"] = Counter(solved, Counter::kAvgIterations);
  state.counters["restarts"] = Counter(restarts, Counter::kAvgIterations);
  state.SetLabel(kArms[static_cast<std::size_t>(state.range(0))]);
}

/// What the same cloud's bytes are, and its intake, into memory that is fresh each time.
void Intake(benchmark::State& state) {
  const Points points = table_and_balls(static_cast<int>(state.range(0)));
  double bytes = 0.0;
  for (auto _ : state) {
    const Cloud cloud{Obstacles(points)};
    bytes = static_cast<double>(cloud.bytes());
  }
  state.counters["bytes_a_point"] = bytes / static_cast<double>(state.range(0));
}

/// A hundredth of the cloud's points in place of the same.
void Update(benchmark::State& state) {
  const Points points = table_and_balls(static_cast<int>(state.range(0)));
  Cloud cloud{Obstacles(points)};
  const double half = 0.5 * std::sqrt(0.01 * M_PI * 1.5 * 2.0);
  const Eigen::AlignedBox3d region(Eigen::Vector3d(-half - 0.3, -half - 0.3, -1.0),
                                   Eigen::Vector3d(half - 0.3, half - 0.3, 1.0));
  Points within(points.rows(), 3);
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (region.contains(Eigen::Vector3d(points.row(i)))) within.row(count++) = points.row(i);
  }
  const Points more = within.topRows(count);
  for (auto _ : state) cloud.update(Obstacles(more), region);
  state.counters["share"] = static_cast<double>(count) / static_cast<double>(points.rows());
}

void SetObstacles(benchmark::State& state) {
  Options options;
  options.max_obstacles = static_cast<int>(state.range(0));
  Solver solver(Robot::builtin("panda"), options);
  const Points points = random_cloud(static_cast<int>(state.range(0)));
  for (auto _ : state) solver.set_obstacles(points);
}

BENCHMARK(VoxelFilter)
    ->ArgName("points")
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(SetObstacles)
    ->ArgName("points")
    ->Arg(24)
    ->Arg(136)
    ->Arg(1000)
    ->Arg(10000)
    ->Arg(100000)
    ->Arg(1000000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(Intake)->ArgName("points")->Arg(10000)->Arg(100000)->Arg(1000000)->Unit(
    benchmark::kMicrosecond);
BENCHMARK(Update)->ArgName("points")->Arg(10000)->Arg(100000)->Arg(1000000)->Unit(
    benchmark::kMicrosecond);
BENCHMARK(SolveAmong)
    ->ArgNames({"arm", "N"})
    ->ArgsProduct({{0, 1, 2}, {136, 10000, 100000, 1000000}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pdoik::bench
