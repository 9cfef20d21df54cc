#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "hulls/spheroid_distance.hpp"
#include "obstacles/clearance.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "problem/lagrangian_problem.hpp"
#include "problem/least_squares_problem.hpp"
#include "problem/problem.hpp"
#include "random_robots.hpp"

/// The solver's parts put together as solvers do, each within a test's reach, and what they
/// compute once more in plain loops over Robot::fk.
namespace pdoik::testing {

using ObstacleMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Workbench {
 public:
  Workbench(const Robot& robot_in, const Options& options_in)
      : model(robot_in, options_in),
        robot(model.robot),
        options(model.options),
        hulls(model.hulls),
        scene(robot, hulls, options),
        problem(model, scene),
        moving(problem.constraints.hulls),
        fixed(hulls, hulls.fixed),
        map(robot),
        lagrangian(map, problem),
        least_squares(problem) {
    Goal goal;
    goal.type = options.goal;
    goal.axis = options.goal_axis;
    problem.goals.emplace_back(robot, options, goal);
    set_obstacles(ObstacleMatrix(0, 3));
  }
  Workbench(const Workbench&) = delete;

  void set_obstacles(const ObstacleMatrix& points) {
    obstacles = points;
    scene.assign(points);
    scene.read();
    moving.reserve(scene.obstacles()->padded());
    lagrangian.reserve(scene.obstacles()->padded());
    lagrangian.reset_multipliers();
    least_squares.reserve(scene.obstacles()->padded());
    least_squares.count_all_obstacles();
  }
  void set_target(const Eigen::Isometry3d& T) {
    target = T;
    problem.goals.front().set_target(T);
  }
  void roll_out(const Eigen::VectorXd& q) {
    const Eigen::VectorXd cosine = q.array().cos(), sine = q.array().sin();
    problem.rollout.forward(cosine.data(), sine.data(), q.data());
    moving.place(problem.rollout);
  }
  /// The least of all hulls, the margin included, where they are placed.
  detail::Clearance clearance() {
    const detail::Clearance least = least_clearance(moving, scene.obstacles(), {});
    return least_clearance(fixed, scene.obstacles(), least);
  }
  Eigen::VectorXd positions(const Eigen::VectorXd& omega) const {
    Eigen::VectorXd q(robot.dof());
    map.positions(omega, q);
    return q;
  }

  detail::Model model;
  const Robot& robot;
  const Options& options;
  const detail::HullModel& hulls;
  ObstacleMatrix obstacles;
  Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
  detail::Scene scene;
  detail::Problem problem;
  detail::CollisionState &moving, fixed;
  JointLimitMap map;
  detail::LagrangianProblem lagrangian;
  detail::LeastSquaresProblem least_squares;
};

/// Eqs. joint_coll_avoid and link_coll_avoid for every hull (spheres first) and obstacle, shape
/// (hulls, N).
inline Eigen::MatrixXd paper_constraints(const Robot& robot, const Eigen::VectorXd& q,
                                         const ObstacleMatrix& obstacles, double margin = 0.0) {
  const Occupancy& occupancy = robot.occupancy();
  Eigen::MatrixXd c(static_cast<Eigen::Index>(occupancy.size()), obstacles.rows());
  for (Eigen::Index j = 0; j < obstacles.rows(); ++j) {
    const Eigen::Vector3d o = obstacles.row(j).head<3>().transpose();
    const double radius = margin + (obstacles.cols() > 3 ? obstacles(j, 3) : 0.0);
    Eigen::Index i = 0;
    for (const Sphere& s : occupancy.spheres) {
      c(i++, j) = s.radius + radius - (robot.fk(q, s.link) * s.center - o).norm();
    }
    for (const Spheroid& s : occupancy.spheroids) {
      const Eigen::Vector3d a = robot.fk(q, s.link_a) * s.focus_a,
                            b = robot.fk(q, s.link_b) * s.focus_b;
      c(i++, j) = 2.0 * (s.semi_major + radius) - (a - o).norm() - (b - o).norm();
    }
  }
  return c;
}

/// Which hulls some joint moves, by trying: one entry per hull, spheres first.
inline std::vector<bool> hulls_that_move(const Robot& robot) {
  std::vector<bool> moves(robot.occupancy().size(), false);
  Random random(12345);
  const Eigen::VectorXd q0 = random_configuration(robot, random);
  for (int k = 0; k < 5; ++k) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    const auto moved_by = [&](const std::string& link, const Eigen::Vector3d& p) {
      return (robot.fk(q, link) * p - robot.fk(q0, link) * p).norm() > 1e-9;
    };
    std::size_t i = 0;
    for (const Sphere& s : robot.occupancy().spheres) {
      if (moved_by(s.link, s.center)) moves[i] = true;
      ++i;
    }
    for (const Spheroid& s : robot.occupancy().spheroids) {
      if (moved_by(s.link_a, s.focus_a) || moved_by(s.link_b, s.focus_b)) moves[i] = true;
      ++i;
    }
  }
  return moves;
}

}  // namespace pdoik::testing
