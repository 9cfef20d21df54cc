#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "finite_differences.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/floating_base.hpp"
#include "random_robots.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// q of one robot by joint names from q of another, whose further joints are left out.
Eigen::VectorXd by_names(const Robot& to, const Robot& from, const Eigen::VectorXd& q) {
  const std::map<std::string, double> positions = by_joint_name(from, q);
  Eigen::VectorXd result(to.dof());
  for (int i = 0; i < to.dof(); ++i)
    result[i] = positions.at(to.joint_names()[static_cast<std::size_t>(i)]);
  return result;
}

FloatingBaseBounds some_bounds() {
  FloatingBaseBounds bounds;
  bounds.lower << -1.0, -2.0, 0.3, -3.0, -1.2, -0.5;
  bounds.upper << 1.5, 2.0, 0.9, 3.0, 1.3, 0.7;
  return bounds;
}

Eigen::Isometry3d placed(const Eigen::VectorXd& q) {
  return Eigen::Translation3d(q[0], q[1], q[2]) *
         Eigen::AngleAxisd(q[3], Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(q[4], Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(q[5], Eigen::Vector3d::UnitX());
}

/// check(random, description, base link): roots, leaves and links between, of random trees.
void for_bases(
    const std::function<void(Random&, const RobotDescription&, const std::string&)>& check) {
  for (int seed = 1; seed <= 40; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const RobotDescription description = random_description(random, kMixedTree);
    for (const LinkDescription& base : description.links) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", base " + base.name);
      check(random, description, base.name);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

TEST(Mounted, poses_are_those_seen_from_the_base_moved_into_the_world) {
  for_bases([](Random& random, const RobotDescription& description, const std::string& base) {
    const Eigen::Isometry3d T = random.pose(2.0);
    const Robot free(description, base), robot(mounted(description, base, T), "world");
    EXPECT_EQ(robot.base_link(), "world");
    EXPECT_EQ(robot.joint_names(), free.joint_names());
    EXPECT_EQ(robot.tip_links(), free.tip_links());
    const Eigen::VectorXd q = random_configuration(free, random);
    for (const std::string& link : free.link_names())
      EXPECT_LT(gap(robot.fk(q, link), T * free.fk(q, link)), 1e-12);
  });
}

TEST(Mounted, a_world_above_the_root_is_the_descriptions_root) {
  Random random(3);
  const RobotDescription description = random_description(random, kSerial);
  EXPECT_EQ(Robot(mounted(description, "l0", random.pose(1.0))).base_link(), "world");
}

TEST(Mounted, a_urdf_can_be_mounted_by_any_link_and_keeps_its_warnings) {
  const std::string xml = R"(<robot name="two">
    <link name="foot"><inertial><mass value="1"/>
      <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="5"/></inertial></link>
    <link name="leg"/>
    <joint name="ankle" type="revolute"><parent link="foot"/><child link="leg"/>
      <origin xyz="0 0 0.1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="2" effort="30"/>
    </joint></robot>)";
  const Eigen::Isometry3d T = Random(1).pose(1.0);
  const Robot robot(mounted(load_urdf(xml), "leg", T), "world", {"foot"});
  EXPECT_EQ(robot.warnings(), Robot::from_urdf(xml).warnings());
  EXPECT_EQ(robot.warnings().size(), 1U);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.4);
  EXPECT_LT(gap(robot.fk(q), T * Robot::from_urdf(xml).fk(q, "leg").inverse()), 1e-12);
}

TEST(FloatingBase, poses_are_the_base_moved_and_turned_then_the_fixed_robots) {
  const FloatingBaseBounds bounds = some_bounds();
  for_bases([&](Random& random, const RobotDescription& description, const std::string& base) {
    const Robot fixed(description, base);
    const Robot robot(with_floating_base(description, base, bounds), "world");
    ASSERT_EQ(robot.dof(), fixed.dof() + 6);
    std::vector<std::string> names{"base_x",   "base_y",     "base_z",
                                   "base_yaw", "base_pitch", "base_roll"};
    names.insert(names.end(), fixed.joint_names().begin(), fixed.joint_names().end());
    EXPECT_EQ(robot.joint_names(), names);
    EXPECT_EQ(robot.tip_links(), fixed.tip_links());
    EXPECT_EQ(robot.lower().head<6>(), bounds.lower);
    EXPECT_EQ(robot.upper().head<6>(), bounds.upper);
    const Eigen::VectorXd q = random_configuration(robot, random);
    const Eigen::VectorXd inner = by_names(fixed, robot, q);
    for (const std::string& link : fixed.link_names())
      EXPECT_LT(gap(robot.fk(q, link), placed(q) * fixed.fk(inner, link)), 1e-12);
  });
}

template <class Work>
void expect_misuse(Work&& work, const std::vector<std::string>& words) {
  try {
    work();
    FAIL() << "was accepted; expected an invalid_argument with '" << words.front() << "'";
  } catch (const std::invalid_argument& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(FloatingBase, misuse_is_refused_by_name) {
  const RobotDescription description = random_description(4, kSerial);
  const Eigen::Isometry3d I = Eigen::Isometry3d::Identity();
  const auto floating = [&](int entry, double lower, double upper) {
    FloatingBaseBounds bounds = some_bounds();
    bounds.lower[entry] = lower;
    bounds.upper[entry] = upper;
    return with_floating_base(description, "l0", bounds);
  };
  expect_misuse([&] { floating(2, 1.0, kInfinity); }, {"base_z", "inf", "finite"});
  expect_misuse([&] { floating(3, std::nan(""), 1.0); }, {"base_yaw", "finite"});
  expect_misuse([&] { floating(0, 2.0, 1.0); }, {"base_x", "[2.0", "lower one first"});
  expect_misuse([&] { floating(4, -1.0, M_PI_2); }, {"base_pitch", "pi/2"});
  expect_misuse([&] { floating(4, -2.0, 1.0); }, {"base_pitch", "pi/2"});
  EXPECT_NO_THROW(Robot(floating(5, 0.1, 0.1), "world"));
  expect_misuse([&] { mounted(description, "hip", I); }, {"'hip'", "l0, l1"});
  expect_misuse([&] { with_floating_base(description, "", some_bounds()); },
                {"base_link ''", "l0"});
  expect_misuse([&] { mounted(mounted(description, "l2", I), "l0", I); },
                {"'world'", "world_link"});
  expect_misuse([&] { mounted(description, "l2", I, ""); }, {"world_link is empty"});
  expect_misuse([&] { with_floating_base(floating(0, -1.0, 1.0), "l0", some_bounds(), "map"); },
                {"base_x"});
  Eigen::Isometry3d bent = I;
  bent.linear() *= 1.1;
  expect_misuse([&] { mounted(description, "l0", bent); }, {"T_world_base", "rigid"});
}

TEST(FloatingBase, a_description_with_a_world_of_its_own_takes_another_name) {
  Random random(5);
  const RobotDescription description = random_description(random, kSerial);
  const Eigen::Isometry3d T = random.pose(1.0), S = random.pose(1.0);
  const Robot robot(mounted(mounted(description, "l2", T), "world", S, "map"), "map");
  const Robot free(description, "l2");
  const Eigen::VectorXd q = random_configuration(free, random);
  EXPECT_LT(gap(robot.fk(q, "l4"), S * T * free.fk(q, "l4")), 1e-12);
  const Robot floating(
      with_floating_base(mounted(description, "l2", T), "world", some_bounds(), "map"), "map");
  const Eigen::VectorXd p = random_configuration(floating, random);
  EXPECT_LT(gap(floating.fk(p, "l4"), placed(p) * T * free.fk(by_names(free, floating, p), "l4")),
            1e-12);
}

// --- Masses and efforts -----------------------------------------------------------------------

RobotDescription with_masses(Random& random, RobotDescription description) {
  for (LinkDescription& link : description.links) {
    link.mass = random.chance(0.2) ? 0.0 : random.uniform(0.1, 5.0);
    link.center_of_mass = random.point(0.2);
  }
  return description;
}

TEST(CenterOfMass, is_the_mean_of_the_links_weighted_by_their_masses) {
  for_bases([](Random& random, const RobotDescription& description, const std::string& base) {
    const Robot robot(with_masses(random, description), base);
    const Eigen::VectorXd q = random_configuration(robot, random);
    double mass = 0.0;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (const LinkDescription& link : robot.links()) {
      mass += link.mass;
      moment += link.mass * (robot.fk(q, link.name) * link.center_of_mass);
    }
    EXPECT_DOUBLE_EQ(robot.total_mass(), mass);
    EXPECT_LT((robot.center_of_mass(q) - moment / mass).norm(), 1e-13);
  });
}

TEST(CenterOfMass, its_jacobian_is_its_central_difference) {
  for_bases([](Random& random, const RobotDescription& description, const std::string& base) {
    const Robot robot(with_masses(random, description), base);
    const Eigen::VectorXd q = random_configuration(robot, random);
    const Eigen::Matrix3Xd J = robot.center_of_mass_jacobian(q);
    for (int i = 0; i < 3; ++i) {
      const Eigen::VectorXd expected = central_gradient(
          [&](const Eigen::VectorXd& x) { return robot.center_of_mass(x)[i]; }, q, 1e-6);
      EXPECT_LT((J.row(i).transpose() - expected).cwiseAbs().maxCoeff(), 1e-8);
    }
  });
}

TEST(CenterOfMass, goes_with_a_floating_base_and_counts_the_base_link) {
  Random random(8);
  RobotDescription description = with_masses(random, random_description(random, kMixedTree));
  description.links.front().mass = 20.0;
  const Robot fixed(description);
  const Robot robot(with_floating_base(description, "l0", some_bounds()), "world");
  const Eigen::VectorXd q = random_configuration(robot, random);
  EXPECT_DOUBLE_EQ(robot.total_mass(), fixed.total_mass());
  EXPECT_LT((robot.center_of_mass(q) - placed(q) * fixed.center_of_mass(by_names(fixed, robot, q)))
                .norm(),
            1e-12);
  EXPECT_LT((robot.center_of_mass_jacobian(q).leftCols<3>() - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
}

TEST(CenterOfMass, of_a_robot_without_masses_is_refused) {
  const Robot robot(random_description(6, kSerial));
  const Eigen::VectorXd q = robot.mid_configuration();
  EXPECT_EQ(robot.total_mass(), 0.0);
  expect_misuse([&] { robot.center_of_mass(q); }, {"'random'", "masses", "0.0"});
  expect_misuse([&] { robot.center_of_mass_jacobian(q); }, {"'random'", "masses"});
  expect_misuse([&] { robot.center_of_mass(Eigen::VectorXd::Zero(2)); }, {"q has 2 entries"});
}

TEST(Effort, is_ordered_as_the_joints_and_infinite_where_none_is_given) {
  RobotDescription description = random_description(7, kMixedTree);
  std::map<std::string, double> efforts;
  for (std::size_t k = 0; k < description.joints.size(); ++k) {
    JointDescription& joint = description.joints[k];
    if (k % 3 != 0) joint.effort = 10.0 + static_cast<double>(k);
    efforts[joint.name] = joint.effort;
  }
  const Robot robot(description, "l5");
  ASSERT_EQ(robot.effort().size(), robot.dof());
  for (int i = 0; i < robot.dof(); ++i)
    EXPECT_EQ(robot.effort()[i], efforts.at(robot.joint_names()[static_cast<std::size_t>(i)]));
  EXPECT_EQ(Robot::builtin("panda").effort()[0], 87.0);
}

}  // namespace
}  // namespace pdoik
