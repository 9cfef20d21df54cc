// What happens to a cloud before a solve.
#include <benchmark/benchmark.h>

#include "arms.hpp"

namespace pdoik::bench {
namespace {

void VoxelFilter(benchmark::State& state) {
  const Points points = random_cloud(static_cast<int>(state.range(0)));
  Eigen::Index kept = 0;
  for (auto _ : state) kept = voxel_downsample(points, 0.1).rows();
  state.counters["kept"] = static_cast<double>(kept);
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
BENCHMARK(SetObstacles)->ArgName("points")->Arg(24)->Arg(136)->Arg(1000);

}  // namespace
}  // namespace pdoik::bench
