// seam: an arm draws its tool along a line beside a post, at a constant speed.
#include <iostream>
#include <pdoik/pdoik.hpp>
#include <vector>

int main() try {
  const pdoik::Robot robot = pdoik::Robot::builtin("panda");
  pdoik::Solver solver(robot, {.self_collision = true});
  const Eigen::Isometry3d post(Eigen::Translation3d(0.55, 0.35, 0.3));
  solver.set_shapes(pdoik::Shapes({pdoik::Shape::box("post", post, {0.05, 0.05, 0.6})}));

  // A station each centimetre, the tool down and free to turn about its axis.
  std::vector<std::vector<pdoik::Goal>> stations;
  for (int k = 0; k < 40; ++k) {
    pdoik::Goal& goal = stations.emplace_back(1).front();
    goal.T_base_tip = Eigen::Translation3d(0.45, 0.01 * k - 0.2, 0.4) *
                      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX());
    goal.type = pdoik::GoalType::Axis;
    goal.axis = Eigen::Vector3d::UnitZ();
  }
  pdoik::PathRequest request;
  request.stations = stations;
  const pdoik::PathResult path = solver.solve_path(request);
  if (path.status != pdoik::PathStatus::Whole) {
    std::cerr << solver.explain(request, path) << "\n";
    return 1;
  }

  const pdoik::TimingLimits limits{.max_acceleration = Eigen::VectorXd::Constant(robot.dof(), 5.0),
                                   .tool_speed = 0.1};
  const pdoik::TimedMotion motion =
      pdoik::time_path(robot, path.q, limits, {.rate = 1000.0}, path.at);
  std::cout << path.q.rows() << " rows, " << motion.time[motion.time.size() - 1] << " s, "
            << motion.time.size() << " samples of q, dq and ddq\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << "\n";
  return 1;
}
