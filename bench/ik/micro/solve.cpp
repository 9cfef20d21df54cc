// Whole solves from mid-range, each arm, 256 random reachable targets in turn: their mean time.
#include <benchmark/benchmark.h>

#include "arms.hpp"

namespace pdoik::bench {
namespace {

constexpr int kTargets = 256;

void solve_all(benchmark::State& state, const Options& options, int points) {
  const Robot robot = Robot::builtin(kArms[static_cast<std::size_t>(state.range(0))]);
  const std::vector<ReachScene> scenes = reach_scenes(robot, kTargets, points);
  const Eigen::VectorXd q0 = robot.mid_configuration();
  Solver solver(robot, options);
  Result result;
  std::size_t turn = 0;
  double solved = 0.0, restarts = 0.0, iterations = 0.0;
  for (auto _ : state) {
    const ReachScene& scene = scenes[turn++ % scenes.size()];
    if (points > 0) solver.set_obstacles(scene.points);
    solver.solve(scene.T_base_tip, &q0, result);
    solved += result.success ? 1.0 : 0.0;
    restarts += result.restarts;
    iterations += result.iterations;
  }
  using benchmark::Counter;
  state.counters["solved"] = Counter(solved, Counter::kAvgIterations);
  state.counters["restarts"] = Counter(restarts, Counter::kAvgIterations);
  state.counters["iterations"] = Counter(iterations, Counter::kAvgIterations);
  state.SetLabel(kArms[static_cast<std::size_t>(state.range(0))]);
}

// Without self-collision, which the paper's arms do not have.
void Solve(benchmark::State& state) {
  Options options;
  options.self_collision = false;
  solve_all(state, options, static_cast<int>(state.range(1)));
}

// As a user gets it.
void SolveOffItself(benchmark::State& state) {
  solve_all(state, {}, static_cast<int>(state.range(1)));
}

// From one start, at the paper's tolerance.
void SolvePaper(benchmark::State& state) {
  Options options;
  options.method = Method::Paper;
  options.position_tolerance = options.rotation_tolerance = 0.01;
  solve_all(state, options, static_cast<int>(state.range(1)));
}

void each_arm_and_cloud(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"arm", "N"})
      ->ArgsProduct({{0, 1, 2}, {0, 136}})
      ->Unit(benchmark::kMicrosecond);
}

BENCHMARK(Solve)->Apply(each_arm_and_cloud);
BENCHMARK(SolveOffItself)->Apply(each_arm_and_cloud);
BENCHMARK(SolvePaper)->Apply(each_arm_and_cloud);

}  // namespace
}  // namespace pdoik::bench
