#include <gtest/gtest.h>

#include <numeric>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "pdoik/tracker.hpp"
#include "random_shapes.hpp"
#include "shapes/convex_distance.hpp"
#include "workbench.hpp"

/// Solids that a link carries: distances of two solids, gradients by differences, and solves.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Shape moved(Shape shape, const Eigen::Isometry3d& T) {
  if (shape.kind == Shape::Kind::HalfSpace) {
    const Eigen::Vector3d normal = T.linear() * shape.T_base_shape.linear().col(2);
    return Shape::half_space(shape.name, normal, T * shape.T_base_shape.translation());
  }
  shape.T_base_shape = T * shape.T_base_shape;
  return shape;
}

/// A bound from above that comes down to the distance of two solids that are apart: points of
/// either, projected onto the other in turn. 0 where they are not.
double by_projections(const Shape& one, const Shape& two, int rounds) {
  Eigen::Vector3d p = one.T_base_shape.translation(), q = p;
  for (int round = 0; round < rounds; ++round) {
    q = projected(two, p);
    p = projected(one, q);
  }
  return (p - q).norm();
}

struct Pair {
  explicit Pair(std::uint64_t seed) : random(seed) {
    moving = random_shape(random, random.integer(0, 3), "moving");
    if (seed % 3 == 0) moving = random_shape(random, 5, "moving");  // no half-space
    still = random_shape(random, static_cast<int>(seed), "still");
    T = random.pose(0.8);
  }
  ConvexDistance at(const Eigen::Isometry3d& where) const {
    return convex_distance(Solid(moving), to_frame(where), Solid(still));
  }
  Random random;
  Shape moving, still;
  Eigen::Isometry3d T;
};

TEST(ConvexDistance, apart_it_is_what_projections_in_turn_come_down_to) {
  int apart = 0;
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Pair pair(seed);
    const ConvexDistance found = pair.at(pair.T);
    const Shape moving = moved(pair.moving, pair.T);
    double above = by_projections(moving, pair.still, 400);
    EXPECT_LE(found.distance, above + 1e-9);
    if (found.distance < 0.01) continue;
    ++apart;
    // Projections in turn are slow where faces are nearly parallel.
    if (above - found.distance > 2e-3 * above) above = by_projections(moving, pair.still, 40000);
    EXPECT_NEAR(found.distance, above, 2e-3 * above);
  }
  EXPECT_GT(apart, 300);
}

TEST(ConvexDistance, along_no_direction_they_stand_farther_apart) {
  int apart = 0, inside = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Pair pair(seed);
    if (pair.still.kind == Shape::Kind::HalfSpace) continue;
    const Solid moving(pair.moving), still(pair.still);
    const Frame T = to_frame(pair.T);
    const ConvexDistance found = convex_distance(moving, T, still);
    (found.distance > 0.0 ? apart : inside) += 1;
    for (int k = 0; k < 20; ++k) {
      const Vec4 along = to_vec4(Eigen::Vector3d(pair.random.point(1.0).normalized()));
      EXPECT_LE(separation(moving, T, still, along), found.distance + 1e-6);
    }
    EXPECT_NEAR(separation(moving, T, still, found.gradient), found.distance, 1e-5);
    // That they are in each other is told without how deep.
    const ConvexDistance told = convex_distance(moving, T, still, 0.0, HowDeep::Unknown);
    EXPECT_EQ(told.distance < 0.0, found.distance < 0.0);
  }
  EXPECT_GT(apart, 200);
  EXPECT_GT(inside, 200);
}

