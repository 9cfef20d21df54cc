#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "finite_differences.hpp"
#include "hulls/self_collision.hpp"
#include "kinematics/rollout.hpp"
#include "random_robots.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// --- Segments ---------------------------------------------------------------------------------

struct Segment {
  Eigen::Vector3d middle, half;
  Eigen::Vector3d at(double t) const { return middle + t * half; }
};

double point_distance(const Eigen::Vector3d& p, const Segment& segment) {
  const double square = segment.half.squaredNorm();
  const double t = square > 0.0 ? segment.half.dot(p - segment.middle) / square : 0.0;
  return (p - segment.at(std::clamp(t, -1.0, 1.0))).norm();
}

/// The distance to a segment is convex along another: golden sections find its minimum.
double searched_distance(const Segment& one, const Segment& two) {
  double low = -1.0, high = 1.0;
  double least = std::min(point_distance(one.at(low), two), point_distance(one.at(high), two));
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int k = 0; k < 90; ++k) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    const double at_left = point_distance(one.at(left), two);
    const double at_right = point_distance(one.at(right), two);
    least = std::min({least, at_left, at_right});
    (at_left < at_right ? high : low) = at_left < at_right ? right : left;
  }
  return least;
}

SegmentDistance distance_between(const Segment& one, const Segment& two) {
  return segment_distance(to_vec4(one.middle), to_vec4(one.half), to_vec4(two.middle),
                          to_vec4(two.half));
}

void expect_right(const Segment& one, const Segment& two, double tolerance = 1e-12) {
  const SegmentDistance found = distance_between(one, two);
  // Where it is tiny the search knows it to about the square root of a double's precision only.
  const double expected = searched_distance(one, two);
  EXPECT_LT(found.distance, expected + tolerance);
  EXPECT_GT(found.distance, expected - std::max(tolerance, 1e-7 - expected));
  EXPECT_LE(std::abs(found.t1), 1.0);
  EXPECT_LE(std::abs(found.t2), 1.0);
  EXPECT_LT((to_vector3(found.gap) - (one.at(found.t1) - two.at(found.t2))).norm(), 1e-14);
  EXPECT_NEAR(to_vector3(found.gap).norm(), found.distance, 1e-14);
  EXPECT_NEAR(distance_between(two, one).distance, found.distance, tolerance);
}

TEST(SegmentDistance, is_what_a_search_finds_whatever_the_lengths) {
  Random random(1);
  for (int k = 0; k < 4000; ++k) {
    SCOPED_TRACE(k);
    const auto length = [&] {
      return random.chance(0.2) ? 0.0 : std::pow(10.0, random.uniform(-9, 0));
    };
    expect_right({random.point(1.0), length() * random.direction()},
                 {random.point(1.0), length() * random.direction()});
    expect_right({random.point(0.3), random.direction()}, {random.point(0.3), random.direction()});
    if (HasFailure()) return;
  }
}

TEST(SegmentDistance, is_right_for_parallel_and_nearly_parallel_segments) {
  Random random(2);
  for (int k = 0; k < 4000; ++k) {
    SCOPED_TRACE(k);
    const Eigen::Vector3d along = random.direction();
    const double tilt = k % 3 == 0 ? 0.0 : std::pow(10.0, random.uniform(-17, -3));
    const Segment one{random.point(1.0), random.uniform(0.1, 1.0) * along};
    const Segment two{
        one.middle + random.point(k % 2 == 0 ? 1.0 : 0.01) + random.uniform(-2.0, 2.0) * along,
        random.uniform(-1.0, 1.0) * (along + tilt * random.direction())};
    expect_right(one, two);
    if (HasFailure()) return;
  }
}

TEST(SegmentDistance, of_parallel_segments_takes_the_middle_of_where_they_lie_side_by_side) {
  const Segment one{{0, 0, 0}, {2, 0, 0}}, two{{2, 1, 0}, {-1, 0, 0}};
  const SegmentDistance beside = distance_between(one, two);
  EXPECT_DOUBLE_EQ(beside.distance, 1.0);
  EXPECT_DOUBLE_EQ(one.at(beside.t1).x(), 1.5);
  EXPECT_DOUBLE_EQ(two.at(beside.t2).x(), 1.5);
  const Segment beyond{{5, 1, 0}, {1, 0, 0}};
  EXPECT_DOUBLE_EQ(distance_between(one, beyond).distance, std::sqrt(5.0));
  EXPECT_DOUBLE_EQ(distance_between(one, {{3, 0, 0}, {2, 0, 0}}).distance, 0.0);  // on one line
}

