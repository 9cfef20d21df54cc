#include <gtest/gtest.h>

#include <set>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "hulls/self_collision.hpp"
#include "obstacles/clearance.hpp"
#include "workbench.hpp"

/// Hulls in two levels: spheres and spheroids that say where to look, and capsules that are what a
/// link fills.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Robot robot_of(int seed, Random& random, int capsules = 12) {
  const RobotKind serial{.joints = 6, .fixed = 0.2, .prismatic = 0.2};
  Robot robot = random_robot(random, seed % 2 == 0 ? kMixedTree : serial);
  const Occupancy wide = random_occupancy(robot, random, seed % 4 == 0 ? 0 : 4, seed % 4);
  robot.set_occupancy(with_capsules(robot, wide, random, capsules));
  return robot;
}

template <class Check>
void for_seeds(int count, Check&& check) {
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    check(seed, random);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(Capsules, the_clearance_is_that_of_the_capsules_whatever_the_wide_hulls_are) {
  int by_capsule = 0, by_hull = 0, touching = 0;
  for_seeds(400, [&](int seed, Random& random) {
    const Robot robot = robot_of(seed, random);
    Options options = timeless();
    options.clearance = seed % 5 == 0 ? 0.02 : 0.0;
    Solver solver(robot, options);
    const int count = seed % 7 == 0 ? 3000 : 15;  // those of a cloud in order, and of a small one
    const ObstacleMatrix obstacles =
        random_obstacles(random, count, 1.0, seed % 3 == 0 ? 0.05 : 0.0);
    solver.set_obstacles(obstacles);
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd q = random_configuration(robot, random);
      Result result;
      solver.judge(robot.fk(q), q, result);
      EXPECT_NEAR(result.clearance, brute_force_clearance(robot, q, obstacles, 100), 1e-9);
      if (result.worst.kind != WorstConstraint::Kind::Clearance) continue;
      ++touching;
      const Occupancy& occupancy = robot.occupancy();
      const auto hulls = occupancy.spheres.size() + occupancy.spheroids.size();
      ASSERT_GE(result.worst.index, 0);
      ASSERT_LT(static_cast<std::size_t>(result.worst.index), occupancy.size());
      if (static_cast<std::size_t>(result.worst.index) < hulls) {
        ++by_hull;
        continue;
      }
      ++by_capsule;
      const Capsule& capsule =
          occupancy.capsules[static_cast<std::size_t>(result.worst.index) - hulls];
      const Eigen::Isometry3d T = robot.fk(q, capsule.link);
      const Eigen::Vector3d o = obstacles.row(result.worst.obstacle).head<3>().transpose();
      const double radius = obstacles.cols() > 3 ? obstacles(result.worst.obstacle, 3) : 0.0;
      EXPECT_NEAR(
          brute_force_segment_distance(o, T * capsule.a, T * capsule.b) - capsule.radius - radius,
          result.clearance, 1e-9)
          << "the one that is named is not the nearest";
    }
  });
  EXPECT_GT(touching, 100);
  EXPECT_GT(by_capsule, 50);
  EXPECT_GT(by_hull, 20);
}

/// c of the pair of a hull and an obstacle, by Robot::fk, for hulls that have capsules: the deepest
/// of those that were given to it, and by how much the second is less deep.
struct Deepest {
  double c, lead;
};
Deepest deepest_of(const Workbench& bench, const Hull& hull, const Eigen::VectorXd& q,
                   Eigen::Index obstacle) {
  const Occupancy& occupancy = bench.robot.occupancy();
  const auto hulls = static_cast<int>(occupancy.spheres.size() + occupancy.spheroids.size());
  std::vector<double> all;
  for (int k = 0; k < 4 * hull.blocks; ++k) {
    const int source = bench.hulls.capsules(hull)[k / 4].source[k % 4];
    if (source < 0) continue;
    const Capsule& capsule = occupancy.capsules[static_cast<std::size_t>(source - hulls)];
    const Eigen::Isometry3d T = bench.robot.fk(q, capsule.link);
    const Eigen::Vector3d o = bench.obstacles.row(obstacle).head<3>().transpose();
    const double radius = bench.obstacles.cols() > 3 ? bench.obstacles(obstacle, 3) : 0.0;
    all.push_back(capsule.radius + radius + bench.options.clearance -
                  brute_force_segment_distance(o, T * capsule.a, T * capsule.b));
  }
  std::sort(all.begin(), all.end(), std::greater<>());
  return {all.front(), all.size() > 1 ? all[0] - all[1] : kInfinity};
}

