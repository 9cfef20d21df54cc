#include <gtest/gtest.h>

#include <algorithm>

#include "finite_differences.hpp"
#include "pdoik/robot.hpp"
#include "random_robots.hpp"
#include "textbook_kinematics.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

/// Random trees, each seed's name in the failure's message.
template <class Check>
void for_random_trees(int count, Check&& check) {
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    check(random_description(random, kMixedTree), random);
    if (::testing::Test::HasFailure()) return;
  }
}

/// Every pose of every link, from this base, against the textbook's relative transform.
void expect_textbook_poses(const RobotDescription& description, const Robot& robot,
                           const Eigen::VectorXd& q, double tolerance) {
  const auto positions = by_joint_name(robot, q);
  const Eigen::Isometry3d T_root_base = textbook_pose(description, robot.base_link(), positions);
  for (const LinkDescription& link : description.links) {
    const Eigen::Isometry3d expected =
        T_root_base.inverse() * textbook_pose(description, link.name, positions);
    EXPECT_LT(gap(robot.fk(q, link.name), expected), tolerance)
        << link.name << " from " << robot.base_link();
  }
}

TEST(Robot, fk_is_the_textbook_product_whatever_link_is_the_base) {
  for_random_trees(30, [](const RobotDescription& description, Random& random) {
    for (const LinkDescription& base : description.links) {
      const Robot robot(description, base.name);
      expect_textbook_poses(description, robot, random_configuration(robot, random), 1e-12);
      expect_textbook_poses(description, robot, Eigen::VectorXd::Zero(robot.dof()), 1e-12);
    }
  });
}

TEST(Robot, axes_near_plus_and_minus_z_give_rigid_and_right_poses) {
  for (const double tilt : {0.0, 1e-12, 1e-8, 1e-7, 1.5e-6, 3e-6, 1e-5, 1e-4, 1e-3}) {
    for (const double sign : {1.0, -1.0}) {
      SCOPED_TRACE("tilt " + std::to_string(tilt * 1e6) + "e-6, sign " + std::to_string(sign));
      RobotDescription description;
      description.links = {{.name = "a"}, {.name = "b"}};
      JointDescription joint = joint_between("a", "b", "j", JointType::Revolute, -3.0, 3.0);
      joint.axis = Eigen::Vector3d(tilt, 0.3 * tilt, sign);
      description.joints = {joint};
      for (const char* base : {"a", "b"}) {
        const Robot robot(description, base);
        for (const double angle : {0.0, 1.0}) {
          const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, angle);
          EXPECT_LT(rigidity_gap(robot.fk(q, "b")), 1e-12);
          expect_textbook_poses(description, robot, q, 1e-12);
        }
      }
      if (HasFailure()) return;
    }
  }
}

TEST(Robot, body_poses_are_those_of_fk) {
  for_random_trees(20, [](const RobotDescription& description, Random& random) {
    const Robot robot(description);
    const Eigen::VectorXd q = random_configuration(robot, random);
    std::vector<Eigen::Isometry3d> poses(robot.bodies().size());
    robot.body_poses(q, poses);
    for (int link = 0; link < static_cast<int>(robot.link_names().size()); ++link) {
      const auto body = static_cast<std::size_t>(robot.body_of_link(link));
      EXPECT_LT(gap(poses[body] * robot.T_body_link(link), robot.fk(q, link)), 1e-12);
    }
  });
}

TEST(Robot, bodies_come_after_their_parents_and_turn_about_their_own_z) {
  for_random_trees(20, [](const RobotDescription& description, Random&) {
    const Robot robot(description, description.links.back().name);
    for (std::size_t b = 0; b < robot.bodies().size(); ++b) {
      EXPECT_LT(robot.bodies()[b].parent, static_cast<int>(b));
      if (b > 0) {
        EXPECT_GE(robot.bodies()[b].parent, 0);
        EXPECT_GE(robot.bodies()[b].dof, 0);
      }
      EXPECT_LT(rigidity_gap(robot.bodies()[b].T_parent_joint), 1e-12);
    }
  });
}

