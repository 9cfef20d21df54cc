#include <gtest/gtest.h>

#include "finite_differences.hpp"
#include "problem/goal_term.hpp"
#include "random_robots.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

Frame frame_of(const Eigen::Matrix3d& R) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = R;
  return to_frame(T);
}

Eigen::Matrix3d exponential(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  return angle > 0.0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix()
                     : Eigen::Matrix3d::Identity();
}

std::vector<double> angles() {
  std::vector<double> all{0.0, 0.3, 1.0, M_PI_2, 2.0, 3.0, M_PI};
  for (const double small : {1e-15, 1e-13, 1e-12, 1e-11, 1e-9, 1e-7, 1e-5, 1e-3}) {
    all.push_back(small);
    all.push_back(M_PI - small);
  }
  return all;
}

TEST(GoalTerm, the_rotation_error_is_the_log_map_from_zero_to_half_a_turn) {
  Random random(1);
  for (const double angle : angles()) {
    SCOPED_TRACE("pi - angle " + std::to_string(1e12 * (M_PI - angle)) + "e-12");
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d axis = k < 3 ? Eigen::Vector3d::Unit(k) : random.direction();
      const Eigen::Matrix3d target = k % 2 == 0 ? Eigen::Matrix3d::Identity() : random.rotation();
      const Eigen::Matrix3d R = exponential(angle * axis) * target;
      const Eigen::Vector3d e = to_vector3(rotation_error_vector(frame_of(R), frame_of(target)));
      // The axis is read from a sine that rounding changes by some 1e-16; within 1e-12 of half a
      // turn, where e and -e are all but the same rotation, from the cosines.
      const double left = M_PI - angle, axis_error = left < 2e-12 ? 2e-3 : 2e-15 / std::sin(left);
      ASSERT_NEAR(e.norm(), angle, 1e-15 + 1e-14 * angle + (left < 2e-12 ? 1e-12 : 0.0));
      ASSERT_LT((exponential(e) * target - R).cwiseAbs().maxCoeff(), 2e-15 + 2.0 * axis_error);
      if (left < 2e-12) continue;
      ASSERT_LT((e - angle * axis).norm(), 2e-15 + 4.0 * angle * axis_error);
    }
  }
}

TEST(GoalTerm, the_axis_error_is_the_shortest_rotation_from_the_target_axis) {
  Random random(2);
  for (const double angle : angles()) {
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d target = k < 3 ? Eigen::Vector3d::Unit(k) : random.direction();
      const Eigen::Vector3d turn = target.cross(random.direction()).normalized();
      const Eigen::Vector3d axis = exponential(angle * turn) * target;
      const Eigen::Vector3d e = to_vector3(axis_error_vector(to_vec4(axis), to_vec4(target)));
      const double left = M_PI - angle, axis_error = left < 5e-13 ? 2e-12 : 2e-15 / std::sin(left);
      ASSERT_NEAR(e.norm(), angle, 1e-15 + 1e-14 * angle + (left < 2e-12 ? 1e-12 : 0.0));
      ASSERT_LT((exponential(e) * target - axis).norm(), 2e-15 + 2.0 * axis_error);
    }
  }
}

/// A tip on a body at random poses, and its objective.
struct Tip {
  Tip(Random& random, GoalType type)
      : T_body_tip(random.pose(0.3)),
        T_base_body(random.pose(1.0)),
        target(random.pose(1.0)),
        axis(random.direction()),
        goal(0, T_body_tip, type, 3.0 * axis) {
    goal.set_target(target);
  }
  double objective(const Eigen::Isometry3d& T, double distance) {
    Vec4 force, moment;
    goal.place(to_frame(T));
    return goal.point_objective(distance, force, moment);
  }
  Eigen::Isometry3d T_body_tip, T_base_body, target;
  Eigen::Vector3d axis;
  GoalTerm goal;
};

TEST(GoalTerm, the_wrench_of_the_point_objective_is_its_central_difference) {
  for (const GoalType type : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
    for (int seed = 1; seed <= 20; ++seed) {
      SCOPED_TRACE("type " + std::to_string(static_cast<int>(type)) + ", seed " +
                   std::to_string(seed));
      Random random(static_cast<std::uint64_t>(seed));
      Tip tip(random, type);
      if (seed == 1) tip.T_base_body = tip.target * tip.T_body_tip.inverse();  // on the target
      const double distance = random.uniform(0.1, 1.0);
      Vec4 force, moment;
      tip.goal.place(to_frame(tip.T_base_body));
      tip.goal.point_objective(distance, force, moment);
      const auto moved_objective = [&](const Eigen::VectorXd& motion) {
        return tip.objective(moved(tip.T_base_body, motion.head<3>(), motion.tail<3>()), distance);
      };
      const Eigen::VectorXd difference =
          central_gradient(moved_objective, Eigen::VectorXd::Zero(6), 1e-5);
      EXPECT_LT((difference.head<3>() - to_vector3(moment)).norm(), 1e-9);
      EXPECT_LT((difference.tail<3>() - to_vector3(force)).norm(), 1e-9);
    }
  }
}

TEST(GoalTerm, the_point_objective_is_half_the_sum_of_squared_distances_between_points) {
  for (int seed = 1; seed <= 20; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const double k = random.uniform(0.1, 1.0);
    for (const GoalType type : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
      Tip tip(random, type);
      const Eigen::Isometry3d T = tip.T_base_body * tip.T_body_tip;
      std::vector<Eigen::Vector3d> points{Eigen::Vector3d::Zero()};
      if (type == GoalType::Pose)
        points.insert(points.end(), {k * Eigen::Vector3d::UnitX(), k * Eigen::Vector3d::UnitY()});
      if (type == GoalType::Axis) points.push_back(k * tip.axis);
      double expected = 0.0;
      for (const Eigen::Vector3d& p : points)
        expected += 0.5 * (T * p - tip.target * p).squaredNorm();
      EXPECT_NEAR(tip.objective(tip.T_base_body, k), expected, 1e-13);
    }
  }
}

TEST(GoalTerm, errors_are_zero_at_the_target_and_do_not_see_what_the_goal_leaves_free) {
  Random random(3);
  for (int k = 0; k < 20; ++k) {
    for (const GoalType type : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
      Tip tip(random, type);
      Eigen::Isometry3d T_base_tip = tip.target;
      if (type == GoalType::Axis)
        T_base_tip = T_base_tip * Eigen::AngleAxisd(random.uniform(-3.0, 3.0), tip.axis);
      if (type == GoalType::Position) T_base_tip.linear() = random.rotation();
      const Eigen::Isometry3d T_base_body = T_base_tip * tip.T_body_tip.inverse();
      EXPECT_LT(tip.objective(T_base_body, 0.5), 1e-28);
      EXPECT_LT(tip.goal.position_distance(), 1e-14);
      EXPECT_LT(tip.goal.rotation_distance(), 1e-14);
    }
  }
}

}  // namespace
}  // namespace pdoik::detail