TEST(ConvexDistance, inside_each_other_it_is_the_least_way_out) {
  std::vector<std::uint64_t> seeds(1500);
  std::iota(seeds.begin(), seeds.end(), 1);
  // With corners in the plane of a face that is there already.
  seeds.insert(seeds.end(), {2419, 4856, 8030, 8954, 9518, 11039, 13589, 15614});
  int inside = 0;
  for (const std::uint64_t seed : seeds) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Pair pair(seed);
    pair.T.translation() *= 0.3;
    const ConvexDistance found = pair.at(pair.T);
    if (found.distance > -1e-3) continue;
    ++inside;
    const auto after = [&](const Eigen::Vector3d& way) {
      Eigen::Isometry3d T = pair.T;
      T.pretranslate(way);
      return pair.at(T).distance;
    };
    EXPECT_NEAR(after(-(found.distance - 1e-4) * to_vector3(found.gradient)), 1e-4, 1e-5);
    for (int k = 0; k < 30; ++k)
      EXPECT_LE(after(-(found.distance + 1e-4) * pair.random.direction()), 1e-6);
    if (HasFailure()) return;
  }
  EXPECT_GT(inside, 300);
}

TEST(ConvexDistance, it_changes_as_its_gradient_says) {
  int checked = 0;
  for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Pair pair(seed);
    const ConvexDistance found = pair.at(pair.T);
    const auto c = [&](const Eigen::VectorXd& x) {
      Eigen::Isometry3d T = pair.T;
      const Eigen::Vector3d turn = x.tail<3>();
      T.prerotate(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
      T.pretranslate(Eigen::Vector3d(x.head<3>()));
      return pair.at(T).distance;
    };
    const auto gradient = smooth_gradient(c, Eigen::VectorXd::Zero(6));
    if (!gradient) continue;  // at a kink
    Eigen::VectorXd expected(6);
    expected << to_vector3(found.gradient),
        to_vector3(found.point).cross(to_vector3(found.gradient));
    EXPECT_LT((*gradient - expected).cwiseAbs().maxCoeff(), 2e-3) << found.distance;
    ++checked;
    if (HasFailure()) return;
  }
  EXPECT_GT(checked, 700);
}

// --- What a robot holds -------------------------------------------------------------------------

/// An arm with what it holds, among shapes and points.
struct Holding {
  explicit Holding(int seed)
      : random(static_cast<std::uint64_t>(seed)),
        robot(with_hulls(Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)]))) {
    if (seed % 2 == 0) robot.set_occupancy(with_capsules(robot, robot.occupancy(), random, 6));
    link = robot.link_names().back();
    held = random_shape(random, random.integer(0, 3), "held");
    held.size *= 0.4;
    held.T_base_shape.translation() *= 0.4;
  }
  /// Its least distance from points and shapes at q.
  double distance(const Eigen::VectorXd& q, const std::vector<Shape>& shapes,
                  const ObstacleMatrix& points) const {
    double least = kInfinity;
    const Eigen::Isometry3d T = robot.fk(q, link);
    const Solid solid(moved(held, T));
    for (Eigen::Index k = 0; k < points.rows(); ++k) {
      const Eigen::Vector3d o = points.row(k).head<3>().transpose();
      least = std::min(least, solid.distance(to_vec4(o)).distance);
    }
    for (const Shape& shape : shapes) {
      least = std::min(least, convex_distance(Solid(held), to_frame(T), Solid(shape)).distance);
    }
    return least;
  }

  Random random;
  Robot robot;
  std::string link;
  Shape held;
};

