// A program for a robot's computer, where Eigen may be all there is: an arm from its DH table and a
// solver, of pdoik::core alone.
#include <iostream>
#include <pdoik/pdoik.hpp>

int main() {
  constexpr double kHalfPi = 1.5707963267948966;
  const pdoik::Robot robot =
      pdoik::Robot::from_dh({{.d = 0.3, .lower = -2.8, .upper = 2.8},
                             {.alpha = -kHalfPi, .lower = -2.0, .upper = 2.0},
                             {.alpha = kHalfPi, .d = 0.4, .lower = -2.8, .upper = 2.8},
                             {.alpha = -kHalfPi, .lower = -2.3, .upper = 2.3},
                             {.alpha = kHalfPi, .d = 0.35, .lower = -2.8, .upper = 2.8},
                             {.alpha = -kHalfPi, .lower = -2.0, .upper = 2.0}},
                            Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.0, 0.0)));
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(robot.dof(), 0.7);
  pdoik::Solver solver(robot, pdoik::Options{});
  const pdoik::Result result = solver.solve(robot.fk(q));
  const double error = (robot.fk(result.q).translation() - robot.fk(q).translation()).norm();
  std::cout << robot.name() << ": " << pdoik::to_string(result.status) << ", " << error
            << " m off\n";
  return result.success && error < 1e-3 ? 0 : 1;
}
