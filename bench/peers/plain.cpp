// bench/plain_paper, Algorithm IK as printed, from one start. Its success is for Solver::judge to
// say.
#include <exception>
#include <string>

#include "../plain_paper.hpp"
#include "peer.h"

struct Peer {
  Peer(const pdoik::Robot& robot_in, const pdoik::Options& options)
      : robot(robot_in), plain(robot, options) {
    result.q.setZero(robot.dof());
  }

  pdoik::Robot robot;
  pdoik::bench::PlainPaper plain;
  pdoik::Result result;
};

static std::string last_error;

Peer* peer_create(const PeerSetup* setup) try {
  auto robot = pdoik::Robot::from_urdf(setup->urdf_path, {}, {setup->tip_link});
  if (setup->occupancy_yaml != nullptr)
    robot.set_occupancy(pdoik::load_occupancy(setup->occupancy_yaml));
  pdoik::Options options;
  options.goal = setup->axis_goal != 0 ? pdoik::GoalType::Axis : pdoik::GoalType::Pose;
  options.position_tolerance = setup->position_tolerance;
  options.rotation_tolerance = setup->rotation_tolerance;
  options.clearance_tolerance = options.augmented_lagrangian.constraint_tolerance =
      setup->clearance_tolerance;
  options.max_time = setup->max_time;
  return new Peer(robot, options);
} catch (const std::exception& error) {
  last_error = error.what();
  return nullptr;
}

void peer_destroy(Peer* peer) { delete peer; }

const char* peer_error() { return last_error.c_str(); }

int peer_solve(Peer* peer, const PeerProblem* problem, PeerAnswer* answer) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  Eigen::Isometry3d T;
  T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(problem->T_base_tip);
  const Eigen::Index count = problem->obstacles != nullptr ? problem->obstacle_count : 0;
  peer->plain.set_obstacles(Eigen::Map<const RowMajor>(problem->obstacles, count, 3));
  pdoik::Result& result = peer->result;
  if (problem->q0 != nullptr) {
    const Eigen::VectorXd q0 = Eigen::Map<const Eigen::VectorXd>(problem->q0, result.q.size());
    peer->plain.solve(T, &q0, result);
  } else {
    peer->plain.solve(T, nullptr, result);
  }
  Eigen::Map<Eigen::VectorXd>(answer->q, result.q.size()) = result.q;
  answer->time = result.time;
  answer->success = 0;
  answer->iterations = result.iterations;
  answer->restarts = 0;
  return 0;
}