TEST(Attachments, the_judge_finds_what_it_is_nearest_to) {
  int by_held = 0, by_itself = 0;
  for (int seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Holding holding(seed);
    Solver solver(holding.robot, timeless());
    std::vector<Shape> shapes;
    for (int k = 0; k < 3; ++k)
      shapes.push_back(
          random_shape(holding.random, holding.random.integer(0, 5), "shape " + std::to_string(k)));
    const ObstacleMatrix points = random_obstacles(holding.random, 20, 1.0);
    solver.set_shapes(Shapes(shapes));
    solver.set_obstacles(points);
    const Eigen::VectorXd q = random_configuration(holding.robot, holding.random);
    Result without, with;
    solver.judge(holding.robot.fk(q), q, without);
    solver.attach(holding.link, {&holding.held, 1});
    solver.judge(holding.robot.fk(q), q, with);
    const double expected = std::min(without.clearance, holding.distance(q, shapes, points));
    EXPECT_NEAR(with.clearance, expected, 1e-6);
    using Kind = WorstConstraint::Kind;
    by_held += with.worst.kind == Kind::AttachmentPoint || with.worst.kind == Kind::AttachmentShape;
    by_itself += with.worst.kind == Kind::AttachmentHull;
    if (with.worst.kind >= Kind::AttachmentPoint) {
      EXPECT_NE(solver.describe(with.worst).find("clearance of held to "), std::string::npos);
    }
    EXPECT_EQ(with.success, with.clearance >= -solver.options().clearance_tolerance &&
                                with.self_distance >= -solver.options().clearance_tolerance);
    double least = kInfinity;
    const std::vector<ObstacleClearance> each = solver.clearances(q);
    ASSERT_EQ(each.size(), shapes.size() + 1);
    for (const ObstacleClearance& obstacle : each) {
      least = std::min(least, obstacle.distance);
      Solver alone(holding.robot, timeless());  // among that obstacle
      alone.attach(holding.link, {&holding.held, 1});
      if (obstacle.shape < 0)
        alone.set_obstacles(points);
      else
        alone.set_shapes(Shapes({shapes[static_cast<std::size_t>(obstacle.shape)]}));
      Result of_one;
      alone.judge(holding.robot.fk(q), q, of_one);
      EXPECT_NEAR(obstacle.distance, of_one.clearance, 1e-9);
      EXPECT_NE(obstacle.hull < 0, obstacle.held < 0);
    }
    EXPECT_NEAR(least, with.clearance, 1e-9);
    solver.detach(holding.link);
    solver.judge(holding.robot.fk(q), q, with);
    EXPECT_EQ(with.clearance, without.clearance);
    EXPECT_EQ(with.self_distance, without.self_distance);
    if (HasFailure()) return;
  }
  EXPECT_GT(by_held, 10);
  EXPECT_GT(by_itself, 0);
}

TEST(Attachments, its_constraints_rows_are_central_differences_in_both_forms) {
  int checked[4] = {0, 0, 0, 0};
  for (int seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Holding holding(seed);
    Workbench bench(holding.robot, {});
    std::vector<Shape> shapes;
    for (int k = 0; k < 3; ++k)
      shapes.push_back(
          random_shape(holding.random, holding.random.integer(0, 5), "shape " + std::to_string(k)));
    const auto set = std::make_shared<const ShapeSet>(shapes);
    bench.set_obstacles(random_obstacles(holding.random, 30, 0.8));
    bench.scene.use(set);
    bench.scene.attach(holding.link, {&holding.held, 1}, {});
    Shape other = random_shape(holding.random, holding.random.integer(0, 3), "other");
    other.size *= 0.4;
    other.T_base_shape.translation() *= 0.4;
    bench.scene.attach(holding.robot.link_names()[3], {&other, 1}, {});
    AttachmentConstraints& family = bench.problem.constraints.attachments;
    family.attach(bench.scene);
    family.use(true);
    const Eigen::VectorXd q = random_configuration(holding.robot, holding.random, 0.01);
    const auto place = [&](const Eigen::VectorXd& x) {
      bench.roll_out(x);
      family.find(bench.problem.rollout, [](int) { return 0.2; });
    };
    place(q);
    std::vector<AttachmentConstraints::Near> nears;
    std::vector<Eigen::VectorXd> rows;
    for (int k = 0; k < family.count(); ++k) {
      if (k > 0) {
        EXPECT_LT(family.key(k - 1), family.key(k));
      }
      nears.push_back(family.at(k));
      rows.emplace_back(Eigen::VectorXd::Zero(holding.robot.dof()));
      family.add_row(nears.back(), bench.problem.rollout, rows.back().data());
      bench.problem.rollout.clear_wrenches();
      family.add_wrenches(nears.back(), 3.0, bench.problem.rollout);
      Eigen::VectorXd gradient(holding.robot.dof());
      bench.problem.rollout.reverse(gradient.data(), holding.robot.dof());
      EXPECT_LT((gradient - 3.0 * rows.back()).cwiseAbs().maxCoeff(), 1e-12);
    }
    for (std::size_t n = 0; n < nears.size(); ++n) {
      const auto c = [&](const Eigen::VectorXd& x) {
        place(x);
        for (int k = 0; k < family.count(); ++k)
          if (family.at(k).slot == nears[n].slot) return family.at(k).c;
        return -1.0;
      };
      const auto slope = smooth_gradient(c, q);
      if (!slope) continue;  // at a kink
      EXPECT_LT((rows[n] - *slope).cwiseAbs().maxCoeff(), 2e-3)
          << rows[n].transpose() << "\n"
          << slope->transpose() << "\nkind " << static_cast<int>(nears[n].kind) << " c "
          << nears[n].c;
      ++checked[static_cast<int>(nears[n].kind) -
                static_cast<int>(WorstConstraint::Kind::AttachmentPoint)];
    }
    if (HasFailure()) return;
  }
  for (const int count : checked) EXPECT_GT(count, 30);
}

