// The README's C++ example inside a program: it must compile, link and solve.
// tests/python/test_readme.py sees to it that the two are the same lines.
#include <iostream>
#include <pdoik/pdoik.hpp>

int main() {
  const Eigen::VectorXd q0 = pdoik::Robot::builtin("panda").mid_configuration();
  const Eigen::Isometry3d T_base_tip = pdoik::Robot::builtin("panda").fk(q0);
  const pdoik::Points points = pdoik::Points::Constant(5, 3, 0.9);

  pdoik::Robot robot = pdoik::Robot::builtin("panda");
  pdoik::Solver solver(robot, {.max_time = 0.001});  // all memory is taken here
  solver.set_obstacles(points);                      // (N, 3) or (N, 4), row-major, read in place
  pdoik::Result result;
  solver.solve(T_base_tip, &q0, result);  // allocates nothing from the second call on

  std::cout << "README: " << pdoik::to_string(result.status) << '\n';
  return result.success ? 0 : 1;
}
