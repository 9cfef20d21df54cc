#include <gtest/gtest.h>

#include "finite_differences.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "random_robots.hpp"
#include "sub_angles.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Robot one_joint(double lower, double upper, bool prismatic = false) {
  return Robot::from_dh({DhRow{.lower = lower, .upper = upper, .prismatic = prismatic}});
}

/// What the rounding of NOTES item 3 cuts off a range that exceeds whole half turns by a hair.
double cut(const Robot& robot) {
  const double range = robot.upper()[0] - robot.lower()[0];
  const bool prismatic = robot.joint_types()[0] == JointType::Prismatic;
  return prismatic ? 0.0 : std::max(0.0, range - M_PI * std::ceil(range / M_PI - 1e-9));
}

/// Rounding of an angle near the upper end of its range, where 2 - L cancels unless sub-angles are
/// exact half turns.
double end_rounding(const Robot& robot) {
  const double range = robot.upper()[0] - robot.lower()[0];
  const double cosine = std::cos(0.5 * range / std::max(1.0, std::ceil(range / M_PI - 1e-9)));
  const bool exact = robot.joint_types()[0] == JointType::Prismatic || cosine < 1e-9;
  return 1e-15 * (std::abs(robot.lower()[0]) + std::abs(robot.upper()[0])) +
         (exact ? 0.0 : 1e-15 / cosine);
}

double position(const JointLimitMap& map, const Eigen::VectorXd& omega, int dof = 1) {
  Eigen::VectorXd q(dof);
  map.positions(omega, q);
  return q[0];
}

/// Ranges from a hair to two turns, among them those where the number of sub-angles changes.
std::vector<std::pair<double, double>> ranges() {
  std::vector<std::pair<double, double>> all;
  for (const double range :
       {1e-9, 1e-4, 0.01, 1.0, 3.0, M_PI - 1e-4, M_PI - 1e-8, M_PI - 2e-9, M_PI, M_PI + 1e-9,
        M_PI + 1e-6, 4.0, 2.0 * M_PI, 6.5, 3.0 * M_PI, 4.0 * M_PI, 2 * 6.28318530718, 20.0}) {
    for (const double lower : {-range / 2.0, 0.0, -3.0, 1.5})
      all.emplace_back(lower, lower + range);
  }
  return all;
}