TEST(Capsules, constraints_are_of_the_deepest_one_and_their_rows_are_central_differences) {
  int checked = 0;
  for_seeds(200, [&](int seed, Random& random) {
    const Robot robot = robot_of(seed, random);
    Options options;
    options.clearance = seed % 5 == 0 ? 0.02 : 0.0;
    Workbench bench(robot, options);
    bench.set_obstacles(random_obstacles(random, 40, 0.8, seed % 3 == 0 ? 0.05 : 0.0));
    ObstacleConstraints& family = bench.problem.constraints.obstacles;
    family.use(bench.scene.obstacles(), ObstacleConstraints::Form::Distance);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.01);
    bench.roll_out(q);
    constexpr double kReach = 0.1;
    family.find(bench.problem.rollout, [](int) { return kReach; });
    std::set<std::pair<int, int>> found;
    for (int k = 0; k < family.count(); ++k) {
      const auto at = family.at(k);
      const Eigen::Index obstacle = bench.scene.obstacles()->id(bench.moving.near(k).obstacle);
      found.insert({bench.moving.near(k).hull, static_cast<int>(obstacle)});
      if (!at.hull->has_capsules()) continue;
      const Deepest expected = deepest_of(bench, *at.hull, q, obstacle);
      EXPECT_NEAR(at.c, expected.c, 1e-12);
      if (expected.lead < 1e-4) continue;
      Eigen::VectorXd row = Eigen::VectorXd::Zero(robot.dof());
      family.add_row(at, bench.problem.rollout, row.data());
      const Eigen::VectorXd differences = central_gradient(
          [&](const Eigen::VectorXd& x) { return deepest_of(bench, *at.hull, x, obstacle).c; }, q,
          1e-6);
      EXPECT_LT((row - differences).cwiseAbs().maxCoeff(), 1e-6);
      bench.problem.rollout.clear_wrenches();
      family.add_wrenches(at, 2.0, bench.problem.rollout);
      Eigen::VectorXd gradient(robot.dof());
      bench.problem.rollout.reverse(gradient.data(), robot.dof());
      EXPECT_LT((gradient - 2.0 * row).cwiseAbs().maxCoeff(), 1e-12);
      ++checked;
    }
    // None that is nearer than the reach is missed, although the wide hulls may not hold it.
    for (std::size_t h = 0; h < bench.hulls.moving.size(); ++h) {
      if (!bench.hulls.moving[h].has_capsules()) continue;
      for (Eigen::Index j = 0; j < bench.obstacles.rows(); ++j) {
        if (deepest_of(bench, bench.hulls.moving[h], q, j).c < 1e-9 - kReach) continue;
        EXPECT_TRUE(found.contains({static_cast<int>(h), static_cast<int>(j)}));
      }
    }
  });
  EXPECT_GT(checked, 500);
}

// --- Self-collision -----------------------------------------------------------------------------

struct Placed {
  Eigen::Vector3d a, b;
  double radius;
  int source;
};

/// The segments a hull stands for, by Robot::fk; none for one without capsules.
std::vector<Placed> placed(const Robot& robot, const Eigen::VectorXd& q, const HullModel& model,
                           const Hull& hull) {
  const Occupancy& occupancy = robot.occupancy();
  const auto hulls = static_cast<int>(occupancy.spheres.size() + occupancy.spheroids.size());
  std::vector<Placed> all;
  for (int k = 0; k < 4 * hull.blocks; ++k) {
    const int source = model.capsules(hull)[k / 4].source[k % 4];
    if (source < 0) continue;
    const Capsule& capsule = occupancy.capsules[static_cast<std::size_t>(source - hulls)];
    const Eigen::Isometry3d T = robot.fk(q, capsule.link);
    all.push_back({T * capsule.a, T * capsule.b, capsule.radius, source});
  }
  return all;
}