TEST(Robot, jacobian_is_the_central_difference_of_fk) {
  for_random_trees(30, [](const RobotDescription& description, Random& random) {
    const Robot robot(description, description.links[description.links.size() / 2].name);
    Eigen::VectorXd q = random_configuration(robot, random);
    for (int link = 0; link < static_cast<int>(robot.link_names().size()); ++link) {
      const auto J = robot.jacobian(q, link);
      const Eigen::Matrix3d R = robot.fk(q, link).linear();
      for (Eigen::Index i = 0; i < q.size(); ++i) {
        constexpr double h = 1e-5;
        Eigen::VectorXd above = q, below = q;
        above[i] += h, below[i] -= h;
        const Eigen::Matrix4d change =
            (robot.fk(above, link).matrix() - robot.fk(below, link).matrix()) / (2.0 * h);
        EXPECT_LT((J.col(i).head<3>() - change.topRightCorner<3, 1>()).norm(), 2e-9);
        EXPECT_LT((J.col(i).tail<3>() - vee(change.topLeftCorner<3, 3>() * R.transpose())).norm(),
                  2e-9);
      }
    }
  });
}

/// Eq. DH_matrix with the entry (2,4) of NOTES item 1, typed out.
Eigen::Matrix4d dh_matrix(double alpha, double a, double d, double theta) {
  const double ca = std::cos(alpha), sa = std::sin(alpha), ct = std::cos(theta),
               st = std::sin(theta);
  Eigen::Matrix4d T;
  T << ct, -st, 0.0, a,                //
      st * ca, ct * ca, -sa, -d * sa,  //
      st * sa, ct * sa, ca, d * ca,    //
      0.0, 0.0, 0.0, 1.0;
  return T;
}