TEST(Attachments, solves_and_steps_keep_it_off_and_blocked_says_what_it_touches) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  const std::string hand = robot.link_names().back();
  Eigen::Isometry3d in_hand = Eigen::Isometry3d::Identity();
  in_hand.translation().z() = 0.16;
  const Shape stick = Shape::box("stick", in_hand, {0.03, 0.03, 0.12});
  int solved = 0, kept = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Eigen::VectorXd q = random_configuration(robot, random, 0.05);
    const Eigen::Isometry3d T = robot.fk(q, hand);
    Solver solver(robot, timeless());
    solver.attach(hand, {&stick, 1});
    // A ball beside the stick where the target has it.
    const Shape beside =
        Shape::sphere("ball", T * (in_hand * Eigen::Vector3d(0.08, 0.0, 0.0)), 0.05);
    solver.set_shapes(Shapes({beside}));
    const Result result = solver.solve(robot.fk(q), q);
    if (result.success) {
      ++solved;
      const ConvexDistance apart =
          convex_distance(Solid(stick), to_frame(robot.fk(result.q, hand)), Solid(beside));
      EXPECT_GE(apart.distance, -1e-6);
    }
    // And one that it is stuck in.
    solver.set_shapes(Shapes({Shape::sphere("ball", T * in_hand.translation(), 0.01)}));
    const Result stuck = solver.solve(robot.fk(q), q);
    EXPECT_EQ(stuck.status, Status::Blocked);
    EXPECT_EQ(solver.describe(stuck.worst), "clearance of stick to ball");
    const std::vector<Eigen::Isometry3d> targets{robot.fk(q)};
    const std::vector<Eigen::VectorXd> starts{q};
    EXPECT_EQ(solver.solve_batch(targets, starts).front().status, Status::Blocked);
    Solver empty_handed(solver);
    empty_handed.detach();
    EXPECT_NE(empty_handed.solve(robot.fk(q), q).status, Status::Blocked);
    // A tracker that is asked to push the stick through a wall stays before it.
    TrackerOptions unhurried;
    unhurried.max_time = 1e9;
    Tracker tracker(robot, timeless(), unhurried);
    if (!result.success) continue;
    tracker.reset(result.q);
    tracker.attach(hand, {&stick, 1});
    const Eigen::Isometry3d from = robot.fk(result.q, hand);
    const Shape wall =
        Shape::half_space("wall", -from.linear().col(2), from * Eigen::Vector3d(0.0, 0.0, 0.23));
    tracker.set_shapes(Shapes({wall}));
    Eigen::Isometry3d goal = robot.fk(result.q);
    if (tracker.step(goal).clearance < 1e-3) continue;  // the wall is through the arm
    tracker.reset(result.q);
    for (int k = 0; k < 40; ++k) {
      goal.translate(Eigen::Vector3d(0.0, 0.0, 0.001));
      const TrackerResult& step = tracker.step(goal);
      const ConvexDistance apart =
          convex_distance(Solid(stick), to_frame(robot.fk(step.q, hand)), Solid(wall));
      EXPECT_GE(apart.distance, -1e-5);
      kept += step.tracking == TrackerStatus::Infeasible && step.clearance < 1e-5;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(solved, 20);
  EXPECT_GT(kept, 50);
}

