// The paper's claim (Sec. Complexity Analysis): one evaluation costs O(M' N); the same for trees.
#include <benchmark/benchmark.h>

#include <string>

#include "arms.hpp"
#include "plain_problem.hpp"

namespace pdoik::bench {
namespace {

void evaluate(benchmark::State& state, const Robot& robot, int obstacles) {
  Evaluator bench(robot, obstacles);
  Eigen::VectorXd gradient(bench.map.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(bench.lagrangian.lagrangian(bench.next_omega(), Penalty{}, gradient));
  }
}

void evaluate_plain(benchmark::State& state, const Robot& robot, int obstacles) {
  Evaluator bench(robot, 0);
  testing::PlainProblem plain(robot, bench.options);
  plain.set_obstacles(random_cloud(obstacles));
  Eigen::VectorXd gradient(plain.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        plain.lagrangian(bench.next_sub_angles(), Penalty{PenaltyForm::Printed}, gradient));
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

/// A tree of `limbs` equal limbs of four joints each, a sphere and a spheroid at each joint, masses
/// everywhere and a goal at each limb's end; as a robot to be balanced.
Robot star(int limbs) {
  constexpr double kLength = 0.15, kRadius = 0.05;
  RobotDescription star{
      .name = "star", .links = {{.name = "base", .mass = 1.0}}, .joints = {}, .warnings = {}};
  Occupancy occupancy;
  std::vector<std::string> tips;
  for (int limb = 0; limb < limbs; ++limb) {
    std::string parent = "base";
    for (int i = 0; i < 4; ++i) {
      const std::string name = "limb" + std::to_string(10 * limb + i);
      LinkDescription link{.name = name, .mass = 0.5};
      link.center_of_mass.x() = 0.5 * kLength;
      star.links.push_back(link);
      JointDescription joint;
      joint.name = name;
      joint.type = JointType::Revolute;
      joint.parent_link = parent;
      joint.child_link = name;
      joint.lower = -1.5;
      joint.upper = 1.5;
      joint.axis = i % 2 == 0 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
      if (i == 0) joint.T_parent_child.rotate(Eigen::AngleAxisd(limb, Eigen::Vector3d::UnitZ()));
      joint.T_parent_child.translate(Eigen::Vector3d(kLength, 0.0, 0.0));
      star.joints.push_back(joint);
      const Eigen::Vector3d origin = Eigen::Vector3d::Zero(), end(kLength, 0.0, 0.0);
      occupancy.spheres.push_back({name, origin, kRadius});
      occupancy.spheroids.push_back({name, origin, name, end, std::hypot(0.5 * kLength, kRadius)});
      parent = name;
    }
    tips.push_back(parent);
  }
  Robot robot(star, "base", tips);
  robot.set_occupancy(occupancy);
  return robot;
}

void evaluate_tree(benchmark::State& state, int limbs, int obstacles) {
  Options options;
  const Robot robot = star(limbs);
  options.balance.com_lower = Eigen::Vector3d::Constant(-0.01);
  options.balance.com_upper = Eigen::Vector3d::Constant(0.01);
  Evaluator bench(robot, obstacles, options);
  std::vector<Goal> goals;
  for (int tip = 0; tip < limbs; ++tip) {
    Goal goal;
    goal.tip = tip;
    goal.T_base_tip = robot.fk(bench.next_q(), robot.tips()[static_cast<std::size_t>(tip)]);
    goals.push_back(goal);
  }
  bench.problem.set_goals(goals);
  Eigen::VectorXd gradient(bench.map.size());
  for (auto _ : state) {
    benchmark::DoNotOptimize(bench.lagrangian.lagrangian(bench.next_omega(), Penalty{}, gradient));
  }
}

// A tree of 5 limbs with goals, balanced, among N points.
void TreeOverObstacles(benchmark::State& state) {
  evaluate_tree(state, 5, static_cast<int>(state.range(0)));
  state.SetComplexityN(state.range(0));
}

// 136 points, M' joints on M'/4 limbs, each with a goal.
void TreeOverJoints(benchmark::State& state) {
  evaluate_tree(state, static_cast<int>(state.range(0)) / 4, 136);
  state.SetComplexityN(state.range(0));
}

#define BOTH(function, ...)                                                             \
  BENCHMARK_CAPTURE(function, pdoik, evaluate)->__VA_ARGS__->Complexity(benchmark::oN); \
  BENCHMARK_CAPTURE(function, plain, evaluate_plain)->__VA_ARGS__->Complexity(benchmark::oN)

BOTH(OverObstacles, RangeMultiplier(2)->Range(64, 8192));
BOTH(OverJoints, DenseRange(4, 40, 4));
BOTH(OverSubAngles, DenseRange(6, 48, 6));
BENCHMARK(TreeOverObstacles)->RangeMultiplier(2)->Range(64, 8192)->Complexity(benchmark::oN);
BENCHMARK(TreeOverJoints)->DenseRange(4, 64, 12)->Complexity(benchmark::oN);

}  // namespace
}  // namespace pdoik::bench
