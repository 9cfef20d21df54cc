// Many targets at once: free, among scattered points, and over a table with a hand and
// self-collision. Targets per second of a batch of 100 and of one of 5,000, at 1e-3, on all
// processors.
#include <benchmark/benchmark.h>

#include <cmath>

#include "arms.hpp"

namespace pdoik::bench {
namespace {

using testing::Random;
using testing::random_configuration;

constexpr double kTable = -0.1;  // [m]

struct Scene {
  Robot robot;
  Options options;
  Points points{0, 3};
};

Options loose() {
  Options options;
  options.position_tolerance = options.rotation_tolerance = 1e-3;
  options.self_collision = false;
  return options;
}

/// A hand beyond the tip: 6 cm by 20 cm, and two fingers' room before it.
Robot with_hand(Robot robot) {
  Occupancy occupancy = robot.occupancy();
  const std::string tip = robot.tip_links().front();
  occupancy.spheroids.push_back({tip, {0.0, -0.07, 0.04}, tip, {0.0, 0.07, 0.04}, 0.085});
  occupancy.spheres.push_back({tip, {0.0, 0.0, 0.09}, 0.035});
  robot.set_occupancy(occupancy);
  return robot;
}

/// What a camera sees of a table around the robot's pedestal, which is 10 cm high.
Points table() {
  constexpr double kStep = 0.02;
  std::vector<Eigen::RowVector3d> rows;
  for (double x = -0.3; x < 1.2; x += kStep) {
    for (double y = -0.75; y < 0.75; y += kStep)
      if (std::hypot(x, y) > 0.15) rows.emplace_back(x, y, kTable);
  }
  Points points(static_cast<Eigen::Index>(rows.size()), 3);
  for (std::size_t i = 0; i < rows.size(); ++i) points.row(static_cast<Eigen::Index>(i)) = rows[i];
  return points;
}

/// 150 points all around, none near the base.
Points scattered() {
  Random random(1);
  Points points(150, 3);
  for (Eigen::Index i = 0; i < points.rows();) {
    points.row(i) << random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2), random.uniform(0.0, 1.5);
    if (points.row(i).norm() > 0.4) ++i;
  }
  return points;
}

Scene scene_of(int kind, const char* arm) {
  if (kind == 2) {
    Scene scene{with_hand(Robot::builtin(arm)), loose(), table()};
    scene.options.self_collision = true;
    scene.options.base_collision = false;
    return scene;
  }
  return {Robot::builtin(arm), loose(), kind == 1 ? scattered() : Points(0, 3)};
}

/// Where a hand is above a table, pointing down but for a tilt.
Eigen::Isometry3d grasp(Random& random) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const double angle = random.uniform(-M_PI, M_PI), away = random.uniform(0.35, 0.65);
  T.translation() << away * std::cos(angle), away * std::sin(angle),
      kTable + random.uniform(0.16, 0.4);
  T.linear() = (Eigen::AngleAxisd(random.uniform(-M_PI, M_PI), Eigen::Vector3d::UnitZ()) *
                Eigen::AngleAxisd(M_PI + random.uniform(-0.4, 0.4), Eigen::Vector3d::UnitX()))
                   .toRotationMatrix();
  return T;
}

/// Poses of random configurations that are clear, or grasps that were solved with more time.
std::vector<Eigen::Isometry3d> solvable_targets(const Scene& scene, bool over_table, int count) {
  Random random(5);
  Options options = scene.options;
  options.max_time = 0.1;
  Solver solver(scene.robot, options);
  solver.set_obstacles(scene.points);
  Result result;
  std::vector<Eigen::Isometry3d> targets;
  while (static_cast<int>(targets.size()) < count) {
    const Eigen::VectorXd q = random_configuration(scene.robot, random);
    const Eigen::Isometry3d target = over_table ? grasp(random) : scene.robot.fk(q);
    if (over_table)
      result = solver.solve(target);
    else
      solver.judge(target, q, result);
    if (result.success) targets.push_back(target);
  }
  return targets;
}

void Batch(benchmark::State& state) {
  constexpr std::array kKinds{"free", "scattered", "table"};
  const auto arm = kArms[static_cast<std::size_t>(state.range(0))];
  const auto kind = static_cast<int>(state.range(1));
  const Scene scene = scene_of(kind, arm);
  const auto targets = solvable_targets(scene, kind == 2, static_cast<int>(state.range(2)));
  Solver solver(scene.robot, scene.options);
  solver.set_obstacles(scene.points);
  std::size_t solved = 0;
  for (auto _ : state) {
    solved = 0;
    for (const Result& result : solver.solve_batch(targets)) solved += result.success ? 1 : 0;
  }
  const auto count = static_cast<double>(targets.size());
  state.counters["solved"] = static_cast<double>(solved) / count;
  state.counters["rate"] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
  state.SetLabel(std::string(arm) + " " + kKinds[static_cast<std::size_t>(kind)]);
}
BENCHMARK(Batch)
    ->ArgNames({"arm", "scene", "targets"})
    ->ArgsProduct({{0, 1, 2}, {0, 1, 2}, {100, 5000}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pdoik::bench
