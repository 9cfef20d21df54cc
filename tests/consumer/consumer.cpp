// A program that uses the library and nothing else of this tree. Vectors made on one side are
// resized and freed on the other, PCL included, and Eigen works for itself beside it: all three
// must agree on how memory is aligned and allocated.
#include <Eigen/Dense>
#include <iostream>
#include <pdoik/pdoik.hpp>

// Large enough for Eigen to copy blocks of it to the heap.
double residual_of_a_large_product() {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(400, 400);
  const Eigen::MatrixXd normal = a * a.transpose() + Eigen::MatrixXd::Identity(400, 400);
  const Eigen::VectorXd x = Eigen::VectorXd::Random(400);
  return (normal.llt().solve(normal * x) - x).norm();
}

int main() {
  const pdoik::Points scan =  // beyond the arm
      pdoik::Points::Random(2000, 3) + pdoik::Points::Constant(2000, 3, 2.0);
  const pdoik::Points cloud = pdoik::voxel_downsample(scan, 0.2);
  const pdoik::Robot robot = pdoik::Robot::builtin("panda");
  pdoik::Solver solver(robot, pdoik::Options{});
  solver.set_obstacles(cloud);
  pdoik::Result result;
  bool solved = true;
  for (int k = 0; k < 20; ++k) {
    result.q.resize(k % 9);
    result = solver.solve(robot.fk(robot.mid_configuration()));
    solved = solved && result.success;
  }
  const double residual = residual_of_a_large_product();
  std::cout << robot.name() << ": " << (solved ? "solved" : "not solved") << " among "
            << cloud.rows() << " of " << scan.rows() << " points; Eigen aligns to "
            << EIGEN_MAX_ALIGN_BYTES << " bytes, a residual of " << residual << '\n';
  return solved && cloud.rows() > 0 && cloud.rows() < scan.rows() && residual < 1e-6 ? 0 : 1;
}