TEST(Attachments, what_two_links_hold_keeps_off_each_other) {
  Robot robot = Robot::builtin("panda");
  robot.set_occupancy({});
  Random random(4);
  const std::string one = robot.link_names()[3], other = robot.link_names().back();
  const double radius = 0.2;
  const Shape first = Shape::sphere("first", Eigen::Vector3d::Zero(), radius);
  const Shape second = Shape::sphere("second", Eigen::Vector3d::Zero(), radius);
  Options options = timeless(GoalType::Position);
  options.ignore_obstacles_without_hulls = true;  // all that is there is what it holds
  Solver solver(robot, options);
  solver.attach(one, {&first, 1});
  solver.attach(other, {&second, 1});
  Solver either(robot, options);
  const std::vector<std::string> each_other{"first"};
  either.attach(one, {&first, 1});
  either.attach(other, {&second, 1}, each_other);
  int touching = 0, kept = 0, would_touch = 0;
  Result both, allowed;
  const auto apart_at = [&](const Eigen::VectorXd& q) {
    return (robot.fk(q, one).translation() - robot.fk(q, other).translation()).norm() -
           2.0 * radius;
  };
  for (int k = 0; k < 200; ++k) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    solver.judge(robot.fk(q), q, both);
    either.judge(robot.fk(q), q, allowed);
    const double apart = apart_at(q);
    EXPECT_NEAR(both.self_distance, std::min(allowed.self_distance, apart), 1e-9);
    if (apart < -1e-3) {
      ++touching;
      EXPECT_FALSE(both.success);
      if (both.worst.kind == WorstConstraint::Kind::AttachmentAttachment) {
        EXPECT_EQ(solver.describe(both.worst), "clearance of second to first");
      }
      continue;
    }
    const Result found = solver.solve(robot.fk(q)), without = either.solve(robot.fk(q));
    if (!found.success || !without.success) continue;
    ++kept;
    EXPECT_GE(apart_at(found.q), -1e-6);
    would_touch += apart_at(without.q) < -1e-3 ? 1 : 0;
  }
  EXPECT_GT(touching, 10);
  EXPECT_GT(kept, 50);
  EXPECT_GT(would_touch, 2);
}

TEST(Attachments, what_may_touch_it_and_what_makes_no_sense) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  const std::string hand = robot.link_names().back();
  Eigen::Isometry3d in_hand = Eigen::Isometry3d::Identity();
  in_hand.translation().z() = 0.2;
  const Shape cube = Shape::box("cube", in_hand, {0.05, 0.05, 0.05});
  Random random(3);
  const Eigen::VectorXd q = random_configuration(robot, random, 0.2);
  const Shape table = Shape::sphere("table", robot.fk(q, hand) * in_hand.translation(), 0.01);
  Solver solver(robot, timeless());
  solver.set_shapes(Shapes({table}));
  const std::vector<std::string> touching{"table"};
  solver.attach(hand, {&cube, 1}, touching);
  Result result;
  solver.judge(robot.fk(q), q, result);
  EXPECT_GT(result.clearance, 0.0);
  solver.detach();
  solver.attach(hand, {&cube, 1});
  solver.judge(robot.fk(q), q, result);
  EXPECT_LT(result.clearance, 0.0);
  const auto refuses = [&](const std::string& link, const Shape& shape) {
    EXPECT_THROW(solver.attach(link, {&shape, 1}), std::invalid_argument);
  };
  refuses(hand, cube);  // one more of that name
  refuses("nobody", Shape::sphere("ball", {0, 0, 0}, 0.1));
  refuses(robot.link_names().front(), Shape::sphere("ball", {0, 0, 0}, 0.1));
  refuses(hand, Shape::half_space("floor", {0, 0, 1}, {0, 0, 0}));
  refuses(hand, Shape::box("flat", in_hand, {0.1, 0.0, 0.1}));
  EXPECT_THROW(solver.detach("nobody"), std::invalid_argument);
}

}  // namespace
}  // namespace pdoik::detail