template <class Check>
void for_ranges(Check&& check) {
  for (const auto& [lower, upper] : ranges()) {
    for (const bool prismatic : {false, true}) {
      SCOPED_TRACE((prismatic ? "prismatic [" : "revolute [") + std::to_string(lower) + ", " +
                   std::to_string(upper) +
                   "], range - pi = " + std::to_string((upper - lower - M_PI) * 1e9) + "e-9");
      check(one_joint(lower, upper, prismatic), lower, upper);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(JointLimitMap, inverse_then_forward_gives_q_back) {
  Random random(1);
  for_ranges([&](const Robot& robot, double lower, double upper) {
    const JointLimitMap map(robot);
    Eigen::VectorXd omega(map.size()), q(1), back(1);
    for (int k = 0; k <= 40; ++k) {
      const double fraction = k == 0 ? 0.011 : k == 40 ? 0.989 : random.uniform(0.011, 0.989);
      q[0] = lower + fraction * (upper - lower);
      map.inverse(q, omega);
      map.positions(omega, back);
      ASSERT_NEAR(back[0], q[0], 1e-14 * (std::abs(lower) + std::abs(upper)) + cut(robot));
    }
  });
}

TEST(JointLimitMap, a_start_on_or_outside_a_limit_is_moved_inside_by_the_inset) {
  for_ranges([&](const Robot& robot, double lower, double upper) {
    const JointLimitMap map(robot);
    const double range = upper - lower;
    Eigen::VectorXd omega(map.size());
    for (const double inset : {1e-6, 0.01, 0.2}) {
      for (const double beyond : {0.0, 1e-9, 0.5, 1e6}) {
        map.inverse(Eigen::VectorXd::Constant(1, lower - beyond), omega, inset);
        ASSERT_NEAR(position(map, omega), lower + inset * range,
                    1e-13 * (range + std::abs(lower)) + cut(robot));
        map.inverse(Eigen::VectorXd::Constant(1, upper + beyond), omega, inset);
        ASSERT_NEAR(position(map, omega), upper - inset * range,
                    100.0 * end_rounding(robot) + cut(robot));
        JointLimitMap::State state = map.make_state();
        map.forward(omega, state, true);
        ASSERT_GT(state.slope.minCoeff(), 0.0);
      }
    }
  });
}

TEST(JointLimitMap, slope_is_the_central_difference_of_the_angle_recovered) {
  Random random(2);
  for_ranges([&](const Robot& robot, double lower, double upper) {
    const JointLimitMap map(robot);
    JointLimitMap::State state = map.make_state();
    const auto recovered = [&](const Eigen::VectorXd& omega) { return position(map, omega); };
    for (int k = 0; k < 30; ++k) {
      const Eigen::VectorXd omega = random.vector(map.size(), -8.0, 8.0);
      map.forward(omega, state, true);
      const Eigen::VectorXd difference = central_gradient(recovered, omega, 1e-4);
      const double rounding = 1e-15 * (std::abs(lower) + std::abs(upper)) / 1e-4;
      ASSERT_LT((state.slope - difference).cwiseAbs().maxCoeff(),
                1e-8 * (upper - lower) + 4.0 * rounding);
    }
  });
}

TEST(JointLimitMap, slope_at_saturated_slack_is_finite_and_still_the_central_difference) {
  for_ranges([&](const Robot& robot, double, double) {
    const JointLimitMap map(robot);
    JointLimitMap::State state = map.make_state();
    for (const double saturated : {20.0, 36.0, 37.0, 40.0, 100.0, 700.0, 1000.0, 1e300}) {
      for (const double sign : {1.0, -1.0}) {
        const Eigen::VectorXd omega = Eigen::VectorXd::Constant(map.size(), sign * saturated);
        map.forward(omega, state, true);
        ASSERT_TRUE(state.slope.allFinite() && state.q.allFinite()) << sign * saturated;
        EXPECT_GE(state.slope.minCoeff(), 0.0);
        if (saturated > 50.0) continue;
        const auto recovered = [&](const Eigen::VectorXd& at) { return position(map, at); };
        const double h = 0.01;
        const Eigen::VectorXd difference = central_gradient(recovered, omega, h);
        const double rounding = end_rounding(robot) / h;
        ASSERT_LT((state.slope - difference).cwiseAbs().maxCoeff(),
                  2e-5 * state.slope.maxCoeff() + rounding)
            << sign * saturated;
      }
    }
  });
}

TEST(JointLimitMap,
     a_range_of_half_turns_keeps_a_slope_of_half_the_sine_where_the_first_form_is_0_by_0) {
  const JointLimitMap map(one_joint(0.0, M_PI));
  JointLimitMap::State state = map.make_state();
  ASSERT_EQ(map.size(), 1);
  for (const double omega : {-80.0, -40.0, -5.0, 0.0, 5.0, 37.0, 40.0, 80.0}) {
    map.forward(Eigen::VectorXd::Constant(1, omega), state, true);
    const double s = 1.0 / (1.0 + std::exp(-omega)), complement = 1.0 / (1.0 + std::exp(omega));
    const double expected = std::sqrt(s * complement);  // NOTES item 7
    EXPECT_NEAR(state.slope[0] / expected, 1.0, 1e-12) << omega;
  }
}

TEST(JointLimitMap, limits_hold_strictly_for_any_slack) {
  Random random(3);
  for_ranges([&](const Robot& robot, double lower, double upper) {
    const JointLimitMap map(robot);
    JointLimitMap::State state = map.make_state();
    for (int k = 0; k < 60; ++k) {
      const double extent = k % 3 == 0 ? 5.0 : k % 3 == 1 ? 50.0 : 1e300;
      const Eigen::VectorXd omega = random.vector(map.size(), -extent, extent);
      map.forward(omega, state, true);
      EXPECT_GE(state.q[0], lower);
      EXPECT_LE(state.q[0], upper);
      const double q = position(map, omega);
      EXPECT_GE(q, lower);
      EXPECT_LE(q, upper);
    }
  });
}

TEST(JointLimitMap, the_whole_range_is_reached_as_slack_grows) {
  for_ranges([&](const Robot& robot, double lower, double upper) {
    const JointLimitMap map(robot);
    const double end = 1e-8 * (upper - lower) + cut(robot);  // sqrt(exp(-60)) is 1e-13
    const Eigen::VectorXd far = Eigen::VectorXd::Constant(1, 60.0 * std::sqrt(map.sub_angles(0)));
    EXPECT_NEAR(position(map, -far), lower, end + 1e-14 * std::abs(lower));
    EXPECT_NEAR(position(map, far), upper, end + 1e-14 * std::abs(upper));
  });
}

TEST(JointLimitMap, cosines_and_sines_are_those_of_the_recovered_angle) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, {.joints = 8, .prismatic = 0.2, .continuous = 0.2});
    const JointLimitMap map(robot);
    JointLimitMap::State with_angles = map.make_state(), without = map.make_state();
    const Eigen::VectorXd omega = random.vector(map.size(), -10.0, 10.0);
    map.forward(omega, with_angles, true);
    map.forward(omega, without, false);
    Eigen::VectorXd q(robot.dof());
    map.positions(omega, q);
    for (Eigen::Index i = 0; i < robot.dof(); ++i) {
      EXPECT_NEAR(with_angles.q[i], q[i], 1e-14 * (1.0 + std::abs(q[i])));
      if (robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Prismatic) {
        EXPECT_EQ(without.q[i], q[i]);  // positions are needed even when angles are not
        continue;
      }
      EXPECT_NEAR(without.cosine[i], std::cos(q[i]), 2e-14);
      EXPECT_NEAR(without.sine[i], std::sin(q[i]), 2e-14);
    }
    EXPECT_EQ(with_angles.slope, without.slope);
  }
}

