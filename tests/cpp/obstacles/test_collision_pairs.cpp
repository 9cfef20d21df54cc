#include <gtest/gtest.h>

#include <map>

#include "brute_force.hpp"
#include "hulls/self_collision.hpp"
#include "obstacles/collision_state.hpp"
#include "pdoik/collision_pairs.hpp"
#include "random_robots.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

/// a -turns- b -slides- c -turns- d, with a ball each, in this order on a line.
Robot four_links(double ball_a, double ball_c, double ball_d) {
  RobotDescription description;
  description.name = "four";
  for (const char* link : {"a", "b", "c", "d"}) description.links.push_back({.name = link});
  description.joints = {joint_between("a", "b", "turn", JointType::Continuous),
                        joint_between("b", "c", "slide", JointType::Prismatic, 1.0, 2.0),
                        joint_between("c", "d", "swing", JointType::Revolute, -1.5, 1.5)};
  description.joints[2].T_parent_child.translation().z() = 3.0;
  description.joints[2].axis = Eigen::Vector3d::UnitX();
  Robot robot(description);
  robot.set_occupancy(
      {{{"a", {0, 0, 0}, ball_a}, {"c", {0, 0, 0}, ball_c}, {"d", {0, 0, 1}, ball_d}}, {}});
  return robot;
}

TEST(IgnoredPairs, are_kept_as_given_and_name_what_is_unknown) {
  Robot robot = four_links(0.1, 0.1, 0.1);
  EXPECT_TRUE(robot.ignored_pairs().empty());
  const std::vector<LinkPair> pairs{{"a", "c"}, {"c", "a"}, {"a", "c"}, {"d", "d"}};
  robot.set_ignored_pairs(pairs);
  EXPECT_EQ(robot.ignored_pairs(), pairs);
  try {
    robot.set_ignored_pairs({{"a", "b"}, {"c", "hand"}});
    FAIL() << "an unknown link was accepted";
  } catch (const std::invalid_argument& error) {
    for (const char* word : {"pairs[1]", "'hand'", "'four'", "a, b, c, d"})
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
  EXPECT_EQ(robot.ignored_pairs(), pairs);
}

TEST(CollisionPairs, those_that_always_touch_are_found_at_the_share_they_touch_in) {
  // The balls on a and c touch where the slide is below the sum of their radii: in half of its
  // range.
  Robot robot = four_links(0.7, 0.8, 0.2);
  using Pairs = std::vector<LinkPair>;
  EXPECT_EQ(pairs_always_touching(robot), Pairs{});
  EXPECT_EQ(pairs_always_touching(robot, 2000, 0, 0.45), (Pairs{{"a", "c"}}));
  EXPECT_EQ(pairs_always_touching(robot, 2000, 0, 0.55), Pairs{});
  robot = four_links(1.0, 1.2, 0.2);
  EXPECT_EQ(pairs_always_touching(robot), (Pairs{{"a", "c"}}));  // 2.2 > 2
  robot.set_ignored_pairs({{"c", "a"}});
  EXPECT_EQ(pairs_always_touching(robot), (Pairs{{"a", "c"}}));  // found again
}

TEST(CollisionPairs, those_that_touch_at_a_configuration_do_so_there) {
  const Robot robot = four_links(0.7, 0.8, 2.5);
  EXPECT_EQ(pairs_touching_at(robot, Eigen::Vector3d(0.3, 1.4, 0.0)),
            (std::vector<LinkPair>{{"a", "c"}}));
  EXPECT_TRUE(pairs_touching_at(robot, Eigen::Vector3d(0.3, 1.6, 0.0)).empty());
  EXPECT_THROW(pairs_touching_at(robot, Eigen::Vector2d::Zero()), std::invalid_argument);
}

TEST(CollisionPairs, misuse_is_refused) {
  const Robot robot = four_links(0.1, 0.1, 0.1);
  EXPECT_THROW(pairs_always_touching(robot, 0), std::invalid_argument);
  for (const double share : {0.0, -1.0, 1.1, std::nan("")})
    EXPECT_THROW(pairs_always_touching(robot, 10, 0, share), std::invalid_argument);
}

TEST(CollisionPairs, a_robot_without_hulls_has_none) {
  Robot robot = Robot::builtin("panda");
  robot.set_occupancy({});
  EXPECT_TRUE(pairs_always_touching(robot, 10).empty());
  EXPECT_TRUE(pairs_touching_at(robot, robot.mid_configuration()).empty());
}

/// In how many of 2000 random configurations any of the tested pairs touches.
double share_of_collisions(const Robot& robot) {
  const detail::HullModel model(robot);
  detail::SelfCollision self(robot, model, 0.0);
  std::vector<Eigen::Isometry3d> poses(robot.bodies().size());
  detail::CollisionState placed(model, model.moving);
  Random random(11);
  int touching = 0;
  for (int k = 0; k < 2000; ++k) {
    robot.body_poses(random_configuration(robot, random), poses);
    placed.place(poses);
    self.place(placed.positions(), placed.frames());
    touching += self.least().distance < 0.0;
  }
  return touching / 2000.0;
}

TEST(CollisionPairs, of_the_arms_are_those_whose_hulls_overlap_whatever_the_configuration) {
  for (const std::string name : {"panda", "ur10", "iiwa14"}) {
    Robot robot = Robot::builtin(name);
    robot.set_ignored_pairs({});
    EXPECT_TRUE(pairs_always_touching(robot).empty()) << name << ", by its capsules";
  }
  const std::map<std::string, std::vector<LinkPair>> expected{
      {"panda", {}}, {"ur10", {}}, {"iiwa14", {{"iiwa_link_5", "iiwa_link_7"}}}};
  for (const auto& [name, pairs] : expected) {
    SCOPED_TRACE(name);
    Robot robot = without_capsules(Robot::builtin(name));
    robot.set_ignored_pairs({});
    EXPECT_EQ(pairs_always_touching(robot), pairs);
    EXPECT_EQ(pairs_always_touching(robot, 2000, 1), pairs);  // no matter of luck
    EXPECT_EQ(share_of_collisions(robot) == 1.0, !pairs.empty());
    robot.set_ignored_pairs(pairs);
    EXPECT_LT(share_of_collisions(robot), 0.8);
    EXPECT_GT(share_of_collisions(robot), 0.001);
  }
}

}  // namespace
}  // namespace pdoik
