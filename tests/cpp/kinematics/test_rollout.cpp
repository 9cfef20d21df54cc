#include <gtest/gtest.h>

#include "kinematics/rollout.hpp"
#include "random_robots.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

/// A random robot at a random configuration, rolled out.
struct Scenario {
  explicit Scenario(int seed)
      : random(static_cast<std::uint64_t>(seed)),
        robot(random_robot(random, kMixedTree)),
        rollout(robot),
        q(random_configuration(robot, random)) {
    if (seed % 4 == 0) q.setZero();
    const Eigen::VectorXd cosine = q.array().cos(), sine = q.array().sin();
    // Angles are withheld from a rollout that says it needs none; prismatic joints' positions are
    // always there.
    Eigen::VectorXd given = q;
    for (Eigen::Index i = 0; i < q.size() && !rollout.needs_angles(); ++i) {
      if (robot.joint_types()[static_cast<std::size_t>(i)] != JointType::Prismatic)
        given[i] = std::nan("");
    }
    rollout.forward(cosine.data(), sine.data(), given.data());
  }

  Eigen::Isometry3d pose(int body) const {
    const Frame& f = rollout.frame(body);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() << to_vector3(f.x), to_vector3(f.y), to_vector3(f.z);
    T.translation() = to_vector3(f.p);
    return T;
  }

  /// Jacobian of a point of a link, given in the base frame, from Robot's own.
  Eigen::Matrix3Xd point_jacobian(int link, const Eigen::Vector3d& u) const {
    const auto J = robot.jacobian(q, link);
    const Eigen::Vector3d arm = u - robot.fk(q, link).translation();
    Eigen::Matrix3Xd result(3, robot.dof());
    for (Eigen::Index i = 0; i < robot.dof(); ++i) {
      const Eigen::Vector3d turn = J.col(i).tail<3>();
      result.col(i) = J.col(i).head<3>() + turn.cross(arm);
    }
    return result;
  }

  Random random;
  Robot robot;
  Rollout rollout;
  Eigen::VectorXd q;
};

