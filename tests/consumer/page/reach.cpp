// reach [ROBOT.urdf]: puts an arm's tip on a pose beside a wall that a camera saw,
// or says why not.
#include <iostream>
#include <numbers>
#include <pdoik/pdoik.hpp>

/// A point every 2 cm of a wall before the arm, (N, 3) [m], base frame.
pdoik::Points scan_of_a_wall() {
  pdoik::Points points(60 * 60, 3);
  for (int i = 0; i < points.rows(); ++i)
    points.row(i) << 0.7, 0.02 * (i % 60) - 0.6, 0.02 * (i / 60);
  return points;
}

int main(int argc, char** argv) try {
  const pdoik::Robot robot =
      argc > 1 ? pdoik::Robot::from_urdf(argv[1]) : pdoik::Robot::builtin("panda");
  pdoik::Solver solver(robot, {.clearance = 0.02, .max_time = 0.1});

  // One point is kept per cell of 5 cm, with a ball that holds those it stands for.
  const pdoik::Points scan = scan_of_a_wall();
  const pdoik::Points kept = pdoik::voxel_downsample(scan, 0.05);
  pdoik::Balls balls(kept.rows(), 4);
  balls << kept, pdoik::covering_radii(scan, kept, 0.05);
  solver.set_obstacles(balls);

  Eigen::Isometry3d T_base_tip(Eigen::Translation3d(0.4, 0.1, 0.5));
  T_base_tip.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));

  const pdoik::Result result = solver.solve(T_base_tip);
  std::cout << pdoik::to_string(result.status) << ", q = " << result.q.transpose() << "\n"
            << result.position_error << " m and " << result.rotation_error << " rad off, "
            << result.clearance << " m from the wall\n"
            << "tightest: " << solver.describe(result.worst) << "\n";
  return result.success ? 0 : 1;
} catch (const std::exception& error) {  // LoadError, std::invalid_argument
  std::cerr << "error: " << error.what() << "\n";
  return 2;
}
