// The README's C++ example inside a program: it must compile, link and solve.
// tests/python/package/test_readme.py sees to it that the two are the same lines.
#include <iostream>
#include <pdoik/pdoik.hpp>

int main() {
  const Eigen::VectorXd q0 = pdoik::Robot::builtin("panda").mid_configuration();
  const Eigen::Isometry3d T_base_tip = pdoik::Robot::builtin("panda").fk(q0);
  const pdoik::Points points = pdoik::Points::Constant(5, 3, 0.9), seen = points.topRows(2);
  const Eigen::AlignedBox3d region(Eigen::Vector3d(0.8, 0.8, 0.8), Eigen::Vector3d(1.0, 1.0, 1.0));
  const std::vector<Eigen::Isometry3d> targets(20, T_base_tip);

  pdoik::Robot robot = pdoik::Robot::builtin("panda");
  pdoik::Solver solver(robot, {.max_time = 0.001});  // all memory is taken here
  solver.set_obstacles(points);                      // (N, 3) or (N, 4), row-major
  pdoik::Result result;
  solver.solve(T_base_tip, &q0, result);  // allocates nothing from the second call on

  pdoik::Cloud cloud(points);   // taken in once, shared by solvers and threads
  solver.set_obstacles(cloud);  // a handle: updates of the cloud show in the next solve
  cloud.update(seen, region);   // while others solve: neither waits
  const auto results = solver.solve_batch(targets);  // all processors, by threads that last

  std::cout << "README: " << pdoik::to_string(result.status) << ", " << cloud.size() << " points\n";
  return result.success && results.back().success && cloud.size() == 2 ? 0 : 1;
}