TEST(Robot, from_dh_multiplies_the_corrected_matrices_of_the_paper) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<DhRow> rows;
    for (int i = 0; i < 6; ++i) {
      DhRow row{.alpha = random.uniform(-M_PI, M_PI),
                .a = random.uniform(-0.5, 0.5),
                .d = random.uniform(-0.5, 0.5)};
      if (random.chance(0.5)) row.alpha = M_PI_2 * random.integer(-2, 2);
      row.theta_offset = random.uniform(-M_PI, M_PI);
      row.prismatic = random.chance(0.3);
      row.lower = -1.0, row.upper = 1.0;
      rows.push_back(row);
    }
    const Eigen::Isometry3d tool = random.pose(0.3);
    const Robot robot = Robot::from_dh(rows, tool);
    const Eigen::VectorXd q = random_configuration(robot, random);
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const DhRow& row = rows[i];
      const double move = q[static_cast<Eigen::Index>(i)];
      T *= dh_matrix(row.alpha, row.a, row.d + (row.prismatic ? move : 0.0),
                     row.theta_offset + (row.prismatic ? 0.0 : move));
      EXPECT_LT((robot.fk(q, "link" + std::to_string(i + 1)).matrix() - T).cwiseAbs().maxCoeff(),
                1e-12);
    }
    EXPECT_LT((robot.fk(q).matrix() - T * tool.matrix()).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(Robot, joint_names_go_depth_first_from_the_base_with_siblings_by_name) {
  for_random_trees(30, [](const RobotDescription& description, Random&) {
    for (const LinkDescription& base : description.links) {
      const Robot robot(description, base.name);
      std::vector<std::string> expected;
      names_depth_first(description, base.name, {}, expected);
      EXPECT_EQ(robot.joint_names(), expected);
      EXPECT_EQ(robot.link_names().front(), base.name);
      EXPECT_EQ(robot.base_link(), base.name);
    }
  });
}

TEST(Robot, the_order_of_links_and_joints_in_the_description_does_not_matter) {
  for_random_trees(20, [](const RobotDescription& description, Random& random) {
    RobotDescription shuffled = description;
    std::reverse(shuffled.links.begin(), shuffled.links.end());
    std::reverse(shuffled.joints.begin(), shuffled.joints.end());
    const Robot one(description), other(shuffled);
    ASSERT_EQ(one.joint_names(), other.joint_names());
    EXPECT_EQ(one.link_names(), other.link_names());
    EXPECT_EQ(one.tip_links(), other.tip_links());
    const Eigen::VectorXd q = random_configuration(one, random);
    for (const std::string& link : one.link_names())
      EXPECT_EQ(gap(one.fk(q, link), other.fk(q, link)), 0.0);
  });
}

TEST(Robot, without_a_base_it_stands_on_the_root_and_without_tips_every_leaf_is_one) {
  for_random_trees(20, [](const RobotDescription& description, Random&) {
    const Robot robot(description);
    EXPECT_EQ(robot.base_link(), "l0");
    std::vector<std::string> leaves;
    for (const LinkDescription& link : description.links) {
      const bool has_child =
          std::any_of(description.joints.begin(), description.joints.end(),
                      [&](const JointDescription& j) { return j.parent_link == link.name; });
      if (!has_child) leaves.push_back(link.name);
    }
    std::vector<std::string> tips = robot.tip_links();
    std::sort(tips.begin(), tips.end());
    std::sort(leaves.begin(), leaves.end());
    EXPECT_EQ(tips, leaves);
  });
}

TEST(Robot, a_followers_limits_hold_exactly_where_its_leaders_do) {
  for (int seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    RobotDescription description;
    description.links = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
    const JointType type = seed % 5 == 0 ? JointType::Continuous : JointType::Revolute;
    const double low = random.uniform(-2.0, 0.0), high = random.uniform(0.1, 2.0);
    const JointDescription leader = joint_between("a", "b", "leader", type, low, high);
    JointDescription follower = joint_between("b", "c", "follower", JointType::Revolute);
    const double sign = random.chance(0.5) ? 1.0 : -1.0;
    const double rate = sign * random.uniform(0.2, 3.0);
    follower.mimic = Mimic{"leader", rate, random.uniform(-0.1, 0.1)};
    follower.lower = random.uniform(-2.0, -0.2), follower.upper = random.uniform(0.2, 2.0);
    description.joints = {follower, leader};
    const Robot robot(description);
    ASSERT_EQ(robot.dof(), 1);
    const auto violation = [&](double q) {
      const double f = rate * q + follower.mimic->offset;
      return std::max({leader.lower - q, q - leader.upper, follower.lower - f, f - follower.upper});
    };
    EXPECT_LT(violation(robot.lower()[0]), 1e-12);
    EXPECT_LT(violation(robot.upper()[0]), 1e-12);
    EXPECT_GT(violation(robot.lower()[0] - 1e-6), 1e-8);
    EXPECT_GT(violation(robot.upper()[0] + 1e-6), 1e-8);
  }
}

/// A finger of two joints, the second of which follows the first.
RobotDescription finger(double low, double high) {
  RobotDescription description;
  description.links = {{.name = "a"}, {.name = "b"}, {.name = "c"}};
  JointDescription follower = joint_between("b", "c", "follower", JointType::Revolute, low, high);
  follower.mimic = Mimic{"leader", 1.0, 0.0};
  description.joints = {follower,
                        joint_between("a", "b", "leader", JointType::Revolute, -0.5, 1.2)};
  return description;
}

TEST(Robot, a_followers_limits_that_leave_no_range_do_not_lock_its_leader_and_a_warning_says_so) {
  for (const auto& [low, high] :
       {std::pair(0.0, 0.0), {0.0, -0.0}, {-0.0, 0.0}, {0.7, 0.7}, {1.0, -1.0}}) {
    SCOPED_TRACE(std::to_string(low) + " to " + std::to_string(high));
    const Robot robot(finger(low, high));
    EXPECT_EQ(robot.lower()[0], -0.5);
    EXPECT_EQ(robot.upper()[0], 1.2);
    ASSERT_EQ(robot.warnings().size(), 1U);
    EXPECT_NE(robot.warnings()[0].find("follower"), std::string::npos) << robot.warnings()[0];
    EXPECT_NE(robot.warnings()[0].find("mimic"), std::string::npos) << robot.warnings()[0];
    const Robot again(robot.description(), robot.base_link(), robot.tip_links());
    EXPECT_EQ(again.warnings(), robot.warnings());
  }
  EXPECT_TRUE(Robot(finger(-0.2, 0.2)).warnings().empty());
}

TEST(Robot, a_leader_that_its_followers_leave_a_single_position_is_said_to_be_locked) {
  const Robot robot(finger(1.2, 2.0));
  EXPECT_EQ(robot.lower()[0], robot.upper()[0]);
  ASSERT_EQ(robot.warnings().size(), 1U);
  EXPECT_NE(robot.warnings()[0].find("locked, at leader"), std::string::npos);
}

TEST(Robot, speeds_and_efforts_that_no_machine_has_are_no_limits) {
  RobotDescription description = finger(-1.0, 1.0);
  for (const double limit : {1e9, 1e16, 1e300}) {
    description.joints[1].velocity = description.joints[1].effort = limit;
    const Robot robot(description);
    EXPECT_TRUE(std::isinf(robot.velocity()[0])) << limit;
    EXPECT_TRUE(std::isinf(robot.effort()[0])) << limit;
  }
  description.joints[1].velocity = description.joints[1].effort = 1e8;
  EXPECT_EQ(Robot(description).velocity()[0], 1e8);
  EXPECT_EQ(Robot(description).effort()[0], 1e8);
}

TEST(Robot, a_chain_of_followers_multiplies_rates_and_carries_offsets) {
  RobotDescription description;
  description.links = {{.name = "l0"}, {.name = "l1"}, {.name = "l2"}, {.name = "l3"}};
  for (int i = 1; i <= 3; ++i) {
    const std::string number = std::to_string(i), before = std::to_string(i - 1);
    JointDescription joint =
        joint_between("l" + before, "l" + number, "j" + number, JointType::Continuous);
    if (i < 3)
      joint.mimic = Mimic{"j" + std::to_string(i + 1), 2.0, 0.5 * i};  // followers before leaders
    description.joints.push_back(joint);
  }
  const Robot robot(description);
  ASSERT_EQ(robot.joint_names(), std::vector<std::string>{"j3"});
  for (const double q : {-1.0, 0.0, 0.7}) {
    const Eigen::VectorXd at = Eigen::VectorXd::Constant(1, q);
    expect_textbook_poses(description, robot, at, 1e-12);
    const double turned =
        q + (2.0 * q + 1.0) + (2.0 * (2.0 * q + 1.0) + 0.5);  // j3, j2, j1, about the same axis
    const Eigen::Matrix3d expected =
        Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    EXPECT_LT((robot.fk(at).linear() - expected).norm(), 1e-12);
  }
}

TEST(Robot, mid_configuration_is_inside_the_limits_and_finite) {
  for_random_trees(20, [](const RobotDescription& description, Random&) {
    const Robot robot(description);
    const Eigen::VectorXd q = robot.mid_configuration();
    ASSERT_TRUE(q.allFinite());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      if (std::isinf(robot.lower()[i])) {
        EXPECT_EQ(q[i], 0.0);
      } else {
        EXPECT_NEAR(q[i] - robot.lower()[i], robot.upper()[i] - q[i], 1e-12);
      }
    }
  });
}

