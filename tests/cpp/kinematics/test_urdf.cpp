#include <gtest/gtest.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "finite_differences.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/robot.hpp"
#include "random_robots.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

std::string urdf_path(const std::string& name) {
  return std::string(PDOIK_SOURCE_DIR) + "/cpp/robots/" + name + ".urdf";
}

std::string file_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// "LoadError", or what makes the robot invalid, or nothing. Whatever else is thrown fails the
/// test.
std::string load_and_check(const std::string& xml) {
  try {
    const Robot robot = Robot::from_urdf(xml);
    const Eigen::VectorXd q = robot.mid_configuration();
    if (!q.allFinite()) return "the middle of the ranges is not finite";
    for (const std::string& link : robot.link_names()) {
      const Eigen::Isometry3d T = robot.fk(q, link);
      if (!T.matrix().allFinite()) return "the pose of " + link + " is not finite";
      if (rigidity_gap(T) > 1e-9) return "the pose of " + link + " is not rigid";
    }
    return {};
  } catch (const LoadError& error) {
    return std::string(error.what()).empty() ? "a LoadError without a message" : "LoadError";
  }
}

std::string with(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(Urdf, the_builtin_robots_load_with_the_limits_and_poses_that_urdfdom_reads) {
  ASSERT_GE(Robot::builtin_names().size(), 3U);
  Random random(7);
  for (const std::string& name : Robot::builtin_names()) {
    SCOPED_TRACE(name);
    const Robot robot = Robot::builtin(name);
    const Robot from_file = Robot::from_urdf(urdf_path(name));
    const auto model = urdf::parseURDFFile(urdf_path(name));
    ASSERT_TRUE(model);
    EXPECT_TRUE(robot.warnings().empty()) << robot.warnings().front();
    ASSERT_EQ(robot.tips().size(), name == "h1" ? 4U : 1U);
    ASSERT_EQ(robot.joint_names(), from_file.joint_names());
    for (int i = 0; i < robot.dof(); ++i) {
      const auto joint = model->getJoint(robot.joint_names()[static_cast<std::size_t>(i)]);
      EXPECT_EQ(robot.lower()[i], joint->limits->lower);
      EXPECT_EQ(robot.upper()[i], joint->limits->upper);
      EXPECT_EQ(robot.velocity()[i], joint->limits->velocity);
    }
    const Eigen::VectorXd q = random_configuration(robot, random);
    for (const std::string& tip : robot.tip_links())
      EXPECT_EQ(gap(robot.fk(q, tip), from_file.fk(q, tip)), 0.0);
  }
}

TEST(Urdf, the_arms_stretch_as_far_as_their_data_sheets_say) {
  // Distance from the shoulder to the wrist at full stretch: UR10's a2 + a3, the others' d3 + d5
  // (with Panda's offset).
  const auto distance = [](const Robot& robot, const Eigen::VectorXd& q, const char* a,
                           const char* b) {
    return (robot.fk(q, a).translation() - robot.fk(q, b).translation()).norm();
  };
  const Robot panda = Robot::builtin("panda");
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(7);
  EXPECT_NEAR(panda.fk(zero).translation().z(), 0.333 + 0.316 + 0.384 - 0.107, 1e-9);
  EXPECT_NEAR(panda.fk(zero).translation().x(), 0.088, 1e-9);
  const Robot iiwa = Robot::builtin("iiwa14");
  EXPECT_NEAR(iiwa.fk(zero).translation().head<2>().norm(), 0.0, 1e-9);
  EXPECT_NEAR(iiwa.fk(zero).translation().z(), 0.36 + 0.42 + 0.4 + 0.126, 1e-9);
  const Robot ur10 = Robot::builtin("ur10");
  EXPECT_NEAR(distance(ur10, Eigen::VectorXd::Zero(6), "upper_arm_link", "forearm_link"),
              std::hypot(0.612, 0.0), 0.2);
}

TEST(Urdf, cut_at_any_byte_it_is_a_load_error) {
  const std::string whole = file_text(urdf_path("panda"));
  ASSERT_EQ(load_and_check(whole), "");
  const std::size_t end = whole.rfind("</robot>");
  for (std::size_t length = 1; length < end; length += 50) {
    EXPECT_EQ(load_and_check(whole.substr(0, length)), "LoadError") << "cut at byte " << length;
  }
}

TEST(Urdf, with_any_byte_changed_it_is_a_load_error_or_a_valid_robot) {
  const std::string whole = file_text(urdf_path("panda"));
  Random random(50);
  int refused = 0, valid = 0;
  for (std::size_t at = 0; at < whole.size(); at += 7) {
    std::string changed = whole;
    changed[at] = static_cast<char>(random.integer(32, 126));
    const std::string outcome = load_and_check(changed);
    EXPECT_TRUE(outcome.empty() || outcome == "LoadError")
        << "byte " << at << " now " << changed[at] << ": " << outcome;
    ++(outcome.empty() ? valid : refused);
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(valid, 50);
}

TEST(Urdf, values_that_are_not_finite_numbers_or_make_no_sense_are_load_errors) {
  const std::string whole = file_text(urdf_path("panda"));
  const std::string origin = "<origin xyz=\"0 0 0.333\"/>", axis = "<axis xyz=\"0 0 1\"/>",
                    lower = "lower=\"-2.8973\"", type = "type=\"revolute\"",
                    child = "<child link=\"panda_link1\"/>";
  EXPECT_EQ(load_and_check(with(whole, origin, "<origin xyz=\"0 0 0.3 1\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, origin, "<origin xyz=\"nan 0 0\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, origin, "<origin xyz=\"0 inf 0\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, origin, "<origin rpy=\"0 nan 0\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, axis, "<axis xyz=\"0 0 0\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, axis, "<axis xyz=\"0 nan 1\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, lower, "lower=\"nan\"")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, lower, "lower=\"3.0\"")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, lower, "lower=\"-inf\"")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, lower, "lower=\"left\"")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, type, "type=\"planar\"")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, type, "type=\"floating\"")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, child, "<child link=\"panda_link9\"/>")), "LoadError");
  EXPECT_EQ(load_and_check(with(whole, child, "<child link=\"panda_link0\"/>")), "LoadError");
}