TEST(SegmentDistance, of_crossing_segments_is_nought) {
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    const Segment one{random.point(1.0), random.direction()};
    const Eigen::Vector3d along = random.direction();
    const Segment two{one.at(random.uniform(-1.0, 1.0)) + random.uniform(-1.0, 1.0) * along, along};
    EXPECT_LT(distance_between(one, two).distance, 1e-14);
  }
}

// --- Hulls of a moving robot ------------------------------------------------------------------

/// A robot with its hulls where Robot::fk and a rollout have them.
class Workbench {
 public:
  explicit Workbench(Robot r, double m = 0.0)
      : robot(std::move(r)),
        model(robot),
        margin(m),
        pairs(robot, model, margin),
        rollout_(robot),
        positions_(model.points.size()) {}

  void place(const Eigen::VectorXd& q) {
    const Eigen::VectorXd cosine = q.array().cos(), sine = q.array().sin();
    rollout_.forward(cosine.data(), sine.data(), q.data());
    for (std::size_t k = 0; k < positions_.size(); ++k)
      positions_[k] = transform(rollout_.frame(model.points[k].body), model.points[k].local);
    pairs.place(positions_.data(), &rollout_.frame(0));
  }
  double c(int pair, const Eigen::VectorXd& q) {
    place(q);
    return margin - pairs.distance(pair);
  }
  Eigen::VectorXd gradient(const SelfCollision::Near& near) {
    Eigen::VectorXd dq(robot.dof());
    rollout_.clear_wrenches();
    for (const auto& [body, point, dc_dpoint] : near.gradients)
      rollout_.add_force(body, point, dc_dpoint);
    rollout_.reverse(dq.data(), robot.dof());
    return dq;
  }

  /// A hull's foci by Robot::fk, and its half axes.
  struct Measured {
    Eigen::Vector3d a, b;
    double major, minor;
    Segment segment() const {
      const Eigen::Vector3d along =
          (b - a).norm() > 0.0 ? Eigen::Vector3d((b - a).normalized()) : Eigen::Vector3d::Zero();
      return {0.5 * (a + b), (major - minor) * along};
    }
    Eigen::Vector3d surface(Random& random) const {
      const Eigen::Vector3d n = random.direction();
      const Eigen::Vector3d along =
          (b - a).norm() > 0.0 ? Eigen::Vector3d((b - a).normalized()) : Eigen::Vector3d::UnitX();
      return 0.5 * (a + b) + minor * n + (major - minor) * n.dot(along) * along;
    }
  };
  Measured measured(int source, const Eigen::VectorXd& q) const {
    const Occupancy& o = robot.occupancy();
    const auto k = static_cast<std::size_t>(source);
    if (k < o.spheres.size()) {
      const Sphere& s = o.spheres[k];
      const Eigen::Vector3d centre = robot.fk(q, s.link) * s.center;
      return {centre, centre, s.radius, s.radius};
    }
    const Spheroid& s = o.spheroids[k - o.spheres.size()];
    const Eigen::Vector3d a = robot.fk(q, s.link_a) * s.focus_a,
                          b = robot.fk(q, s.link_b) * s.focus_b;
    const double square = s.semi_major * s.semi_major - 0.25 * (a - b).squaredNorm();
    return {a, b, s.semi_major, square > 0.0 ? std::sqrt(square) : 0.0};
  }

  Robot robot;
  HullModel model;
  double margin;
  SelfCollision pairs;

 private:
  Rollout rollout_;
  std::vector<Vec4> positions_;
};