template <class Check>
void for_scenarios(Check&& check) {
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Scenario scenario(seed);
    check(scenario);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(Rollout, frames_are_those_of_robot_fk) {
  for_scenarios([](Scenario& s) {
    for (int link = 0; link < static_cast<int>(s.robot.link_names().size()); ++link) {
      const Eigen::Isometry3d T = s.pose(s.robot.body_of_link(link)) * s.robot.T_body_link(link);
      EXPECT_LT((T.matrix() - s.robot.fk(s.q, link).matrix()).cwiseAbs().maxCoeff(), 1e-12);
    }
  });
}

TEST(Rollout, the_reverse_pass_is_the_sum_of_jacobian_transposes_times_forces) {
  for_scenarios([](Scenario& s) {
    for (int repeat = 0; repeat < 2; ++repeat) {  // nothing is left over from the pass before
      Eigen::VectorXd expected = Eigen::VectorXd::Zero(s.robot.dof()),
                      dq = Eigen::VectorXd::Constant(s.robot.dof(), 9.0);
      s.rollout.clear_wrenches();
      for (int k = 0; k < 12; ++k) {
        const int link = s.random.integer(0, static_cast<int>(s.robot.link_names().size()) - 1);
        const Eigen::Vector3d u = s.random.point(1.0), force = s.random.point(5.0);
        s.rollout.add_force(s.robot.body_of_link(link), to_vec4(u), to_vec4(force));
        expected += s.point_jacobian(link, u).transpose() * force;
      }
      s.rollout.reverse(dq.data(), s.robot.dof());
      EXPECT_LT((dq - expected).cwiseAbs().maxCoeff(), 1e-12);
    }
  });
}

TEST(Rollout, a_wrench_is_a_force_at_the_bases_origin_and_a_pure_moment) {
  for_scenarios([](Scenario& s) {
    const int link = s.robot.tips().front();
    const Eigen::Vector3d force = s.random.point(5.0), moment = s.random.point(5.0);
    const auto J = s.robot.jacobian(s.q, link);
    const Eigen::VectorXd expected =
        s.point_jacobian(link, Eigen::Vector3d::Zero()).transpose() * force +
        J.bottomRows<3>().transpose() * moment;
    Eigen::VectorXd dq(s.robot.dof());
    s.rollout.clear_wrenches();
    s.rollout.add_wrench(s.robot.body_of_link(link), to_vec4(force), to_vec4(moment));
    s.rollout.reverse(dq.data(), s.robot.dof());
    EXPECT_LT((dq - expected).cwiseAbs().maxCoeff(), 1e-12);
  });
}

TEST(Rollout, add_row_is_the_reverse_pass_of_one_wrench_added_to_what_was_there) {
  for_scenarios([](Scenario& s) {
    for (int link = 0; link < static_cast<int>(s.robot.link_names().size()); ++link) {
      const Eigen::Vector3d u = s.random.point(1.0), force = s.random.point(5.0);
      Eigen::VectorXd row = s.random.vector(s.robot.dof(), -1.0, 1.0);
      const Eigen::VectorXd expected = row + s.point_jacobian(link, u).transpose() * force;
      s.rollout.add_row(s.robot.body_of_link(link), to_vec4(force),
                        cross3(to_vec4(u), to_vec4(force)), row.data());
      EXPECT_LT((row - expected).cwiseAbs().maxCoeff(), 1e-12);
    }
  });
}

TEST(Rollout, the_joints_visited_make_up_the_jacobian) {
  for_scenarios([](Scenario& s) {
    const int link = s.robot.tips().front();
    const Eigen::Vector3d tip = s.robot.fk(s.q, link).translation();
    Eigen::Matrix<double, 6, Eigen::Dynamic> J =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, s.robot.dof());
    s.rollout.for_each_joint(s.robot.body_of_link(link), [&](int dof, double multiplier,
                                                             bool prismatic, const Frame& f) {
      const Eigen::Vector3d z = multiplier * to_vector3(f.z);
      J.col(dof).head<3>() += prismatic ? z : Eigen::Vector3d(z.cross(tip - to_vector3(f.p)));
      if (!prismatic) J.col(dof).tail<3>() += z;
    });
    EXPECT_LT((J - s.robot.jacobian(s.q, link)).cwiseAbs().maxCoeff(), 1e-12);
  });
}

TEST(Rollout, a_slide_that_follows_a_turn_reads_the_turns_angle_and_the_other_way_round) {
  for (const bool leader_slides : {false, true}) {
    const JointType turn = JointType::Revolute, slide = JointType::Prismatic;
    RobotDescription description;
    description.links = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
    JointDescription follower = joint_between("b", "c", "follower", leader_slides ? turn : slide);
    follower.mimic = Mimic{"leader", 0.5, 0.1};
    description.joints = {joint_between("a", "b", "leader", leader_slides ? slide : turn),
                          follower};
    const Robot robot(description);
    Rollout rollout(robot);
    const double q = 0.7, cosine = std::cos(q), sine = std::sin(q), unknown = std::nan("");
    rollout.forward(&cosine, &sine, leader_slides || rollout.needs_angles() ? &q : &unknown);
    const Eigen::Vector3d p =
        to_vector3(rollout.frame(robot.body_of_link(robot.link_index("c"))).p);
    EXPECT_LT((p - robot.fk(Eigen::VectorXd::Constant(1, q)).translation()).norm(), 1e-15)
        << leader_slides;
  }
}

TEST(Rollout, the_random_robots_cover_mimic_prismatic_and_angle_free_rollouts) {
  int mimic = 0, prismatic = 0, angle_free = 0;
  for_scenarios([&](Scenario& s) {
    for (const Body& body : s.robot.bodies()) {
      if (body.dof < 0) continue;
      mimic += body.multiplier != 1.0;
      prismatic += body.prismatic;
    }
    angle_free += !s.rollout.needs_angles();
  });
  EXPECT_GT(mimic, 10);
  EXPECT_GT(prismatic, 10);
  EXPECT_GT(angle_free, 3);
}

}  // namespace
}  // namespace pdoik::detail
