#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "pdoik/collision_pairs.hpp"
#include "pdoik/errors.hpp"

namespace pdoik {
namespace {

const std::string kPandaSrdf = R"(<?xml version="1.0" encoding="UTF-8"?>
<!-- as MoveIt's Setup Assistant writes it -->
<robot name="panda">
  <group name="arm"><chain base_link="panda_link0" tip_link="panda_link7"/></group>
  <group_state name="ready" group="arm"><joint name="panda_joint1" value="0"/></group_state>
  <virtual_joint name="virtual_joint" type="fixed" parent_frame="world" child_link="panda_link0"/>
  <disable_collisions link1="panda_link0" link2="panda_link1" reason="Adjacent"/>
  <!-- <disable_collisions link1="panda_link0" link2="panda_link7"/> -->
  <disable_collisions link1="panda_link5" link2="panda_link7" reason="Default"/>
  <disable_collisions link1="panda_link2" link2="panda_link0"/>
</robot>)";

const std::vector<LinkPair> kPandaPairs{
    {"panda_link0", "panda_link1"}, {"panda_link5", "panda_link7"}, {"panda_link2", "panda_link0"}};

TEST(Srdf, pairs_come_in_the_files_order_and_fit_the_robot) {
  EXPECT_EQ(load_srdf_pairs(kPandaSrdf), kPandaPairs);
  Robot robot = Robot::builtin("panda");
  robot.set_ignored_pairs(load_srdf_pairs(kPandaSrdf));
  EXPECT_EQ(robot.ignored_pairs(), kPandaPairs);
  EXPECT_TRUE(load_srdf_pairs("<robot name='none'/>").empty());
  EXPECT_EQ(load_srdf_pairs("\xEF\xBB\xBF" + kPandaSrdf), kPandaPairs);
}

TEST(Srdf, pairs_of_links_that_a_robot_has_not_are_left_out) {
  const Robot robot = Robot::builtin("panda");
  const std::string more =
      "<robot name='panda'><disable_collisions link1='panda_hand' link2='panda_link7'/>" +
      kPandaSrdf.substr(kPandaSrdf.find("<disable"));
  EXPECT_EQ(load_srdf_pairs(more).size(), kPandaPairs.size() + 1);
  EXPECT_EQ(load_srdf_pairs(more, robot), kPandaPairs);
}

TEST(Srdf, what_is_off_by_default_is_off_but_for_pairs_that_are_on) {
  const std::string text = R"(<robot name="panda">
  <enable_collisions link1="panda_link3" link2="panda_link6"/>
  <enable_collisions link1="panda_link1" link2="panda_link6"/>
  <disable_default_collisions link="panda_link6"/>
  <disable_default_collisions link="panda_hand"/>
  <disable_collisions link1="panda_link6" link2="panda_link1"/>
</robot>)";
  const Robot robot = Robot::builtin("panda");
  const std::vector<LinkPair> pairs = load_srdf_pairs(text, robot);
  // With itself it is no pair, with link 3 it is looked at; what is off after all comes once.
  EXPECT_EQ(pairs.size(), robot.link_names().size() - 2);
  EXPECT_EQ(pairs.front(), LinkPair("panda_link6", "panda_link1"));
  for (const LinkPair& pair : pairs) {
    EXPECT_EQ(pair.first, "panda_link6");
    EXPECT_NE(pair.second, "panda_link3");
  }
  const std::vector<ContactRule> rules = load_srdf_contacts(text);
  ASSERT_EQ(rules.size(), 5U);
  EXPECT_EQ(rules[0], (ContactRule{.one = "panda_link6", .other = "*", .optional = true}));
  EXPECT_EQ(rules[2], (ContactRule{"panda_link3", "panda_link6", std::nullopt, true}));
  EXPECT_EQ(rules[4],
            (ContactRule{.one = "panda_link6", .other = "panda_link1", .optional = true}));
  for (const LinkPair& pair : kPandaPairs) {
    const auto is_it = [&](const ContactRule& rule) {
      return rule.one == pair.first && rule.other == pair.second;
    };
    EXPECT_TRUE(std::ranges::any_of(load_srdf_contacts(kPandaSrdf), is_it));
  }
}

TEST(Srdf, a_files_path_does_as_well) {
  const std::string path = ::testing::TempDir() + "pdoik_test.srdf";
  std::ofstream(path) << kPandaSrdf;
  EXPECT_EQ(load_srdf_pairs(path), kPandaPairs);
  std::remove(path.c_str());
}

void expect_refused(const std::string& path_or_xml, const std::vector<std::string>& words) {
  try {
    load_srdf_pairs(path_or_xml);
    FAIL() << "was accepted; expected a LoadError with '" << words.front() << "'";
  } catch (const LoadError& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(Srdf, what_cannot_be_read_is_refused_by_name) {
  expect_refused("/nowhere/panda.srdf", {"cannot read", "SRDF", "'/nowhere/panda.srdf'"});
  expect_refused("", {"SRDF", "empty"});
  expect_refused("<robot name='a'>\n<disable_collisions link1='a'/>\n</robot>",
                 {"the SRDF text", "<disable_collisions>", "line 2", "'link2'"});
  expect_refused("<robot><disable_collisions link1='' link2='b'/></robot>", {"'link1'"});
  expect_refused("<robot><disable_collisions link1='a' link2='b'></robot>", {"not valid XML"});
  expect_refused("<robot><disable_collisions link1='a' link2=b /></robot", {"not valid XML"});
  expect_refused("<robot><disable_collisions link1='a' link2='b'/>", {"not valid XML"});
  expect_refused("<urdf/>", {"<robot>", "<urdf>"});
  expect_refused("<!-- nothing -->", {"the SRDF text"});
  expect_refused("<robot><disable_default_collisions link='a'/></robot>",
                 {"<disable_default_collisions>", "the robot"});
  expect_refused("<robot xmlns:xacro='x'><xacro:hands/></robot>", {"<xacro:hands>", "xacro"});
  expect_refused(std::string("<robot>\0</robot>", 16), {"NUL"});
  expect_refused("<robot>\xC3\x28</robot>", {"UTF-8"});
  std::string deep = "<robot>";
  for (int k = 0; k < 10000; ++k) deep += "<a>";
  expect_refused(deep, {"nested"});
}

TEST(Srdf, every_cut_of_a_file_is_read_or_refused) {
  for (std::size_t length = 0; length < kPandaSrdf.size(); ++length) {
    try {
      load_srdf_pairs(kPandaSrdf.substr(length));
    } catch (const LoadError&) {
    }
    try {
      EXPECT_LE(load_srdf_pairs(kPandaSrdf.substr(0, length)).size(), kPandaPairs.size());
    } catch (const LoadError&) {
    }
  }
}

}  // namespace
}  // namespace pdoik
