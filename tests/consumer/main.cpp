// A program that uses the installed library and nothing else of this tree.
#include <iostream>
#include <pdoik/pdoik.hpp>

int main() {
  const pdoik::Robot robot = pdoik::Robot::builtin("panda");
  pdoik::Solver solver(robot, pdoik::Options{});
  const pdoik::Result result = solver.solve(robot.fk(robot.mid_configuration()));
  std::cout << robot.name() << ": " << (result.success ? "solved" : "not solved") << '\n';
  return result.success ? 0 : 1;
}
