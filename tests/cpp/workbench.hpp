#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "detail/collision.hpp"
#include "detail/constraint.hpp"
#include "detail/goal_term.hpp"
#include "detail/lagrangian_problem.hpp"
#include "detail/least_squares_problem.hpp"
#include "detail/rollout.hpp"
#include "detail/scene.hpp"
#include "detail/spheroid_distance.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "random_robots.hpp"

/// The solver's parts put together as solvers do, each within a test's reach, and what they
/// compute once more in plain loops over Robot::fk.
namespace pdoik::testing {

using ObstacleMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class Workbench {
 public:
  Workbench(const Robot& robot_in, const Options& options_in,
            JointLimitMap::Slack slack = JointLimitMap::Slack::PerSubAngle)
      : model(robot_in, options_in),
        robot(model.robot),
        options(model.options),
        hulls(model.hulls),
        scene(model),
        moving(hulls, hulls.moving),
        fixed(hulls, hulls.fixed),
        own(robot, options),
        rollout(robot),
        map(robot, slack),
        lagrangian(map, rollout, goals, moving, own, scene, options.point_distance, robot.dof()),
        least_squares(rollout, goals, moving, own, scene, options, robot.dof()) {
    Goal goal;
    goal.type = options.goal;
    goal.axis = options.goal_axis;
    goals.emplace_back(robot, goal);
    set_obstacles(ObstacleMatrix(0, 3));
  }
  Workbench(const Workbench&) = delete;

  void set_obstacles(const ObstacleMatrix& points) {
    obstacles = points;
    scene.assign(points);
    scene.read();
    moving.reserve(scene.obstacles()->padded());
    lagrangian.reserve(scene.obstacles()->padded());
    lagrangian.use(scene);
    least_squares.reserve(scene.obstacles()->padded());
    least_squares.use(scene);
  }
  void set_target(const Eigen::Isometry3d& T) {
    target = T;
    goals.front().set_target(T);
  }
  void set_goals(const std::vector<Goal>& asked) {
    goals.clear();
    for (const Goal& goal : asked) goals.emplace_back(robot, goal);
  }
  void roll_out(const Eigen::VectorXd& q) {
    const Eigen::VectorXd cosine = q.array().cos(), sine = q.array().sin();
    rollout.forward(cosine.data(), sine.data(), q.data());
    moving.place(rollout);
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
  detail::CollisionState moving, fixed;
  detail::OwnConstraints own;
  detail::Rollout rollout;
  std::vector<detail::GoalTerm> goals;
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
