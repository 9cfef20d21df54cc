// Algorithm IK as printed, from one start. Its success is for Solver::judge to
// say.
#include "interface.hpp"
#include "plain_paper.hpp"

namespace pdoik::bench {
namespace {

class Plain : public Peer {
 public:
  Plain(const Robot& robot_in, const Options& options) : robot(robot_in), plain(robot, options) {
    result.q.setZero(robot.dof());
  }

  bool solve(const PeerProblem& problem, PeerAnswer& answer) override {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Eigen::Index count = problem.obstacles != nullptr ? problem.obstacle_count : 0;
    if (count > 0 && problem.obstacle_columns != 3) return false;
    Eigen::Isometry3d T;
    T.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(problem.T_base_tip);
    plain.set_obstacles(Eigen::Map<const RowMajor>(problem.obstacles, count, 3));
    if (problem.q0 != nullptr) {
      const Eigen::VectorXd q0 = Eigen::Map<const Eigen::VectorXd>(problem.q0, result.q.size());
      plain.solve(T, &q0, result);
    } else {
      plain.solve(T, nullptr, result);
    }
    Eigen::Map<Eigen::VectorXd>(answer.q, result.q.size()) = result.q;
    answer.time = result.time;
    answer.success = 0;
    answer.iterations = result.iterations;
    answer.evaluations = result.evaluations;
    answer.restarts = 0;
    return true;
  }

 private:
  Robot robot;
  testing::PlainPaper plain;
  Result result;
};

}  // namespace

std::unique_ptr<Peer> make_peer(const PeerSetup& setup) {
  auto robot = Robot::from_urdf(setup.urdf_path, {}, {setup.tip_link});
  if (setup.occupancy_yaml != nullptr) robot.set_occupancy(load_occupancy(setup.occupancy_yaml));
  Options options;
  options.goal = setup.axis_goal != 0 ? GoalType::Axis : GoalType::Pose;
  options.position_tolerance = setup.position_tolerance;
  options.rotation_tolerance = setup.rotation_tolerance;
  options.clearance_tolerance = options.augmented_lagrangian.constraint_tolerance =
      setup.clearance_tolerance;
  options.max_time = setup.max_time;
  return std::make_unique<Plain>(robot, options);
}

}  // namespace pdoik::bench