template <class Check>
void for_random_trees(int seeds, Check&& check) {
  for (int seed = 1; seed <= seeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Robot robot = random_robot(random, seed % 2 == 0 ? kMixedTree : kSerial);
    robot.set_occupancy(random_occupancy(robot, random, 5, 8));
    Workbench bench(std::move(robot), random.chance(0.5) ? 0.0 : random.uniform(0.0, 0.1));
    check(bench, random);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(SelfCollision, distances_are_those_of_capsules_around_hulls_placed_by_robot_fk) {
  int compared = 0;
  for_random_trees(60, [&](Workbench& bench, Random& random) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    bench.place(q);
    for (int k = 0; k < bench.pairs.pair_count(); ++k) {
      const auto one = bench.measured(bench.pairs.pair(k).source[0], q);
      const auto two = bench.measured(bench.pairs.pair(k).source[1], q);
      if (one.minor == 0.0 || two.minor == 0.0) {
        EXPECT_EQ(bench.pairs.distance(k), kInfinity);
        continue;
      }
      EXPECT_NEAR(bench.pairs.distance(k),
                  searched_distance(one.segment(), two.segment()) - one.minor - two.minor, 1e-7);
      ++compared;
    }
  });
  EXPECT_GT(compared, 1000);
}

TEST(SelfCollision, hulls_are_never_nearer_to_each_other_than_their_capsules) {
  for_random_trees(30, [](Workbench& bench, Random& random) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    bench.place(q);
    for (int k = 0; k < bench.pairs.pair_count(); ++k) {
      const auto one = bench.measured(bench.pairs.pair(k).source[0], q);
      const auto two = bench.measured(bench.pairs.pair(k).source[1], q);
      if (one.minor == 0.0 || two.minor == 0.0) continue;
      for (int sample = 0; sample < 50; ++sample) {
        const Eigen::Vector3d p = one.surface(random);
        ASSERT_LT(point_distance(p, one.segment()), one.minor + 1e-12);  // in its own capsule
        ASSERT_LE(bench.pairs.distance(k), (p - two.surface(random)).norm() + 1e-12);
      }
    }
  });
}

TEST(SelfCollision, gradients_are_central_differences) {
  int checked = 0, spanning = 0, settled = 0, spheres = 0;
  for_random_trees(150, [&](Workbench& bench, Random& random) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random, 0.01);
    bench.place(q);
    bench.pairs.find_near([](int) { return kInfinity; });
    const auto near_count = bench.pairs.near_count();
    std::vector<SelfCollision::Near> nears;
    std::vector<Eigen::VectorXd> gradients;
    for (int k = 0; k < near_count; ++k) {
      nears.push_back(bench.pairs.near(k));
      gradients.push_back(bench.gradient(bench.pairs.near(k)));
    }
    for (std::size_t k = 0; k < nears.size(); ++k) {
      const int pair = nears[k].pair;
      EXPECT_NEAR(bench.c(pair, q), nears[k].c, 1e-14);
      bool sharp = false;  // flat hulls, whose minor axis changes faster than differences can tell
      for (const int source : bench.pairs.pair(pair).source)
        sharp = sharp || bench.measured(source, q).minor < 0.02;
      const auto one = bench.measured(bench.pairs.pair(pair).source[0], q);
      const auto two = bench.measured(bench.pairs.pair(pair).source[1], q);
      if (sharp || one.minor + two.minor + bench.margin - nears[k].c < 1e-3) continue;
      const Eigen::VectorXd expected =
          central_gradient([&](const Eigen::VectorXd& x) { return bench.c(pair, x); }, q, 1e-6);
      EXPECT_LT((gradients[k] - expected).cwiseAbs().maxCoeff(), 2e-6 * (1.0 + expected.norm()))
          << gradients[k].transpose() << "\n"
          << expected.transpose();
      ++checked;
      spheres += nears[k].gradients.count == 2;
      for (const int source : bench.pairs.pair(pair).source) {
        const int s = source - static_cast<int>(bench.robot.occupancy().spheres.size());
        if (s < 0) continue;
        const Spheroid& spheroid = bench.robot.occupancy().spheroids[static_cast<std::size_t>(s)];
        const int a = bench.robot.body_of_link(bench.robot.link_index(spheroid.link_a));
        const int b = bench.robot.body_of_link(bench.robot.link_index(spheroid.link_b));
        (a == b ? settled : spanning) += 1;
      }
    }
  });
  EXPECT_GT(checked, 2000);
  EXPECT_GT(spheres, 100);
  EXPECT_GT(spanning, 100);
  EXPECT_GT(settled, 100);
}