TEST(Urdf, nothing_empty_text_and_files_that_are_not_there_are_load_errors_that_name_the_file) {
  EXPECT_EQ(load_and_check("<"), "LoadError");
  EXPECT_EQ(load_and_check("<robot/>"), "LoadError");
  EXPECT_EQ(load_and_check("<robot name=\"r\"/>"), "LoadError");
  EXPECT_EQ(load_and_check(" \n "), "LoadError");
  EXPECT_THROW(Robot::from_urdf(""), LoadError);
  EXPECT_THROW(Robot::from_urdf(std::filesystem::temp_directory_path().string()), LoadError);
  try {
    Robot::from_urdf("/nowhere/at_all.urdf");
    FAIL();
  } catch (const LoadError& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/at_all.urdf"), std::string::npos);
  }
}

TEST(Urdf, a_byte_order_mark_and_leading_blanks_do_not_hide_the_xml) {
  const std::string whole = file_text(urdf_path("ur10"));
  const std::string body = whole.substr(whole.find("<robot"));
  EXPECT_EQ(load_and_check("  \n" + body), "");
}

TEST(Urdf, velocity_and_effort_limits_that_are_left_out_are_none_and_a_warning_says_so) {
  const auto arm = [](const std::string& limit) {
    return Robot::from_urdf(
        R"(<robot name="arm"><link name="a"/><link name="b"/><!-- <limit --><joint name="j" type="revolute">)"
        R"(<parent link="a"/><child link="b"/><axis xyz="0 0 1"/>)" +
        limit + "</joint></robot>");
  };
  const std::string no_velocity = "no velocity limit: taken as unlimited at j";
  const std::string no_effort = "no effort limit: taken as unlimited at j";
  using Lines = std::vector<std::string>;

  const Robot bare = arm(R"(<limit lower="-1" upper="2"/>)");
  EXPECT_TRUE(std::isinf(bare.velocity()(0)));
  EXPECT_TRUE(std::isinf(bare.effort()(0)));
  EXPECT_EQ(bare.lower()(0), -1.0);
  EXPECT_EQ(bare.upper()(0), 2.0);
  EXPECT_EQ(bare.warnings(), (Lines{no_velocity, no_effort}));

  const Robot weak = arm("<limit\n lower='-1' upper='2' effort = '3' ></limit>");
  EXPECT_TRUE(std::isinf(weak.velocity()(0)));
  EXPECT_EQ(weak.effort()(0), 3.0);
  EXPECT_EQ(weak.warnings(), Lines{no_velocity});

  const Robot whole = arm(R"(<limit effort="3" velocity="0.5" lower="-1" upper="2"/>)");
  EXPECT_EQ(whole.velocity()(0), 0.5);
  EXPECT_TRUE(whole.warnings().empty());

  const Robot locked = arm(R"(<limit effort="3" velocity="0.5"/>)");
  EXPECT_EQ(locked.lower()(0), 0.0);
  EXPECT_EQ(locked.upper()(0), 0.0);
  EXPECT_EQ(locked.warnings(),
            Lines{"lower and upper limit are 0, as where URDF gives none: locked at j"});
}

