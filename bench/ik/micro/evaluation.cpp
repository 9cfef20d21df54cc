// One evaluation and its parts, on the three arms, among N obstacle points.
#include <benchmark/benchmark.h>

#include <vector>

#include "arms.hpp"
#include "plain_problem.hpp"

namespace pdoik::bench {
namespace {

void label(benchmark::State& state, const Evaluator& bench) {
  state.SetLabel(std::string(kArms[static_cast<std::size_t>(state.range(0))]) + ", " +
                 std::to_string(bench.robot.occupancy().size()) + " hulls");
}

Robot arm_of(const benchmark::State& state) {
  return Robot::builtin(kArms[static_cast<std::size_t>(state.range(0))]);
}

// Algorithm FWD: joint-limit map, frames, goal, constraints of all pairs that touch.
void Rollout(benchmark::State& state) {
  Evaluator bench(arm_of(state), static_cast<int>(state.range(1)));
  for (auto _ : state)
    benchmark::DoNotOptimize(bench.lagrangian.max_constraint(bench.next_omega()));
  label(state, bench);
}

// Algorithm Jacobian: forces of the goal and of the pairs that touch, to a gradient.
void ReversePass(benchmark::State& state) {
  using detail::Constraint;
  Evaluator bench(arm_of(state), static_cast<int>(state.range(1)));
  const Eigen::VectorXd omega = bench.next_omega();
  bench.lagrangian.max_constraint(omega);  // leaves rollout, goals and near pairs at omega
  JointLimitMap::State map_state = bench.map.make_state();
  bench.map.forward(omega, map_state, false);
  std::vector<Constraint> constraints;
  for (int k = 0; k < bench.moving.near_count(); ++k) {
    const detail::NearPair& pair = bench.moving.near(k);
    constraints.push_back(detail::paper_constraint(bench.moving, bench.moving.hull(pair),
                                                   bench.scene.obstacles()[pair.obstacle]));
  }
  const auto push = [&](int point, const detail::Vec4& force) {
    bench.problem.rollout.add_force(bench.moving.body_of_point(point), bench.moving.position(point),
                                    force);
  };
  Eigen::VectorXd dq(bench.robot.dof()), gradient(bench.map.size());
  for (auto _ : state) {
    bench.problem.rollout.clear_wrenches();
    detail::Vec4 force, moment;
    benchmark::DoNotOptimize(
        bench.problem.goals.front().point_objective(bench.options.point_distance, force, moment));
    bench.problem.rollout.add_wrench(bench.problem.goals.front().body(), force, moment);
    for (std::size_t k = 0; k < constraints.size(); ++k) {
      const detail::Hull& hull = bench.moving.hull(bench.moving.near(static_cast<int>(k)));
      push(hull.a, constraints[k].dc_da);
      if (!hull.is_sphere()) push(hull.b, constraints[k].dc_db);
    }
    bench.problem.rollout.reverse(dq.data(), static_cast<int>(dq.size()));
    bench.map.pull_back(map_state, dq, gradient);
    benchmark::DoNotOptimize(gradient.data());
    benchmark::ClobberMemory();
  }
  label(state, bench);
}

// Both: Eq. AL and its gradient over the slack variables.
void Evaluation(benchmark::State& state) {
  Evaluator bench(arm_of(state), static_cast<int>(state.range(1)));
  Eigen::VectorXd gradient(bench.map.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(bench.lagrangian.lagrangian(bench.next_omega(), Penalty{}, gradient));
  }
  label(state, bench);
}

// The same by PlainProblem.
void EvaluationPlain(benchmark::State& state) {
  Evaluator bench(arm_of(state), 0);
  testing::PlainProblem plain(bench.robot, bench.options);
  plain.set_obstacles(random_cloud(static_cast<int>(state.range(1))));
  Eigen::VectorXd gradient(plain.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        plain.lagrangian(bench.next_sub_angles(), Penalty{PenaltyForm::Printed}, gradient));
  }
  label(state, bench);
}

// What the default method evaluates instead: residuals, and their Jacobian to a Hessian and a
// gradient.
void EvaluationLeastSquares(benchmark::State& state) {
  Evaluator bench(arm_of(state), static_cast<int>(state.range(1)));
  Eigen::MatrixXd H(bench.robot.dof(), bench.robot.dof());
  Eigen::VectorXd g(bench.robot.dof());
  for (auto _ : state) {
    benchmark::DoNotOptimize(bench.least_squares.evaluate(bench.next_q()));
    bench.least_squares.linearise(H, g);
  }
  label(state, bench);
}

// One iteration of L-BFGS: the time of 20, evaluations in line searches included, over their
// number.
void LbfgsIteration(benchmark::State& state) {
  Evaluator bench(arm_of(state), static_cast<int>(state.range(1)));
  LbfgsOptions options = bench.options.lbfgs;
  options.max_iterations = 20;
  Lbfgs lbfgs(bench.map.size(), options);
  Eigen::VectorXd omega(bench.map.size());
  const auto evaluate = [&](const Eigen::VectorXd& at, Eigen::VectorXd& gradient) {
    return bench.lagrangian.lagrangian(at, Penalty{}, gradient);
  };
  double iterations = 0.0, evaluations = 0.0;
  for (auto _ : state) {
    omega = bench.next_omega();
    const LbfgsResult result = lbfgs.minimize(evaluate, omega);
    iterations += result.iterations;
    evaluations += result.evaluations;
  }
  using benchmark::Counter;
  state.counters["per_iteration"] = Counter(iterations, Counter::kIsRate | Counter::kInvert);
  state.counters["evaluations"] = evaluations / iterations;
  label(state, bench);
}

void each_arm_and_cloud(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"arm", "N"})->ArgsProduct({{0, 1, 2}, {0, 24, 136, 1000}});
}

BENCHMARK(Rollout)->Apply(each_arm_and_cloud);
BENCHMARK(ReversePass)->Apply(each_arm_and_cloud);
BENCHMARK(Evaluation)->Apply(each_arm_and_cloud);
BENCHMARK(EvaluationPlain)->Apply(each_arm_and_cloud);
BENCHMARK(EvaluationLeastSquares)->Apply(each_arm_and_cloud);
BENCHMARK(LbfgsIteration)->Apply(each_arm_and_cloud)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace pdoik::bench
