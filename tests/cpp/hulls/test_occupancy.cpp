#include <gtest/gtest.h>

#include <cmath>

#include "arms.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/occupancy.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

void expect_equal(const Occupancy& a, const Occupancy& b) {
  ASSERT_EQ(a.spheres.size(), b.spheres.size());
  ASSERT_EQ(a.spheroids.size(), b.spheroids.size());
  for (std::size_t i = 0; i < a.spheres.size(); ++i) {
    EXPECT_EQ(a.spheres[i].link, b.spheres[i].link);
    EXPECT_EQ(a.spheres[i].center, b.spheres[i].center);
    EXPECT_EQ(a.spheres[i].radius, b.spheres[i].radius);
  }
  for (std::size_t i = 0; i < a.spheroids.size(); ++i) {
    EXPECT_EQ(a.spheroids[i].link_a, b.spheroids[i].link_a);
    EXPECT_EQ(a.spheroids[i].link_b, b.spheroids[i].link_b);
    EXPECT_EQ(a.spheroids[i].focus_a, b.spheroids[i].focus_a);
    EXPECT_EQ(a.spheroids[i].focus_b, b.spheroids[i].focus_b);
    EXPECT_EQ(a.spheroids[i].semi_major, b.spheroids[i].semi_major);
  }
}

TEST(Occupancy, yaml_that_was_written_is_read_back_to_the_last_bit) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_robot(random, kMixedTree);
    const int spheres = random.integer(0, 4);
    Occupancy occupancy = random_occupancy(robot, random, spheres, random.integer(0, 4));
    if (spheres > 0) occupancy.spheres[0].center = {1e-300, -0.0, 1.0 / 3.0};
    if (spheres > 1) occupancy.spheres[1].link = "a: {strange} 'name' # of \"7\"";
    if (spheres > 2) occupancy.spheres[2].link = "12";  // must stay a word
    expect_equal(load_occupancy(to_yaml(occupancy)), occupancy);
  }
  expect_equal(load_occupancy(to_yaml(Occupancy{})), Occupancy{});
}

TEST(Occupancy, cut_at_any_byte_it_is_a_load_error_or_an_occupancy) {
  const std::string whole = to_yaml(with_hulls(Robot::builtin("panda")).occupancy());
  int refused = 0;
  for (std::size_t length = 0; length < whole.size(); length += 17) {
    try {
      const Occupancy read = load_occupancy(whole.substr(0, length) + "\n");
      EXPECT_LE(read.size(), 20U);
    } catch (const LoadError& error) {
      EXPECT_FALSE(std::string(error.what()).empty());
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(Occupancy, entries_that_make_no_sense_are_load_errors_that_name_the_entry) {
  const auto refused = [](const std::string& text, const std::string& word) {
    try {
      (void)load_occupancy(text);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const LoadError& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused("spheres: [{link: a, center: [0, 0], radius: 1}]", "center");
  refused("spheres: [{link: a, center: [0, 0, up], radius: 1}]", "center");
  refused("spheres: [{link: a, center: [0, 0, .nan], radius: 1}]", "center");
  refused("spheres: [{link: a, center: [0, 0, 0]}]", "radius");
  refused("spheres: [{link: a, center: [0, 0, 0], radius: wide}]", "radius");
  refused("spheres: [{center: [0, 0, 0], radius: 1}]", "link");
  refused("spheres: [7]", "spheres[0]");
  refused("spheres: {link: a}", "spheres");
  refused("spheroids: [{link_a: a, focus_a: [0, 0, 0], link_b: a, focus_b: [0, 0, 1]}]",
          "semi_major");
  refused("balls: []", "balls");
  refused("spheres: [{link: a", "YAML");
  refused("spheres: [{link: \xdc, center: [0, 0, 0], radius: 1}]", "UTF-8");
  refused("spheres: [{link: , center: [0, 0, 0], radius: 1}]", "link");
  for (const char* no_character :
       {"\xEF\xBF\xBF", "\xEF\xBF\xBE", "\xEF\xB7\x90", "\xF0\x9F\xBF\xBF"})
    refused("spheres: [{link: a" + std::string(no_character) + ", center: [0, 0, 0], radius: 1}]",
            "link");
  for (const char* character :
       {"\xEF\xBF\xBD", "\xEF\xB7\x8F", "\xEF\xB7\xB0", "\xF0\x9F\xBF\xBD"}) {
    const std::string name = "a" + std::string(character);
    const Occupancy read =
        load_occupancy("spheres: [{link: " + name + ", center: [0, 0, 0], radius: 1}]");
    EXPECT_EQ(read.spheres[0].link, name);
    expect_equal(load_occupancy(to_yaml(read)), read);
  }
  refused("/nowhere/at_all.yaml", "/nowhere/at_all.yaml");
  refused("/", "cannot read");
}

}  // namespace
}  // namespace pdoik