TEST(JointLimitMap, pull_back_is_the_gradient_of_a_function_of_q_composed_with_the_map) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, {.joints = 8, .prismatic = 0.2, .continuous = 0.2});
    const JointLimitMap map(robot);
    const Eigen::VectorXd weights = random.vector(robot.dof(), -1.0, 1.0),
                          omega = random.vector(map.size(), -4.0, 4.0);
    const auto composed = [&](const Eigen::VectorXd& at) {
      Eigen::VectorXd q(robot.dof());
      map.positions(at, q);
      return weights.dot(q) + 0.5 * q.squaredNorm();
    };
    JointLimitMap::State state = map.make_state();
    map.forward(omega, state, true);
    Eigen::VectorXd gradient(map.size());
    map.pull_back(state, weights + state.q, gradient);
    EXPECT_LT((gradient - central_gradient(composed, omega, 1e-5)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(JointLimitMap, the_ur10_has_24_slack_variables_however_its_turns_were_rounded) {
  const JointLimitMap ur10(Robot::builtin("ur10"));
  EXPECT_EQ(spread(ur10, Eigen::VectorXd::Zero(ur10.size())).size(), 24);
  for (const double turn : {2.0 * M_PI, 6.28318530718, 6.2831853, 6.283185}) {
    EXPECT_EQ(JointLimitMap(one_joint(-turn, turn)).sub_angles(0), 4) << turn;
  }
  EXPECT_EQ(JointLimitMap(one_joint(-6.2832, 6.2832)).sub_angles(0), 5);
}

TEST(JointLimitMap, the_number_of_sub_angles_is_the_range_in_half_turns_rounded_up) {
  EXPECT_EQ(JointLimitMap(one_joint(-0.1, 0.1)).sub_angles(0), 1);
  EXPECT_EQ(JointLimitMap(one_joint(-M_PI_2, M_PI_2)).sub_angles(0), 1);
  EXPECT_EQ(JointLimitMap(one_joint(-2.8973, 2.8973)).sub_angles(0), 2);
  EXPECT_EQ(JointLimitMap(one_joint(-7.0, 3.0)).sub_angles(0), 4);
  EXPECT_EQ(JointLimitMap(one_joint(-7.0, 3.0, true)).sub_angles(0), 1);  // metres are not cut
  EXPECT_EQ(JointLimitMap(one_joint(-kInfinity, kInfinity)).sub_angles(0), 1);
}

TEST(JointLimitMap, limits_that_mean_no_limits_are_no_reason_to_run_out_of_memory_or_precision) {
  Random random(4);
  for (const double wide : {300.0, 1e4, 1e9, 1e16}) {  // files write such numbers for "unlimited"
    SCOPED_TRACE(wide);
    const Robot robot = one_joint(-wide, 1.5 * wide);
    const JointLimitMap map(robot);
    ASSERT_LT(map.sub_angles(0), 1000);
    JointLimitMap::State state = map.make_state();
    Eigen::VectorXd omega(map.size());
    for (int k = 0; k < 20; ++k) {
      const double q = wide * random.uniform(-0.95, 1.4);
      map.inverse(Eigen::VectorXd::Constant(1, q), omega);
      EXPECT_NEAR(position(map, omega), q, 1e-12 * wide);
      map.forward(omega, state, true);
      EXPECT_NEAR(state.cosine[0], std::cos(state.q[0]), 1e-9);
      EXPECT_NEAR(state.sine[0], std::sin(state.q[0]), 1e-9);
      const auto recovered = [&](const Eigen::VectorXd& at) { return position(map, at); };
      const Eigen::VectorXd difference = central_gradient(recovered, omega, 1e-4);
      EXPECT_LT((state.slope - difference).lpNorm<Eigen::Infinity>(), 1e-7 * wide);
    }
  }
}

TEST(JointLimitMap, joints_without_limits_are_their_own_slack) {
  const JointLimitMap map(one_joint(-kInfinity, kInfinity));
  JointLimitMap::State state = map.make_state();
  for (const double q : {-100.0, -M_PI, 0.0, 1e-9, 50.0}) {
    Eigen::VectorXd omega(1);
    map.inverse(Eigen::VectorXd::Constant(1, q), omega);
    EXPECT_EQ(position(map, omega), q);
    map.forward(omega, state, true);
    EXPECT_EQ(state.slope[0], 1.0);
    EXPECT_EQ(state.q[0], q);
  }
}

TEST(JointLimitMap, a_joint_whose_limits_coincide_stays_there) {
  for (const bool prismatic : {false, true}) {
    const JointLimitMap map(one_joint(0.4, 0.4, prismatic));
    JointLimitMap::State state = map.make_state();
    Eigen::VectorXd omega(map.size());
    map.inverse(Eigen::VectorXd::Constant(1, 0.7), omega);
    ASSERT_TRUE(omega.allFinite());
    map.forward(omega, state, true);
    EXPECT_EQ(state.q[0], 0.4);
    EXPECT_EQ(state.slope[0], 0.0);
    if (prismatic) continue;
    EXPECT_NEAR(state.cosine[0], std::cos(0.4), 1e-15);
  }
}

}  // namespace
}  // namespace pdoik