/// base -x-> x -y-> y -z-> hand: three slides, a spheroid on the base and a ball on the hand.
Robot gantry(const Spheroid& spheroid, double ball) {
  RobotDescription description;
  description.name = "gantry";
  const std::vector<std::string> links{"base", "x", "y", "hand"};
  for (const std::string& link : links) description.links.push_back({.name = link});
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    description.joints.push_back(joint_between(links[k], links[k + 1], "slide_" + links[k + 1],
                                               JointType::Prismatic, -5.0, 5.0));
    description.joints.back().axis = Eigen::Vector3d::Unit(i);
  }
  Robot robot(description);
  robot.set_occupancy({{{"hand", Eigen::Vector3d::Zero(), ball}}, {spheroid}});
  return robot;
}

TEST(SelfCollision, a_capsule_touches_its_spheroid_at_the_tips_and_the_waist) {
  const double A = 0.5, h = 0.4, B = 0.3, ball = 0.1;
  Workbench bench(gantry({"base", {-h, 0, 0}, "base", {h, 0, 0}, A}, ball));
  ASSERT_EQ(bench.pairs.pair_count(), 1);
  const auto distance = [&](double x, double y, double z) {
    bench.place(Eigen::Vector3d(x, y, z));
    return bench.pairs.distance(0);
  };
  EXPECT_NEAR(distance(2.0, 0.0, 0.0), 2.0 - A - ball, 1e-14);
  EXPECT_NEAR(distance(-2.0, 0.0, 0.0), 2.0 - A - ball, 1e-14);
  EXPECT_NEAR(distance(0.0, 1.2, -1.6), 2.0 - B - ball, 1e-14);
  EXPECT_NEAR(distance(0.0, 0.1, 0.0), 0.1 - B - ball, 1e-14);  // inside
}

TEST(SelfCollision, hulls_whose_axes_cross_are_pushed_apart_across_both) {
  Workbench bench(gantry({"base", {-0.4, 0, 0}, "base", {0.4, 0, 0}, 0.5}, 0.1));
  bench.place(Eigen::Vector3d(0.1, 0.0, 0.0));
  bench.pairs.find_near([](int) { return 0.0; });
  ASSERT_EQ(bench.pairs.near_count(), 1);
  EXPECT_NEAR(bench.pairs.near(0).c, 0.4, 1e-14);
  const Eigen::VectorXd slope = bench.gradient(bench.pairs.near(0));
  EXPECT_NEAR(slope.norm(), 1.0, 1e-12);
  EXPECT_NEAR(slope[0], 0.0, 1e-12);
  EXPECT_LT(bench.c(0, Eigen::Vector3d(0.1, 0.0, 0.0) - 0.01 * slope), 0.4 - 0.0099);

  Workbench balls(gantry({"base", {0, 0, 0}, "base", {0, 0, 0}, 0.5}, 0.1));  // foci in one point
  balls.place(Eigen::Vector3d::Zero());
  balls.pairs.find_near([](int) { return 0.0; });
  ASSERT_EQ(balls.pairs.near_count(), 1);
  EXPECT_NEAR(balls.gradient(balls.pairs.near(0)).norm(), 1.0, 1e-12);
}

TEST(SelfCollision, a_hull_whose_foci_are_too_far_apart_holds_nothing) {
  Robot robot = gantry({"base", {0, 0, 0}, "base", {0, 0, 0}, 0.5}, 0.1);
  robot.set_occupancy({{{"base", {0, 0, 0}, 0.3}}, {{"y", {0, 0, 0}, "hand", {0, 0, 0}, 0.5}}});
  Workbench bench(std::move(robot));
  ASSERT_EQ(bench.pairs.pair_count(), 1);
  bench.place(Eigen::Vector3d(0.0, 0.0, 0.9));
  EXPECT_LT(bench.pairs.distance(0), 0.0);
  EXPECT_EQ(bench.pairs.least().pair, 0);
  for (const double apart : {1.0, 1.1, 5.0}) {
    bench.place(Eigen::Vector3d(0.0, 0.0, apart));
    EXPECT_EQ(bench.pairs.distance(0), kInfinity);
    EXPECT_EQ(bench.pairs.least().pair, -1);
    bench.pairs.find_near([](int) { return kInfinity; });
    EXPECT_EQ(bench.pairs.near_count(), 0);
  }
}

