// A tip that follows a moving target once a millisecond, while another thread tells what
// the camera sees. The robot is told in numbers: pdoik::core reads no files.
#include <chrono>
#include <cmath>
#include <iostream>
#include <pdoik/pdoik.hpp>
#include <thread>

/// An arm of six joints from its Denavit-Hartenberg table, with hulls around its two long links.
pdoik::Robot arm() {
  constexpr double kQuarter = 1.5707963267948966;
  pdoik::Robot robot =
      pdoik::Robot::from_dh({{.d = 0.3, .lower = -2.8, .upper = 2.8},
                             {.alpha = -kQuarter, .lower = -2.0, .upper = 2.0},
                             {.alpha = kQuarter, .d = 0.4, .lower = -2.8, .upper = 2.8},
                             {.alpha = -kQuarter, .lower = -2.3, .upper = 2.3},
                             {.alpha = kQuarter, .d = 0.35, .lower = -2.8, .upper = 2.8},
                             {.alpha = -kQuarter, .lower = -2.0, .upper = 2.0}},
                            Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.0)));
  robot.set_occupancy({.capsules = {{.link = "link3", .a = {0.0, 0.0, -0.4}, .radius = 0.06},
                                    {.link = "link5", .a = {0.0, 0.0, -0.35}, .radius = 0.05}}});
  return robot;
}

int main() {
  const pdoik::Robot robot = arm();
  const Eigen::VectorXd start = Eigen::VectorXd::Constant(robot.dof(), 0.5);
  pdoik::Cloud cloud;

  std::jthread camera([&](const std::stop_token& stop) {
    const Eigen::AlignedBox3d seen(Eigen::Vector3d(-2, -2, -2), Eigen::Vector3d(2, 2, 2));
    while (!stop.stop_requested()) {
      const Eigen::MatrixX3d points = Eigen::MatrixX3d::Random(500, 3) * 0.2;
      const pdoik::Points shelf = points.rowwise() + Eigen::RowVector3d(-0.8, 0.0, 0.4);
      cloud.update(shelf, seen);  // waits for a step that has begun
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
  });

  pdoik::Tracker tracker(
      robot, {.goal = pdoik::GoalType::Position},
      {.period = 0.001, .max_speed = Eigen::VectorXd::Constant(robot.dof(), 2.0)});
  tracker.set_obstacles(cloud);
  tracker.reset(start);  // what the encoders say

  int followed = 0;
  auto next = std::chrono::steady_clock::now();
  for (int k = 0; k < 300; ++k) {
    const double angle = 0.5 + 0.1 * std::sin(0.02 * k);
    const pdoik::TrackerResult& step =  // throws nothing, allocates nothing
        tracker.step(robot.fk(Eigen::VectorXd::Constant(robot.dof(), angle)));
    if (step.tracking == pdoik::TrackerStatus::InvalidInput) {
      std::cerr << "refused: " << step.complaint << "\n";
      return 1;
    }
    followed += step.tracking == pdoik::TrackerStatus::Tracking ? 1 : 0;
    // step.q goes to the motors, whatever became of the step: it is never a jump.
    std::this_thread::sleep_until(next += std::chrono::milliseconds(1));
  }
  std::cout << followed << " of 300 steps on the target, the slowest "
            << 1e3 * tracker.latency().max() << " ms\n";
}