TEST(Urdf, a_mimic_joint_whose_limits_are_filled_in_with_zeros_does_not_lock_the_one_it_follows) {
  for (const std::string limits :
       {R"(lower="0" upper="0")", R"(lower="0" upper="-0")", R"(lower="0.1" upper="0")", ""}) {
    SCOPED_TRACE(limits);
    const Robot robot = Robot::from_urdf(
        R"(<robot name="gripper"><link name="palm"/><link name="left"/><link name="right"/>
    <joint name="slide" type="prismatic"><parent link="palm"/><child link="left"/><axis xyz="0 1 0"/>
      <limit lower="0" upper="0.04" effort="1" velocity="0.2"/></joint>
    <joint name="follow" type="prismatic"><parent link="palm"/><child link="right"/><axis xyz="0 1 0"/>
      <limit )" +
        limits + R"( effort="1" velocity="0.2"/><mimic joint="slide" multiplier="-1"/></joint>
    </robot>)");
    EXPECT_EQ(robot.lower()[0], 0.0);
    EXPECT_EQ(robot.upper()[0], 0.04);
    ASSERT_EQ(robot.warnings().size(), 1U);
    EXPECT_NE(robot.warnings()[0].find("follow"), std::string::npos);
  }
}

TEST(Urdf, mimic_tags_prismatic_and_continuous_joints_arrive) {
  const Robot robot = Robot::from_urdf(R"(<robot name="gripper">
    <link name="palm"/><link name="left"/><link name="right"/><link name="wheel"/>
    <joint name="slide" type="prismatic"><parent link="palm"/><child link="left"/><axis xyz="0 1 0"/>
      <limit lower="0" upper="0.04" effort="1" velocity="0.2"/></joint>
    <joint name="follow" type="prismatic"><parent link="palm"/><child link="right"/><axis xyz="0 1 0"/>
      <limit lower="-0.03" upper="0" effort="1" velocity="0.2"/><mimic joint="slide" multiplier="-1"/></joint>
    <joint name="spin" type="continuous"><parent link="palm"/><child link="wheel"/><axis xyz="1 0 0"/></joint>
    </robot>)");
  EXPECT_EQ(robot.joint_names(), (std::vector<std::string>{"slide", "spin"}));
  EXPECT_EQ(robot.joint_types(),
            (std::vector<JointType>{JointType::Prismatic, JointType::Continuous}));
  EXPECT_DOUBLE_EQ(robot.upper()[0], 0.03);  // the follower's limit holds too
  EXPECT_TRUE(std::isinf(robot.upper()[1]));
  const Eigen::Vector2d q(0.01, 0.5);
  EXPECT_NEAR(robot.fk(q, "left").translation().y(), 0.01, 1e-15);
  EXPECT_NEAR(robot.fk(q, "right").translation().y(), -0.01, 1e-15);
}

}  // namespace
}  // namespace pdoik