TEST(SelfCollision, near_pairs_and_the_least_distance_are_those_of_trying_every_pair) {
  for_random_trees(60, [](Workbench& bench, Random& random) {
    for (int repeat = 0; repeat < 5; ++repeat) {
      bench.place(random_configuration(bench.robot, random));
      const int count = bench.pairs.pair_count();
      const Eigen::VectorXd reach = random.vector(count, -0.1, 0.5);
      std::set<int> expected, found;
      double least = kInfinity;
      for (int k = 0; k < count; ++k) {
        const double d = bench.pairs.distance(k);
        least = std::min(least, d);
        if (bench.margin - d > -reach[k]) expected.insert(k);
      }
      bench.pairs.find_near([&](int k) { return reach[k]; });
      for (int k = 0; k < bench.pairs.near_count(); ++k) found.insert(bench.pairs.near(k).pair);
      EXPECT_EQ(found, expected);
      EXPECT_EQ(bench.pairs.least().distance, least);
      if (least < kInfinity) {
        EXPECT_EQ(bench.pairs.distance(bench.pairs.least().pair), least);
      }
    }
  });
}

// --- Which pairs ------------------------------------------------------------------------------

std::set<std::string> tested(const Robot& robot) {
  const HullModel model(robot);
  const SelfCollision pairs(robot, model, 0.0);
  std::set<std::string> names;
  for (int k = 0; k < pairs.pair_count(); ++k) {
    const auto name = [&](int i) {
      return robot.link_names()[static_cast<std::size_t>(pairs.pair(k).link[i])];
    };
    names.insert(std::min(name(0), name(1)) + "-" + std::max(name(0), name(1)));
  }
  return names;
}

/// a -turns- b =fixed= c -turns- d -turns- e, and a -turns- f. Joints a metre apart.
RobotDescription five_links_and_a_branch() {
  RobotDescription description;
  description.name = "five";
  for (const char* link : {"a", "b", "c", "d", "e", "f"})
    description.links.push_back({.name = link});
  const auto add = [&](const char* parent, const char* child, JointType type) {
    description.joints.push_back(joint_between(parent, child, std::string("to_") + child, type));
    description.joints.back().T_parent_child.translation() = Eigen::Vector3d(1.0, 0.2, 0.1);
  };
  add("a", "b", JointType::Revolute);
  add("b", "c", JointType::Fixed);
  add("c", "d", JointType::Revolute);
  add("d", "e", JointType::Revolute);
  add("a", "f", JointType::Revolute);
  return description;
}

Robot with_balls(const RobotDescription& description, const std::string& base = {}) {
  Robot robot(description, base);
  Occupancy occupancy;
  for (const std::string& link : robot.link_names())
    occupancy.spheres.push_back({link, {0.1, 0.2, 0.3}, 0.1});
  robot.set_occupancy(occupancy);
  return robot;
}

TEST(SelfCollision, pairs_are_of_links_that_are_neither_joined_nor_rigid_to_each_other) {
  const std::set<std::string> expected{"a-d", "a-e", "b-e", "b-f", "c-e", "c-f", "d-f", "e-f"};
  for (const char* base : {"a", "b", "c", "d", "e", "f"})
    EXPECT_EQ(tested(with_balls(five_links_and_a_branch(), base)), expected) << base;
}

TEST(SelfCollision, ignored_pairs_are_left_out_whichever_link_is_named_first) {
  Robot robot = with_balls(five_links_and_a_branch());
  robot.set_ignored_pairs({{"a", "d"}, {"f", "e"}, {"e", "f"}, {"a", "b"}, {"c", "c"}});
  EXPECT_EQ(tested(robot), (std::set<std::string>{"a-e", "b-e", "b-f", "c-e", "c-f", "d-f"}));
}

