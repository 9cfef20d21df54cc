// KDL's ChainIkSolverPos_LMA with random restarts. It knows no limits: an attempt counts when its
// answer, each joint turned by whole turns to inside its range, holds them.
#include <algorithm>
#include <exception>
#include <kdl/chain.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <stdexcept>
#include <string>

#include "pdoik/robot.hpp"
#include "restarts.hpp"

namespace pdoik::bench {
namespace {

// Its solver stops when the norm of the weighted error, six numbers, is below eps (not its square,
// as its documentation has it): with eps the smaller tolerance, weighted, both tolerances hold.
// Both figures are chosen by hand on the targets of bench/compare.py.
constexpr double kRotationWeight = 1.0;  // metres that one radian weighs [m]
constexpr int kMaxIterations = 30;       // of one attempt

KDL::Frame to_kdl(const Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          KDL::Vector(T.translation().x(), T.translation().y(), T.translation().z())};
}

/// Each body turns about its own z: a fixed segment to the first joint, then one about z per joint
/// that ends at the next one.
KDL::Chain chain_of(const Robot& robot) {
  const auto& bodies = robot.bodies();
  const int tip = robot.tips().front();
  KDL::Chain chain;
  chain.addSegment(
      KDL::Segment("base", KDL::Joint(KDL::Joint::None), to_kdl(bodies[1].T_parent_joint)));
  for (std::size_t b = 1; b < bodies.size(); ++b) {
    const bool last = b + 1 == bodies.size();
    const Eigen::Isometry3d& next = last ? robot.T_body_link(tip) : bodies[b + 1].T_parent_joint;
    chain.addSegment(
        KDL::Segment("body" + std::to_string(b), KDL::Joint(KDL::Joint::RotZ), to_kdl(next)));
  }
  return chain;
}

Eigen::Matrix<double, 6, 1> weights() {
  Eigen::Matrix<double, 6, 1> weights;
  weights << 1.0, 1.0, 1.0, kRotationWeight, kRotationWeight, kRotationWeight;
  return weights;
}

}  // namespace
}  // namespace pdoik::bench

struct Peer {
  Peer(const pdoik::Robot& robot, double eps, double max_time)
      : lower(robot.lower()),
        upper(robot.upper()),
        chain(pdoik::bench::chain_of(robot)),
        solver(chain, pdoik::bench::weights(), eps, pdoik::bench::kMaxIterations),
        restarts(lower, upper, max_time),
        start(static_cast<unsigned>(robot.dof())),
        answer(start) {}

  bool attempt(const KDL::Frame& target, Eigen::VectorXd& q, int& iterations) {
    start.data = q;
    const int outcome = solver.CartToJnt(start, target, answer);
    iterations += solver.lastNrOfIter;
    q = answer.data;
    return outcome == KDL::SolverI::E_NOERROR && pdoik::bench::wrap_into_limits(q, lower, upper);
  }

  Eigen::VectorXd lower, upper;
  KDL::Chain chain;
  KDL::ChainIkSolverPos_LMA solver;
  pdoik::bench::Restarts restarts;
  KDL::JntArray start, answer;
};

static std::string last_error;

Peer* peer_create(const PeerSetup* setup) try {
  if (setup->axis_goal != 0) throw std::invalid_argument("KDL's LMA knows whole poses only");
  const auto robot = pdoik::Robot::from_urdf(setup->urdf_path, {}, {setup->tip_link});
  const double eps = std::min(setup->position_tolerance,
                              pdoik::bench::kRotationWeight * setup->rotation_tolerance);
  return new Peer(robot, eps, setup->max_time);
} catch (const std::exception& error) {
  last_error = error.what();
  return nullptr;
}

void peer_destroy(Peer* peer) { delete peer; }

const char* peer_error() { return last_error.c_str(); }

int peer_solve(Peer* peer, const PeerProblem* problem, PeerAnswer* answer) {
  using pdoik::bench::Stopwatch;
  if (problem->obstacle_count > 0) return -1;
  Eigen::Isometry3d T;
  T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(problem->T_base_tip);
  const KDL::Frame target = pdoik::bench::to_kdl(T);
  peer->restarts.run(*problem, *answer, [&](Eigen::VectorXd& q, const Stopwatch&, int& iterations) {
    return peer->attempt(target, q, iterations);
  });
  return 0;
}
