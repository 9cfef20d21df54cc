#include "arms.hpp"

#include <cmath>

#include "sub_angles.hpp"

namespace pdoik::bench {
namespace {

using testing::Random;
using testing::random_configuration;

Eigen::RowVector3d random_point(Random& random) {
  const double x = random.uniform(-0.6, 0.6), y = random.uniform(-0.6, 0.6);
  return {x, y, random.uniform(0.0, 1.2)};
}

}  // namespace

Robot zigzag_arm(int joints, int sub_angles) {
  constexpr double kRadius = 0.05;
  const double length = 1.2 / joints;
  std::vector<DhRow> rows;
  Occupancy occupancy;
  for (int i = 1; i <= joints; ++i) {
    DhRow row;
    row.alpha = i % 2 == 0 ? 0.5 * M_PI : -0.5 * M_PI;
    row.a = length;
    row.lower = -0.5 * M_PI * sub_angles;
    row.upper = 0.5 * M_PI * sub_angles;
    rows.push_back(row);
    const std::string link = "link" + std::to_string(i);
    const std::string next = i < joints ? "link" + std::to_string(i + 1) : "tool";
    const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
    occupancy.spheres.push_back({link, origin, kRadius});
    occupancy.spheroids.push_back({link, origin, next, origin, std::hypot(0.5 * length, kRadius)});
  }
  Eigen::Isometry3d T_last_tool = Eigen::Isometry3d::Identity();
  T_last_tool.translation().x() = length;
  Robot robot = Robot::from_dh(rows, T_last_tool);
  robot.set_occupancy(occupancy);
  return robot;
}

Points random_cloud(int count) {
  Random random(1);
  Points points(count, 3);
  for (int i = 0; i < count; ++i) points.row(i) = random_point(random);
  return points;
}

std::vector<ReachScene> reach_scenes(const Robot& robot, int count, int points) {
  Random random(2);
  Solver solver(robot);
  Result result;
  std::vector<ReachScene> scenes;
  while (static_cast<int>(scenes.size()) < count) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    solver.set_obstacles(Points(0, 3));
    solver.judge(robot.fk(q), q, result);
    if (!result.success) continue;  // it touches itself
    ReachScene scene{robot.fk(q), Points(points, 3)};
    for (int i = 0; i < points;) {
      scene.points.row(i) = random_point(random);
      solver.set_obstacles(scene.points.middleRows(i, 1));
      solver.judge(scene.T_base_tip, q, result);
      if (result.clearance > 0.0) ++i;
    }
    scenes.push_back(scene);
  }
  return scenes;
}

Evaluator::Evaluator(const Robot& robot_in, int points, const Options& options_in)
    : Workbench(robot_in, options_in) {
  set_obstacles(random_cloud(points));
  Random random(3);
  for (int k = 0; k < 64; ++k) {
    qs_.push_back(random_configuration(robot, random));
    omegas_.emplace_back(map.size());
    map.inverse(qs_.back(), omegas_.back());
    sub_angles_.push_back(testing::spread(map, omegas_.back()));
  }
  set_target(robot.fk(qs_.front(), robot.tips().front()));
}

}  // namespace pdoik::bench
