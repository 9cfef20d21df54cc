#include <gtest/gtest.h>

#include <functional>

#include "pdoik/errors.hpp"
#include "pdoik/robot.hpp"
#include "random_robots.hpp"

namespace pdoik {
namespace {

using pdoik::testing::joint_between;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// base - shoulder - upper - elbow - lower - wrist - hand, all revolute in [-1, 1].
RobotDescription small_arm() {
  RobotDescription description;
  description.name = "small";
  description.links = {{.name = "base"}, {.name = "upper"}, {.name = "lower"}, {.name = "hand"}};
  const char* names[] = {"shoulder", "elbow", "wrist"};
  for (std::size_t i = 0; i < 3; ++i) {
    JointDescription joint = joint_between(description.links[i].name, description.links[i + 1].name,
                                           names[i], JointType::Revolute);
    joint.T_parent_child.translation().x() = 0.3;
    description.joints.push_back(joint);
  }
  return description;
}

/// The description, broken by `breakage`, must be refused with a LoadError that holds every one of
/// `words`.
void expect_refused(const std::function<void(RobotDescription&)>& breakage,
                    const std::vector<std::string>& words, const std::string& base = {},
                    const std::vector<std::string>& tips = {}) {
  RobotDescription description = small_arm();
  ASSERT_NO_THROW(Robot{description});
  breakage(description);
  try {
    const Robot robot(description, base, tips);
    FAIL() << "was accepted; expected a LoadError with '" << words.front() << "'";
  } catch (const LoadError& error) {
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << error.what() << " lacks " << word;
    }
  }
}

void leave(RobotDescription&) {}

TEST(RobotErrors, a_loop_is_refused) {
  expect_refused([](RobotDescription& d) { d.joints[0].parent_link = "hand"; }, {"loop"});
  expect_refused(  // a loop beside a healthy tree
      [](RobotDescription& d) {
        d.links.push_back({.name = "x"}), d.links.push_back({.name = "y"});
        d.joints.push_back(joint_between("x", "y", "xy"));
        d.joints.push_back(joint_between("y", "x", "yx"));
      },
      {"loop", "x", "y"});
  expect_refused([](RobotDescription& d) { d.joints[1].child_link = "upper"; }, {"elbow", "upper"});
}

TEST(RobotErrors, a_second_parent_is_refused_naming_both_joints) {
  expect_refused(
      [](RobotDescription& d) { d.joints.push_back(joint_between("base", "hand", "extra")); },
      {"hand", "two parents", "wrist", "extra"});
}

TEST(RobotErrors, two_roots_are_refused) {
  expect_refused([](RobotDescription& d) { d.links.push_back({.name = "loose"}); },
                 {"loose", "base"});
}

TEST(RobotErrors, links_that_are_not_there_are_named) {
  expect_refused(leave, {"pelvis", "base"}, "pelvis");
  expect_refused(leave, {"finger", "hand"}, "base", {"hand", "finger"});
  expect_refused([](RobotDescription& d) { d.joints[1].parent_link = "torso"; },
                 {"elbow", "torso"});
  expect_refused([](RobotDescription& d) { d.joints[1].child_link = "torso"; }, {"elbow", "torso"});
  expect_refused([](RobotDescription& d) { d.links.clear(), d.joints.clear(); }, {"no links"});
}

TEST(RobotErrors, names_used_twice_are_refused) {
  expect_refused([](RobotDescription& d) { d.links.push_back({.name = "hand"}); },
                 {"two links", "hand"});
  expect_refused([](RobotDescription& d) { d.joints[2].name = "elbow"; }, {"two joints", "elbow"});
}

TEST(RobotErrors, an_axis_without_direction_is_refused) {
  for (const Eigen::Vector3d& axis :
       {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(0.0, kNan, 1.0),
        Eigen::Vector3d(kInfinity, 0.0, 0.0)}) {
    expect_refused([&](RobotDescription& d) { d.joints[1].axis = axis; }, {"elbow", "axis"});
  }
}

TEST(RobotErrors, limits_out_of_order_or_half_open_or_not_numbers_are_refused) {
  const double bad[][2] = {{1.0, -1.0},       {kNan, 1.0},       {-1.0, kNan},
                           {-kInfinity, 1.0}, {-1.0, kInfinity}, {-kInfinity, kInfinity}};
  for (const auto& [lower, upper] : bad) {
    expect_refused([low = lower, high = upper](
                       RobotDescription& d) { d.joints[1].lower = low, d.joints[1].upper = high; },
                   {"elbow", "limit"});
  }
}

TEST(RobotErrors, an_origin_that_is_not_finite_is_refused) {
  expect_refused([](RobotDescription& d) { d.joints[2].T_parent_child.translation().y() = kNan; },
                 {"wrist", "origin"});
}

TEST(RobotErrors, an_origin_that_is_no_rotation_is_refused) {
  const std::vector<std::string> words = {"elbow", "origin is not a rigid transform"};
  expect_refused([](RobotDescription& d) { d.joints[1].T_parent_child.linear() *= 1.001; }, words);
  expect_refused([](RobotDescription& d) { d.joints[1].T_parent_child(1, 0) = 7e37; }, words);
  expect_refused([](RobotDescription& d) { d.joints[1].T_parent_child(2, 2) = -1.0; }, words);
}

TEST(RobotErrors, mimicking_nobody_oneself_a_circle_or_a_fixed_joint_is_refused) {
  expect_refused([](RobotDescription& d) { d.joints[2].mimic = Mimic{"thumb"}; },
                 {"wrist", "thumb"});
  expect_refused([](RobotDescription& d) { d.joints[2].mimic = Mimic{"wrist"}; },
                 {"wrist", "circle"});
  expect_refused(
      [](RobotDescription& d) {
        d.joints[1].mimic = Mimic{"wrist"};
        d.joints[2].mimic = Mimic{"elbow"};
      },
      {"circle"});
  expect_refused(
      [](RobotDescription& d) {
        d.joints[1].type = JointType::Fixed;
        d.joints[2].mimic = Mimic{"elbow"};
      },
      {"wrist", "elbow", "fixed"});
  expect_refused([](RobotDescription& d) { d.joints[2].mimic = Mimic{"elbow", kNan}; }, {"wrist"});
}

TEST(RobotErrors, a_slide_whose_limits_are_the_same_infinity_is_refused) {
  for (const double limit : {-kInfinity, kInfinity}) {
    expect_refused(
        [&](RobotDescription& d) {
          d.joints[1].type = JointType::Prismatic;
          d.joints[1].lower = d.joints[1].upper = limit;
        },
        {"elbow", "limits"});
  }
}

TEST(RobotErrors, followers_of_followers_whose_multipliers_overflow_are_refused) {
  expect_refused(
      [](RobotDescription& d) {
        d.joints[1].mimic = Mimic{"shoulder", 1e4};
        d.joints[2].mimic = Mimic{"elbow", 1e4};
      },
      {"wrist", "shoulder", "finite"});
}

TEST(RobotErrors, speed_and_effort_limits_that_are_negative_or_not_numbers_are_refused) {
  for (const double bad : {-1.0, kNan, -kInfinity}) {
    expect_refused([&](RobotDescription& d) { d.joints[1].velocity = bad; }, {"elbow", "velocity"});
    expect_refused([&](RobotDescription& d) { d.joints[1].effort = bad; }, {"elbow", "effort"});
  }
}

TEST(RobotErrors, followers_whose_limits_exclude_their_leaders_are_refused) {
  expect_refused([](RobotDescription& d) { d.joints[2].mimic = Mimic{"elbow", 1.0, 5.0}; },
                 {"wrist", "elbow", "limit"});
  expect_refused(  // limits so far beyond the leader's that they overflow
      [](RobotDescription& d) {
        d.joints[1].type = JointType::Prismatic;
        d.joints[1].lower = -kInfinity, d.joints[1].upper = kInfinity;
        d.joints[2].lower = 1e200, d.joints[2].upper = 1e300;
        d.joints[2].mimic = Mimic{"elbow", 1e-200};
      },
      {"wrist", "elbow", "limit"});
}

TEST(RobotErrors, misuse_of_a_robot_throws_invalid_argument) {
  const Robot robot(small_arm());
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(3), wrong = Eigen::VectorXd::Zero(4);
  std::vector<Eigen::Isometry3d> poses;
  EXPECT_NO_THROW(robot.fk(q, "lower"));
  EXPECT_THROW(robot.fk(wrong), std::invalid_argument);
  EXPECT_THROW(robot.jacobian(wrong), std::invalid_argument);
  EXPECT_THROW(robot.body_poses(wrong, poses), std::invalid_argument);
  EXPECT_THROW(robot.fk(q, 4), std::invalid_argument);
  EXPECT_THROW(robot.fk(q, "finger"), std::invalid_argument);
  EXPECT_THROW(Robot::from_dh({}), std::invalid_argument);
  EXPECT_THROW(Robot::builtin("r2d2"), std::invalid_argument);
  EXPECT_FALSE(robot.find_link("finger").has_value());
  RobotDescription two_hands = small_arm();
  two_hands.links.push_back({.name = "other"});
  two_hands.joints.push_back(joint_between("lower", "other", "o"));
  EXPECT_THROW(Robot(two_hands).fk(q), std::invalid_argument);  // which tip?
}

TEST(RobotErrors, an_occupancy_that_cannot_be_is_refused_and_the_old_one_stays) {
  Robot robot(small_arm());
  Occupancy good;
  good.spheres.push_back({"hand", Eigen::Vector3d::Zero(), 0.1});
  robot.set_occupancy(good);
  const auto refused = [&](const Occupancy& bad) {
    EXPECT_THROW(robot.set_occupancy(bad), std::invalid_argument);
    EXPECT_EQ(robot.occupancy().size(), 1U);
  };
  for (const double radius : {0.0, -0.1, kNan, kInfinity}) {
    Occupancy bad;
    bad.spheres.push_back({"hand", Eigen::Vector3d::Zero(), radius});
    refused(bad);
  }
  const Eigen::Vector3d right(0.1, 0.0, 0.0), nan(kNan, 0.0, 0.0);
  for (const double semi_major :
       {-0.2, 0.0, 0.05, 0.1, kNan, kInfinity}) {  // the foci are 0.2 apart
    Occupancy bad;
    bad.spheroids.push_back({"hand", -right, "hand", right, semi_major});
    refused(bad);
  }
  Occupancy unknown, not_finite, apart;
  unknown.spheres.push_back({"finger", right, 0.1});
  refused(unknown);
  not_finite.spheroids.push_back({"hand", nan, "hand", right, 0.2});
  refused(not_finite);
  apart.spheroids.push_back(
      {"upper", right, "hand", right, 0.05});  // may come close enough as joints move
  EXPECT_NO_THROW(robot.set_occupancy(apart));
}

TEST(RobotErrors, inertias_of_no_real_body_are_warned_of_and_real_ones_are_not) {
  const auto warnings = [](double mass, const Eigen::Vector3d& moments) {
    RobotDescription description = small_arm();
    description.links[1].mass = mass;
    description.links[1].inertia = moments.asDiagonal();
    const Robot robot(description);
    for (const std::string& warning : robot.warnings()) {
      EXPECT_NE(warning.find("upper"), std::string::npos) << warning;
    }
    return robot.warnings().size();
  };
  EXPECT_EQ(warnings(0.0, {0.0, 0.0, 0.0}), 0U);
  EXPECT_EQ(warnings(1.0, {0.1, 0.1, 0.1}), 0U);
  EXPECT_EQ(warnings(1.0, {0.0, 0.1, 0.1}), 0U);    // a rod, on the border
  EXPECT_EQ(warnings(1.0, {0.05, 0.05, 0.1}), 0U);  // a disc, on the border
  EXPECT_EQ(warnings(1.0, {0.05, 0.04, 0.1}), 1U);
  EXPECT_EQ(warnings(1.0, {-0.01, 0.1, 0.1}), 1U);
  EXPECT_EQ(warnings(-1.0, {0.1, 0.1, 0.1}), 1U);
  EXPECT_EQ(warnings(0.0, {0.1, 0.1, 0.1}), 1U);
  EXPECT_EQ(warnings(kNan, {0.1, 0.1, 0.1}), 1U);
  EXPECT_EQ(warnings(1.0, {kNan, 0.1, 0.1}), 1U);
}

}  // namespace
}  // namespace pdoik
