// The paper's claim (Sec. Complexity Analysis): one evaluation costs O(M' N).
#include <benchmark/benchmark.h>

#include "arms.hpp"
#include "plain_problem.hpp"

namespace pdoik::bench {
namespace {

constexpr auto kSlack = JointLimitMap::Slack::PerSubAngle;  // M' variables, as in the paper

void evaluate(benchmark::State& state, const Robot& robot, int obstacles) {
  Evaluator bench(robot, obstacles, kSlack);
  Eigen::VectorXd gradient(bench.map.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(bench.lagrangian.lagrangian(bench.next_omega(), Penalty{}, gradient));
  }
}

void evaluate_plain(benchmark::State& state, const Robot& robot, int obstacles) {
  Evaluator bench(robot, 0, kSlack);
  PlainProblem plain(robot, bench.options);
  plain.set_obstacles(random_cloud(obstacles));
  Eigen::VectorXd gradient(plain.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        plain.lagrangian(bench.next_omega(), Penalty{PenaltyForm::Printed}, gradient));
  }
}

using Evaluate = void (*)(benchmark::State&, const Robot&, int);

// N points, Panda.
void OverObstacles(benchmark::State& state, Evaluate run) {
  run(state, Robot::builtin("panda"), static_cast<int>(state.range(0)));
  state.SetComplexityN(state.range(0));
}

// 136 points, M' joints of one sub-angle each.
void OverJoints(benchmark::State& state, Evaluate run) {
  run(state, zigzag_arm(static_cast<int>(state.range(0)), 1), 136);
  state.SetComplexityN(state.range(0));
}

// No points, six joints of M'/6 sub-angles each: what the decomposition of an angle adds.
void OverSubAngles(benchmark::State& state, Evaluate run) {
  run(state, zigzag_arm(6, static_cast<int>(state.range(0)) / 6), 0);
  state.SetComplexityN(state.range(0));
}

#define BOTH(function, ...)                                                             \
  BENCHMARK_CAPTURE(function, pdoik, evaluate)->__VA_ARGS__->Complexity(benchmark::oN); \
  BENCHMARK_CAPTURE(function, plain, evaluate_plain)->__VA_ARGS__->Complexity(benchmark::oN)

BOTH(OverObstacles, RangeMultiplier(2)->Range(64, 8192));
BOTH(OverJoints, DenseRange(4, 40, 4));
BOTH(OverSubAngles, DenseRange(6, 48, 6));

}  // namespace
}  // namespace pdoik::bench
