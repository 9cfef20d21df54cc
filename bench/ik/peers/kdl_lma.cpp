// KDL's ChainIkSolverPos_LMA with random restarts. It knows no limits: an attempt counts when its
// answer, each joint turned by whole turns to inside its range, holds them and the hulls are clear
// of the obstacles, which it does not know either: MoveIt hands such a check to its kinematics
// plugins.
#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "interface.hpp"
#include "obstacle_check.hpp"
#include "pdoik/robot.hpp"
#include "restarts.hpp"

namespace pdoik::bench {
namespace {

// Its solver stops when the norm of the weighted error, six numbers, is below eps (not its square,
// as its documentation has it): with eps the smaller tolerance, weighted, both tolerances hold.
// Both figures are chosen by hand on the targets of bench/ik/compare/__main__.py.
constexpr double kRotationWeight = 1.0;  // metres that one radian counts as [m]
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

class KdlLma : public Peer {
 public:
  KdlLma(const Robot& robot, const PeerSetup& setup)
      : lower(robot.lower()),
        upper(robot.upper()),
        chain(chain_of(robot)),
        solver(chain, weights(), eps(setup), kMaxIterations),
        kinematics(chain),
        frames(chain.getNrOfSegments()),
        check(setup.occupancy_yaml,
              [&robot](const std::string& link) { return carrier(robot, link); }),
        restarts(lower, upper, setup),
        start(static_cast<unsigned>(robot.dof())),
        result(start) {}

  bool solve(const PeerProblem& problem, PeerAnswer& answer) override {
    Eigen::Isometry3d T;
    T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(problem.T_base_tip);
    const KDL::Frame target = to_kdl(T);
    restarts.run(
        problem, answer, [&] { check.set_points(problem); },
        [&](Eigen::VectorXd& q, const Stopwatch&, PeerAnswer& count) {
          return attempt(target, q, count) && (problem.obstacle_count == 0 || is_clear());
        });
    return true;
  }

 private:
  static double eps(const PeerSetup& setup) {
    return std::min(setup.position_tolerance, kRotationWeight * setup.rotation_tolerance);
  }

  /// Segment b ends at the joint after body b.
  static ObstacleCheck::Carrier carrier(const Robot& robot, const std::string& name) {
    const int link = robot.link_index(name);
    const auto body = static_cast<std::size_t>(robot.body_of_link(link));
    const bool last = body + 1 == robot.bodies().size();
    const Eigen::Isometry3d& T_body_end =
        last ? robot.T_body_link(robot.tips().front()) : robot.bodies()[body + 1].T_parent_joint;
    return {static_cast<int>(body), T_body_end.inverse() * robot.T_body_link(link)};
  }

  bool attempt(const KDL::Frame& target, Eigen::VectorXd& q, PeerAnswer& count) {
    start.data = q;
    const int outcome = solver.CartToJnt(start, target, result);
    count.iterations += solver.lastNrOfIter;
    count.evaluations += solver.lastNrOfIter + 1;
    q = result.data;
    return outcome == KDL::SolverI::E_NOERROR && wrap_into_limits(q, lower, upper);
  }

  /// Of obstacles, at the last result: whole turns do not matter.
  bool is_clear() {
    kinematics.JntToCart(result, frames);
    return !check.touches([this](int segment, const Eigen::Vector3d& local) {
      const KDL::Vector p =
          frames[static_cast<std::size_t>(segment)] * KDL::Vector(local.x(), local.y(), local.z());
      return Eigen::Vector3d(p.x(), p.y(), p.z());
    });
  }

  Eigen::VectorXd lower, upper;
  KDL::Chain chain;
  KDL::ChainIkSolverPos_LMA solver;
  KDL::ChainFkSolverPos_recursive kinematics;
  std::vector<KDL::Frame> frames;
  ObstacleCheck check;
  Restarts restarts;
  KDL::JntArray start, result;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const PeerSetup& setup) {
  if (setup.axis_goal != 0) throw std::invalid_argument("KDL's LMA knows whole poses only");
  return std::make_unique<KdlLma>(Robot::from_urdf(setup.urdf_path, {}, {setup.tip_link}), setup);
}

}  // namespace pdoik::bench
