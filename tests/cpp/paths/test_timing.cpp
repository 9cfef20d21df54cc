#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "arms.hpp"
#include "pdoik/path.hpp"
#include "pdoik/solver.hpp"
#include "pdoik/timing.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

using Rows = TimedMotion::Rows;

/// Along a grid nothing is faster: each square is at a bound of its own, or at one of the steps
/// before and after it.
void expect_within(const Eigen::VectorXd& s, const Rows& a, const Rows& b,
                   const Eigen::VectorXd& most, const Eigen::VectorXd& x) {
  for (Eigen::Index k = 0; k < s.size(); ++k) {
    EXPECT_GE(x[k], 0.0);
    EXPECT_LE(x[k], most[k] * (1.0 + 1e-9));
    if (k + 1 == s.size()) break;
    const double u = (x[k + 1] - x[k]) / (2.0 * (s[k + 1] - s[k]));
    EXPECT_LE((a.row(k) * u + b.row(k) * x[k]).cwiseAbs().maxCoeff(), 1.0 + 1e-6) << k;
    EXPECT_LE((a.row(k + 1) * u + b.row(k + 1) * x[k + 1]).cwiseAbs().maxCoeff(), 1.0 + 1e-6) << k;
  }
}

TEST(Timing, a_straight_line_is_sped_along_and_braked_on) {
  const Eigen::Index m = 201;
  const Eigen::VectorXd s = Eigen::VectorXd::LinSpaced(m, 0.0, 2.0);
  const Rows a = Rows::Constant(m, 1, 1.0 / 3.0), b = Rows::Zero(m, 1);
  const Eigen::VectorXd free = fastest_squares(s, a, b, Eigen::VectorXd::Constant(m, 1e3));
  for (Eigen::Index k = 0; k < m; ++k)
    EXPECT_NEAR(free[k], 6.0 * std::min(s[k], 2.0 - s[k]), 1e-9) << k;
  const Eigen::VectorXd slow = fastest_squares(s, a, b, Eigen::VectorXd::Constant(m, 4.0));
  for (Eigen::Index k = 0; k < m; ++k) EXPECT_NEAR(slow[k], std::min(free[k], 4.0), 1e-9) << k;
}

TEST(Timing, squares_are_within_limits_and_none_alone_can_be_larger) {
  Random random(5);
  for (int round = 0; round < 20; ++round) {
    const Eigen::Index m = 60, n = 7;
    Eigen::VectorXd s(m), most(m);
    Rows a(m, n), b(m, n);
    s[0] = 0.0;
    for (Eigen::Index k = 0; k < m; ++k) {
      if (k > 0) s[k] = s[k - 1] + random.uniform(0.01, 0.04);
      most[k] = random.uniform(0.5, 3.0);
      for (Eigen::Index i = 0; i < n; ++i) {
        a(k, i) = std::sin(0.7 * static_cast<double>(i) + 2.0 * s[k]);
        b(k, i) = 2.0 * std::cos(0.7 * static_cast<double>(i) + 2.0 * s[k]);
      }
    }
    const Eigen::VectorXd x = fastest_squares(s, a, b, most);
    expect_within(s, a, b, most, x);
    for (Eigen::Index k = 1; k + 1 < m; ++k) {
      Eigen::VectorXd more = x;
      more[k] *= 1.001;
      double worst = more[k] / most[k];
      for (const Eigen::Index from : {k - 1, k}) {
        const double u = (more[from + 1] - more[from]) / (2.0 * (s[from + 1] - s[from]));
        for (const Eigen::Index at : {from, from + 1})
          worst = std::max(worst, (a.row(at) * u + b.row(at) * more[at]).cwiseAbs().maxCoeff());
      }
      EXPECT_GT(worst, 1.0) << k;
    }
  }
}

/// A line of the tool, and back again beside it.
Rows seam(const Robot& robot) {
  Eigen::VectorXd q(7);
  q << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.78;
  std::vector<std::vector<Goal>> stations;
  for (int k = 0; k < 40; ++k) {
    Goal& goal = stations.emplace_back(1).front();
    goal.T_base_tip = robot.fk(q);
    goal.T_base_tip.translation() +=
        Eigen::Vector3d(k < 20 ? 0.0 : 0.02, 0.01 * std::min(k, 39 - k), 0.0);
  }
  Solver solver(robot);
  PathRequest request;
  request.stations = stations;
  const PathResult path = solver.solve_path(request);
  EXPECT_EQ(path.status, PathStatus::Whole);
  return path.q;
}

