// A humanoid's step and solve with all that it has to keep: its other foot's pose, balance,
// self-collision and 168 obstacle points. Steps' tails come from the tracker's own histogram, which
// counts the cloud's intake apart: a step's time is that of Tracker::step.
#include <benchmark/benchmark.h>

#include "humanoid.hpp"

namespace pdoik::bench {
namespace {

using benchmark::Counter;

// Each iteration is one period of 1 ms: a new posture, a new cloud if there is one, and a step.
void TrackerStep(benchmark::State& state) {
  const Standing standing;
  const bool points = state.range(0) > 0;
  Tracker tracker(standing.robot, standing.options(), {.period = 0.001, .posture_weight = 1e-2});
  tracker.reset(standing.q0);
  const auto beat = [&](int k) {
    tracker.set_posture(standing.posture(0.001 * k));
    if (points) tracker.set_obstacles(swinging_ball(0.001 * k));
  };
  int k = 0;
  for (; k < 100; ++k) {
    beat(k);
    tracker.step({&standing.right_foot, 1});
  }
  tracker.clear_latency();
  double tracking = 0.0, evaluations = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    beat(k++);
    state.ResumeTiming();
    const TrackerResult& result = tracker.step({&standing.right_foot, 1});
    tracking += result.tracking == TrackerStatus::Tracking ? 1.0 : 0.0;
    evaluations += result.evaluations;
  }
  const LatencyHistogram& latency = tracker.latency();
  for (const auto& [name, share] :
       {std::pair{"median_us", 0.5}, {"p99_us", 0.99}, {"p99.9_us", 0.999}, {"max_us", 1.0}})
    state.counters[name] = 1e6 * latency.quantile(share);
  state.counters["tracking"] = Counter(tracking, Counter::kAvgIterations);
  state.counters["evaluations"] = Counter(evaluations, Counter::kAvgIterations);
}

// The same as one solve each, from the standing posture, among the ball where it then is.
void HumanoidSolve(benchmark::State& state) {
  const Standing standing;
  Options options = standing.options();
  options.max_time = 1.0;
  Solver solver(standing.robot, options);
  const bool points = state.range(0) > 0, with_posture = state.range(1) > 0;
  Result result;
  LatencyHistogram latency;
  double solved = 0.0, restarts = 0.0;
  int k = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const double t = 0.037 * k++;
    const Eigen::VectorXd posture = standing.posture(t);
    const Points ball = swinging_ball(t);
    state.ResumeTiming();
    if (points) solver.set_obstacles(ball);
    solver.solve({.goals = {&standing.right_foot, 1},
                  .q0 = &standing.q0,
                  .posture = with_posture ? &posture : nullptr},
                 result);
    latency.add(result.time);
    solved += result.success ? 1.0 : 0.0;
    restarts += result.restarts;
  }
  for (const auto& [name, share] :
       {std::pair{"median_us", 0.5}, {"p99_us", 0.99}, {"p99.9_us", 0.999}, {"max_us", 1.0}})
    state.counters[name] = 1e6 * latency.quantile(share);
  state.counters["solved"] = Counter(solved, Counter::kAvgIterations);
  state.counters["restarts"] = Counter(restarts, Counter::kAvgIterations);
}

BENCHMARK(TrackerStep)
    ->ArgName("N")
    ->Arg(0)
    ->Arg(168)
    ->Iterations(20000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(HumanoidSolve)
    ->ArgNames({"N", "posture"})
    ->ArgsProduct({{0, 168}, {0, 1}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pdoik::bench