TEST(Robot, limits_beyond_any_machine_are_none) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kLargest = std::numeric_limits<double>::max();
  struct Case {
    JointType type;
    double lower, upper, robots_lower, robots_upper;
    JointType robots_type;
  };
  const Case cases[] = {
      {JointType::Revolute, -1e16, 1e16, -kInfinity, kInfinity, JointType::Continuous},
      {JointType::Prismatic, -kLargest, kLargest, -kInfinity, kInfinity, JointType::Prismatic},
      {JointType::Revolute, -1.0, 1e16, -1.0, 1e6, JointType::Revolute},
      {JointType::Prismatic, kLargest, kLargest, 1e6, 1e6, JointType::Prismatic},
      {JointType::Revolute, -1e6, 1e6, -1e6, 1e6, JointType::Revolute},
  };
  for (const Case& each : cases) {
    SCOPED_TRACE(std::to_string(each.lower) + " to " + std::to_string(each.upper));
    RobotDescription description;
    description.name = "wide";
    description.links = {{.name = "base"}, {.name = "tip"}};
    description.joints = {joint_between("base", "tip", "j", each.type, each.lower, each.upper)};
    const Robot robot(description);
    EXPECT_EQ(robot.lower()[0], each.robots_lower);
    EXPECT_EQ(robot.upper()[0], each.robots_upper);
    EXPECT_EQ(robot.joint_types()[0], each.robots_type);
    EXPECT_TRUE(robot.mid_configuration().allFinite());
  }
}

}  // namespace
}  // namespace pdoik