TEST(SelfCollision, a_hull_between_two_joints_axes_sits_on_the_link_between_them) {
  Robot robot = with_balls(five_links_and_a_branch());
  Occupancy occupancy = robot.occupancy();
  occupancy.spheres.erase(occupancy.spheres.begin() + 1, occupancy.spheres.begin() + 4);  // b c d
  occupancy.spheroids.push_back({"d", {0, 0, 0}, "e", {0, 0, 0}, 1.0});  // e's axis goes with d
  robot.set_occupancy(occupancy);
  EXPECT_EQ(tested(robot), (std::set<std::string>{"a-d", "a-e", "d-f", "e-f"}));
  occupancy.spheroids.back().focus_b = {0.1, 0, 0};  // off the axis: it spans d and e
  robot.set_occupancy(occupancy);
  EXPECT_EQ(tested(robot), (std::set<std::string>{"a-d", "a-e", "d-f", "e-f"}));
  robot.set_ignored_pairs({{"a", "e"}});
  EXPECT_EQ(tested(robot), (std::set<std::string>{"d-f", "e-f"}));  // its second link counts too
}

TEST(SelfCollision, hulls_that_no_joint_moves_against_each_other_are_no_pair) {
  RobotDescription description = five_links_and_a_branch();
  for (JointDescription& joint : description.joints) {
    joint.axis = Eigen::Vector3d::UnitX();  // b, c, d and e turn about one line
    joint.T_parent_child.translation() = Eigen::Vector3d(1.0, 0.0, 0.0);
  }
  description.joints.back().T_parent_child.translation().y() = 1.0;
  Robot robot(description);
  robot.set_occupancy(
      {{{"a", {0, 0, 0}, 0.1}, {"d", {0.5, 0, 0}, 0.1}, {"e", {0, 1, 0}, 0.1}}, {}});
  EXPECT_EQ(tested(robot), (std::set<std::string>{"a-e"}));
}

TEST(SelfCollision, a_robot_without_hulls_or_with_one_has_no_pairs) {
  Workbench none{Robot(five_links_and_a_branch())};
  EXPECT_EQ(none.pairs.pair_count(), 0);
  none.place(Eigen::VectorXd::Zero(none.robot.dof()));
  none.pairs.find_near([](int) { return kInfinity; });
  EXPECT_EQ(none.pairs.near_count(), 0);
  EXPECT_EQ(none.pairs.least().distance, kInfinity);
  EXPECT_EQ(none.pairs.least().pair, -1);
}

TEST(SelfCollision, foci_of_one_link_stay_rigid_when_one_of_them_lies_on_its_joints_axis) {
  Robot robot(five_links_and_a_branch());
  robot.set_occupancy({{{"a", {0.3, 0.1, 0}, 0.1}}, {{"e", {0, 0, 0.2}, "e", {0.5, 0.1, 0}, 0.4}}});
  Workbench bench(std::move(robot));
  EXPECT_NE(bench.model.points[1].body, bench.model.points[2].body);
  ASSERT_EQ(bench.pairs.pair_count(), 1);
  Random random(9);
  for (int k = 0; k < 50; ++k) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random, 0.01);
    bench.place(q);
    bench.pairs.find_near([](int) { return kInfinity; });
    ASSERT_EQ(bench.pairs.near_count(), 1);
    const Eigen::VectorXd slope = bench.gradient(bench.pairs.near(0));
    const Eigen::VectorXd expected =
        central_gradient([&](const Eigen::VectorXd& x) { return bench.c(0, x); }, q, 1e-6);
    EXPECT_LT((slope - expected).cwiseAbs().maxCoeff(), 1e-8);
    // Forces on rigid foci share out one unit force: nothing gradients them apart.
    const SelfCollision::Near& near = bench.pairs.near(0);
    double sum = 0.0;
    for (const PointGradient& gradient : near.gradients)
      sum += std::sqrt(dot3(gradient.dc_dpoint, gradient.dc_dpoint));
    EXPECT_NEAR(sum, 2.0, 1e-12);
  }
}

}  // namespace
}  // namespace pdoik::detail