TEST(Timing, a_path_is_kept_to_within_limits_from_rest_to_rest) {
  const Robot robot = Robot::builtin("panda");
  const Rows q = seam(robot);
  TimingLimits limits;
  limits.max_acceleration = Eigen::VectorXd::Constant(7, 5.0);
  limits.tool_speed = 0.05;
  TimingOptions options;
  options.rate = 1000.0;
  const TimedMotion motion = time_path(robot, q, limits, options);
  const Eigen::Index count = motion.time.size();
  ASSERT_GT(count, 1000);
  EXPECT_EQ(motion.q.row(0), q.row(0));
  EXPECT_EQ(motion.q.row(count - 1), q.row(q.rows() - 1));
  EXPECT_LE(motion.deviation, options.deviation);
  EXPECT_EQ(motion.at[0], 0.0);
  EXPECT_NEAR(motion.at[count - 1], static_cast<double>(q.rows() - 1), 1e-9);
  double fastest = 0.0;
  for (Eigen::Index k = 1; k + 1 < count; ++k) {
    const Eigen::RowVectorXd rate = (motion.q.row(k + 1) - motion.q.row(k - 1)) * 500.0;
    EXPECT_LT((rate - motion.dq.row(k)).cwiseAbs().maxCoeff(), 3e-3) << k;
    EXPECT_LE(motion.ddq.row(k).cwiseAbs().maxCoeff(), 5.0 * (1.0 + 1e-6)) << k;
    const double speed =
        (robot.jacobian(motion.q.row(k).transpose()) * motion.dq.row(k).transpose())
            .head<3>()
            .norm();
    EXPECT_LE(speed, limits.tool_speed * (1.0 + 1e-4)) << k;
    EXPECT_GE(motion.at[k], motion.at[k - 1]);
    fastest = std::max(fastest, speed);
  }
  EXPECT_GT(fastest, 0.999 * limits.tool_speed);
  // Most of the way is at that speed.
  EXPECT_LT(motion.time[count - 1], 0.4 / limits.tool_speed * 1.3);
}

TEST(Timing, the_fastest_move_of_one_joint_is_the_known_one) {
  const Robot robot = Robot::builtin("panda");
  Rows q(2, 7);
  q.row(0) = 0.5 * (robot.lower() + robot.upper()).transpose();
  q.row(1) = q.row(0);
  q(1, 1) += 1.0;
  TimingLimits limits;
  limits.max_acceleration = Eigen::VectorXd::Constant(7, 2.0);
  limits.max_speed = Eigen::VectorXd::Constant(7, 0.5);
  const TimedMotion motion = time_path(robot, q, limits);
  EXPECT_NEAR(motion.time[motion.time.size() - 1], 1.0 / 0.5 + 0.5 / 2.0, 2e-4);
}

TEST(Timing, misuse_is_named) {
  const Robot robot = Robot::builtin("panda");
  Rows q(2, 7);
  q.row(0) = 0.5 * (robot.lower() + robot.upper()).transpose();
  q.row(1) = q.row(0);
  TimingLimits limits;
  limits.max_acceleration = Eigen::VectorXd::Constant(7, 2.0);
  EXPECT_THROW(time_path(robot, q, limits), std::invalid_argument);  // no two different rows
  q(1, 0) += 0.1;
  EXPECT_NO_THROW(time_path(robot, q, limits));
  EXPECT_THROW(time_path(robot, q.leftCols(6), limits), std::invalid_argument);
  EXPECT_THROW(time_path(robot, q, TimingLimits{}), std::invalid_argument);
  TimingLimits wrong = limits;
  wrong.max_acceleration[0] = -1.0;
  EXPECT_THROW(time_path(robot, q, wrong), std::invalid_argument);
  wrong = limits;
  wrong.tool_speed = std::nan("");
  EXPECT_THROW(time_path(robot, q, wrong), std::invalid_argument);
  EXPECT_THROW(time_path(robot, q, limits, {.deviation = -1.0}), std::invalid_argument);
  EXPECT_THROW(time_path(robot, q, limits, {}, Eigen::VectorXd::Ones(3)), std::invalid_argument);
  q(0, 3) = std::nan("");
  EXPECT_THROW(time_path(robot, q, limits), std::invalid_argument);
}

}  // namespace
}  // namespace pdoik
