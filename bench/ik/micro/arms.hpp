#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "pdoik/pdoik.hpp"
#include "workbench.hpp"

/// What the microbenchmarks are run on. Everything random has a fixed seed.
namespace pdoik::bench {

inline constexpr std::array kArms{"panda", "ur10", "iiwa14"};

/// A zigzag of equal links, 1.2 m in all, whose joints turn by `sub_angles` times 180 degrees, with
/// one sphere and one spheroid per joint as in the paper: M' = joints * sub_angles.
Robot zigzag_arm(int joints, int sub_angles);

/// `count` points, uniform in the box where the paper puts obstacles: [-0.6, 0.6]^2 x [0, 1.2] m.
Points random_cloud(int count);

/// A target that can be reached, and obstacle points that leave the configuration which defines it
/// clear.
struct ReachScene {
  Eigen::Isometry3d T_base_tip;
  Points points;
};
/// Poses of random configurations that touch neither themselves nor the points.
std::vector<ReachScene> reach_scenes(const Robot& robot, int count, int points);

/// The parts of one evaluation, wired as the solver wires them, among random points.
class Evaluator : public testing::Workbench {
 public:
  Evaluator(const Robot& robot, int points, const Options& options = {});

  /// Another random configuration each time, as positions, as slack, and as slack of the paper's M'
  /// sub-angles.
  const Eigen::VectorXd& next_q() { return qs_[turn_++ % qs_.size()]; }
  const Eigen::VectorXd& next_omega() { return omegas_[turn_++ % omegas_.size()]; }
  const Eigen::VectorXd& next_sub_angles() { return sub_angles_[turn_++ % sub_angles_.size()]; }

 private:
  std::vector<Eigen::VectorXd> qs_, omegas_, sub_angles_;
  std::size_t turn_ = 0;
};

}  // namespace pdoik::bench