/// By halving squares of the two parameters, in which the distance is convex.
double searched_distance(const Placed& one, const Placed& two) {
  const auto at = [&](double s) {
    const Eigen::Vector3d p = one.a + s * (one.b - one.a);
    return brute_force_segment_distance(p, two.a, two.b);
  };
  double low = 0.0, high = 1.0, least = std::min(at(0.0), at(1.0));
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  for (int k = 0; k < 80; ++k) {
    const double left = high - golden * (high - low), right = low + golden * (high - low);
    least = std::min({least, at(left), at(right)});
    (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
  }
  return least - one.radius - two.radius;
}

TEST(Capsules, the_distance_between_links_is_the_least_between_their_capsules) {
  int checked = 0, gradients = 0;
  for_seeds(60, [&](int seed, Random& random) {
    const Robot robot = robot_of(seed, random, 20);
    const HullModel model(robot);
    std::vector<Hull> hulls = model.moving;
    hulls.insert(hulls.end(), model.fixed.begin(), model.fixed.end());
    SelfCollision pairs(robot, model, 0.0);
    Rollout rollout(robot);
    std::vector<Vec4> positions(model.points.size());
    const auto place = [&](const Eigen::VectorXd& q) {
      const Eigen::VectorXd cosine = q.array().cos(), sine = q.array().sin();
      rollout.forward(cosine.data(), sine.data(), q.data());
      for (std::size_t k = 0; k < positions.size(); ++k)
        positions[k] = transform(rollout.frame(model.points[k].body), model.points[k].local);
      pairs.place(positions.data(), &rollout.frame(0));
    };
    const Eigen::VectorXd q = random_configuration(robot, random, 0.01);
    place(q);
    double least = kInfinity;
    for (int k = 0; k < pairs.pair_count(); ++k) least = std::min(least, pairs.distance(k));
    const SelfCollision::Least said = pairs.least();
    EXPECT_EQ(said.distance, least);
    if (said.pair >= 0 && std::isfinite(least)) {
      EXPECT_GE(said.source[0], 0);
      EXPECT_GE(said.source[1], 0);
    }
    pairs.find_near([](int) { return kInfinity; });
    std::vector<SelfCollision::Near> nears;
    for (int n = 0; n < pairs.near_count(); ++n) nears.push_back(pairs.near(n));
    for (const SelfCollision::Near& near : nears) {
      const auto& pair = pairs.pair(near.pair);
      const Hull &one = hulls[static_cast<std::size_t>(pair.hull[0])],
                 &two = hulls[static_cast<std::size_t>(pair.hull[1])];
      if (!one.has_capsules() || !two.has_capsules()) continue;
      double first = kInfinity, second = kInfinity;
      for (const Placed& a : placed(robot, q, model, one)) {
        for (const Placed& b : placed(robot, q, model, two)) {
          const double d = searched_distance(a, b);
          second = std::min(second, std::max(first, d));
          first = std::min(first, d);
        }
      }
      EXPECT_NEAR(-near.c, first, 1e-7);
      ++checked;
      if (second - first < 1e-3 || first < -0.01) continue;
      rollout.clear_wrenches();
      place(q);
      for (const PointGradient& gradient : near.gradients)
        rollout.add_force(gradient.body, gradient.point, gradient.dc_dpoint);
      Eigen::VectorXd gradient(robot.dof());
      rollout.reverse(gradient.data(), robot.dof());
      const Eigen::VectorXd expected = central_gradient(
          [&](const Eigen::VectorXd& x) {
            place(x);
            return -pairs.distance(near.pair);
          },
          q, 1e-6);
      EXPECT_LT((gradient - expected).cwiseAbs().maxCoeff(), 1e-5);
      ++gradients;
    }
  });
  EXPECT_GT(checked, 40);
  EXPECT_GT(gradients, 20);
}

// --- Whole solves -------------------------------------------------------------------------------

/// UR10 with hulls that stand 4 cm and more beyond thin rods between its joints.
Robot thin_arm() {
  Robot robot = with_hulls(Robot::builtin("ur10"));
  Occupancy occupancy = robot.occupancy();
  const Eigen::VectorXd q = robot.mid_configuration();
  const std::vector<std::string>& links = robot.link_names();
  for (std::size_t i = 0; i + 1 < links.size(); ++i) {
    const Eigen::Vector3d end =
        robot.fk(q, links[i]).inverse() * robot.fk(q, links[i + 1]).translation();
    occupancy.capsules.push_back({links[i], Eigen::Vector3d::Zero(), end, 0.02});
    for (Spheroid& s : occupancy.spheroids) {
      if (s.link_a != links[i]) continue;
      s.link_b = links[i];
      s.focus_b = end;
    }
  }
  occupancy.capsules.push_back(
      {links.back(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.02});
  robot.set_occupancy(occupancy);
  return robot;
}

TEST(Capsules, what_only_the_wide_hulls_touch_is_no_obstacle_and_answers_are_clear) {
  const Robot thin = thin_arm();
  Occupancy wide_hulls = thin.occupancy();
  wide_hulls.capsules.clear();
  wide_hulls.pieces.clear();
  Robot wide = thin;
  wide.set_occupancy(wide_hulls);
  Solver by_capsules(thin, timeless()), by_hulls(wide, timeless());
  int solved = 0, only_by_capsules = 0;
  for_seeds(60, [&](int, Random& random) {
    const testing::Problem problem = solvable_problem(thin, random, 40, 0.0, 0.005);
    by_capsules.set_obstacles(problem.obstacles);
    by_hulls.set_obstacles(problem.obstacles);
    const Result result = by_capsules.solve(problem.target), other = by_hulls.solve(problem.target);
    solved += result.success ? 1 : 0;
    only_by_capsules += result.success && !other.success ? 1 : 0;
    if (result.success) {
      EXPECT_GE(brute_force_clearance(thin, result.q, problem.obstacles), -1e-6);
    }
  });
  EXPECT_GE(solved, 58);
  EXPECT_GE(only_by_capsules, 5);
}

TEST(Capsules, a_link_that_has_nothing_but_capsules_needs_no_wide_hull) {
  Robot robot = Robot::builtin("iiwa14");
  Occupancy occupancy;
  occupancy.capsules.push_back({robot.link_names().back(), Eigen::Vector3d(0.0, 0.0, 0.02),
                                Eigen::Vector3d(0.1, 0.0, 0.02), 0.03});
  robot.set_occupancy(occupancy);
  Solver solver(robot, timeless());
  Random random(3);
  const Eigen::VectorXd q = random_configuration(robot, random);
  const Eigen::Isometry3d T = robot.fk(q, robot.link_names().back());
  ObstacleMatrix points(1, 3);
  points.row(0) = (T * Eigen::Vector3d(0.05, 0.0, 0.06)).transpose();
  solver.set_obstacles(points);
  Result result;
  solver.judge(robot.fk(q), q, result);
  EXPECT_NEAR(result.clearance, 0.01, 1e-12);
  EXPECT_TRUE(result.success);
  points.row(0) = (T * Eigen::Vector3d(0.05, 0.0, 0.04)).transpose();
  solver.set_obstacles(points);
  solver.judge(robot.fk(q), q, result);
  EXPECT_NEAR(result.clearance, -0.01, 1e-12);
  EXPECT_EQ(solver.describe(result.worst),
            "clearance of " + robot.link_names().back() + " (capsule 0) to obstacle 0");
}

TEST(Capsules, on_the_base_are_told_at_once_and_left_out_where_that_is_asked_for) {
  Robot robot = Robot::builtin("ur10");
  Occupancy occupancy;
  const std::string base = robot.link_names().front();
  occupancy.spheres.push_back({base, Eigen::Vector3d::Zero(), 0.3});
  occupancy.capsules.push_back(
      {base, Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, 0.1), 0.05});
  robot.set_occupancy(occupancy);
  ObstacleMatrix points(1, 3);
  points << 0.2, 0.0, 0.0;  // in the wide hull only
  Options options = timeless();
  Solver solver(robot, options);
  solver.set_obstacles(points);
  const Eigen::Isometry3d target = robot.fk(Eigen::VectorXd::Constant(6, 0.3));
  EXPECT_EQ(solver.solve(target).status, Status::Solved);
  points << 0.04, 0.0, 0.05;
  solver.set_obstacles(points);
  EXPECT_EQ(solver.solve(target).status, Status::BaseCollision);
  options.base_collision = false;
  Solver lenient(robot, options);
  lenient.set_obstacles(points);
  EXPECT_EQ(lenient.solve(target).status, Status::Solved);
}

TEST(Capsules, files_give_them_back_to_the_last_bit_and_nonsense_is_named) {
  Random random(5);
  Robot robot = random_robot(random, kSerial);
  const Occupancy occupancy =
      with_capsules(robot, random_occupancy(robot, random, 2, 2), random, 7);
  const Occupancy again = load_occupancy(to_yaml(occupancy));
  ASSERT_EQ(again.capsules.size(), 7U);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_EQ(again.capsules[k].link, occupancy.capsules[k].link);
    EXPECT_EQ(again.capsules[k].a, occupancy.capsules[k].a);
    EXPECT_EQ(again.capsules[k].b, occupancy.capsules[k].b);
    EXPECT_EQ(again.capsules[k].radius, occupancy.capsules[k].radius);
  }
  const auto error_of = [&](Capsule capsule) -> std::string {
    Occupancy bad;
    bad.capsules = {{"l0", Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 0.1}, capsule};
    try {
      robot.set_occupancy(bad);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero(),
                        nowhere = Eigen::Vector3d::Constant(std::nan(""));
  EXPECT_NE(error_of({"l1", zero, zero, 0.0}).find("capsules[1] on 'l1': radius is 0"),
            std::string::npos);
  EXPECT_NE(error_of({"l1", nowhere, zero, 0.1}).find("capsules[1] on 'l1': a is not finite"),
            std::string::npos);
  EXPECT_NE(error_of({"l1", zero, nowhere, 0.1}).find("b is not finite"), std::string::npos);
  EXPECT_NE(error_of({"nobody", zero, zero, 0.1}).find("nobody"), std::string::npos);
  EXPECT_EQ(error_of({"l1", zero, zero, 0.1}), "taken");
}

}  // namespace
}  // namespace pdoik::detail
