#include <gtest/gtest.h>

#include <set>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "meshes.hpp"
#include "obstacles/shape_clearance.hpp"
#include "pdoik/tracker.hpp"
#include "random_shapes.hpp"
#include "workbench.hpp"

/// Solids as obstacles: distances by searching, gradients by differences, and solves among them.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Check>
void for_shapes(int count, Check&& check) {
  for (int seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    check(random_shape(random, seed), random);
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(Solid, distances_of_points_outside_are_those_to_their_projections) {
  int outside = 0;
  for_shapes(1200, [&](const Shape& shape, Random& random) {
    const Solid solid(shape);
    for (int k = 0; k < 20; ++k) {
      const Eigen::Vector3d p = random.point(1.2);
      const double expected = (p - projected(shape, p)).norm();
      const SolidDistance found = solid.distance(to_vec4(p));
      if (expected < 1e-9) {
        EXPECT_LE(found.distance, 1e-12);
        continue;
      }
      ++outside;
      EXPECT_NEAR(found.distance, expected, 1e-12);
      EXPECT_LE(solid.bound(to_vec4(p), 0.0), expected + 1e-12);
      EXPECT_LT((to_vector3(found.gradient) - (p - projected(shape, p)) / expected).norm(), 1e-7);
    }
  });
  EXPECT_GT(outside, 5000);
}

TEST(ShapeTree, visits_all_that_are_near_and_few_others_of_many) {
  for (const int count : {0, 1, 8, 9, 300, 5000}) {
    SCOPED_TRACE(count);
    Random random(static_cast<std::uint64_t>(count) + 1);
    std::vector<Solid> solids;
    for (int k = 0; k < count; ++k) {
      Shape shape = random_shape(random, k + 1);
      shape.T_base_shape.translation() = random.point(3.0);
      solids.emplace_back(shape);
    }
    const ShapeTree tree(solids);
    std::size_t looks = 0, all = 0;
    for (int trial = 0; trial < 50; ++trial) {
      const Vec4 p = to_vec4(random.point(3.0));
      const double reach = random.uniform(0.0, 0.5);
      std::set<int> visited;
      tree.near(p, Vec4{}, reach, [&](int solid) {
        EXPECT_TRUE(visited.insert(solid).second);
        return reach;
      });
      double least = kInfinity, told = kInfinity;
      for (int k = 0; k < count; ++k) {
        const double distance = solids[static_cast<std::size_t>(k)].distance(p).distance;
        least = std::min(least, distance);
        EXPECT_TRUE(visited.contains(k) || distance > reach - 1e-12) << k;
      }
      tree.near(p, Vec4{}, kInfinity, [&](int solid) {
        ++looks;
        told = std::min(told, solids[static_cast<std::size_t>(solid)].distance(p).distance);
        return told;
      });
      all += static_cast<std::size_t>(count);
      EXPECT_EQ(told, least);
    }
    EXPECT_LT(looks, count == 5000 ? all / 3 : all + 1);
  }
}

TEST(Solid, inside_the_distance_is_the_way_out_and_the_gradient_points_along_it) {
  int inside = 0;
  for_shapes(1200, [&](const Shape& shape, Random& random) {
    const Solid solid(shape);
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector3d p = shape.T_base_shape * random.point(0.2);
      const SolidDistance found = solid.distance(to_vec4(p));
      if (found.distance > -1e-6) continue;
      ++inside;
      const Eigen::Vector3d out = to_vector3(found.gradient);
      EXPECT_NEAR(out.norm(), 1.0, 1e-12);
      // The ball of that radius about p lies within, and touches the surface that way.
      for (int n = 0; n < 10; ++n)
        EXPECT_LE(solid.distance(to_vec4(p - 0.999 * found.distance * random.direction())).distance,
                  1e-12);
      EXPECT_NEAR(solid.distance(to_vec4(p - found.distance * out)).distance, 0.0, 1e-12);
    }
  });
  EXPECT_GT(inside, 5000);
}

TEST(Solid, gradients_are_central_differences) {
  for_shapes(1200, [&](const Shape& shape, Random& random) {
    const Solid solid(shape);
    for (int k = 0; k < 10; ++k) {
      const Eigen::VectorXd p = random.point(0.8);
      const auto distance = [&](const Eigen::VectorXd& x) {
        return solid.distance(to_vec4(x)).distance;
      };
      const Eigen::VectorXd one = central_gradient(distance, p, 1e-6),
                            two = central_gradient(distance, p, 1e-5);
      if ((one - two).norm() > 1e-4) continue;  // at a kink
      EXPECT_LT((to_vector3(solid.distance(to_vec4(p)).gradient) - one).norm(), 2e-4);
    }
  });
}

TEST(Solid, a_segments_distance_is_the_least_of_its_points) {
  int crossing = 0;
  for_shapes(1800, [&](const Shape& shape, Random& random) {
    const Solid solid(shape);
    for (int k = 0; k < 10; ++k) {
      const Eigen::Vector3d middle = random.point(0.9),
                            half = random.chance(0.1) ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                      : random.point(0.5);
      const auto at = [&](double t) { return solid.distance(to_vec4(middle + t * half)).distance; };
      double low = -1.0, high = 1.0, least = std::min(at(-1.0), at(1.0));
      const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
      for (int n = 0; n < 80; ++n) {
        const double left = high - golden * (high - low), right = low + golden * (high - low);
        least = std::min({least, at(left), at(right)});
        (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
      }
      const SegmentSolidDistance found = solid.distance(to_vec4(middle), to_vec4(half), kInfinity);
      // Through a ball or a capsule the axis' own distance counts, which is no less deep.
      const bool round = shape.kind == Shape::Kind::Sphere || shape.kind == Shape::Kind::Capsule;
      if (round && least < 0.0)
        EXPECT_LE(found.distance, least + 1e-9);
      else
        EXPECT_NEAR(found.distance, least, 1e-9);
      crossing += least < 0.0;
      const double t = half.norm() > 0.0
                           ? (to_vector3(found.point) - middle).dot(half) / half.squaredNorm()
                           : 0.0;
      EXPECT_LE(std::abs(t), 1.0 + 1e-12);
      EXPECT_LT((to_vector3(found.point) - middle - t * half).norm(), 1e-12);
      // What is far need not be found, but must not be told to be near.
      const double than = random.uniform(-0.2, 0.4);
      const double told = solid.distance(to_vec4(middle), to_vec4(half), than).distance;
      EXPECT_TRUE(std::abs(told - found.distance) < 1e-9 ||
                  (told >= than && found.distance >= than - 1e-9));
    }
  });
  EXPECT_GT(crossing, 1000);
}

TEST(Shape, nonsense_is_refused_by_name) {
  const auto error_of = [](const Shape& shape) -> std::string {
    try {
      check_shape(shape);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "taken";
  };
  const auto says = [&](const Shape& shape, const std::string& what) {
    EXPECT_NE(error_of(shape).find(what), std::string::npos) << error_of(shape);
  };
  const Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
  EXPECT_EQ(error_of(Shape::box("table", at, {1, 1, 0.1})), "taken");
  says(Shape::box("table", at, {1, 0, 0.1}), "shape 'table': an edge of its size is 0");
  says(Shape::box("table", at, {1, std::nan(""), 0.1}), "an edge of its size is nan");
  says(Shape::sphere("ball", {0, 0, 0}, -1), "shape 'ball': radius is -1");
  says(Shape::sphere("ball", {0, std::nan(""), 0}, 1), "shape 'ball'");
  says(Shape::cylinder("can", at, 0.1, 0), "shape 'can': length is 0");
  says(Shape::sphere("", {0, 0, 0}, 1), "no name");
  Eigen::Isometry3d skewed = at;
  skewed.linear() *= 1.1;
  says(Shape::box("table", skewed, {1, 1, 1}), "shape 'table'");
  EXPECT_THROW(Shape::half_space("floor", {0, 0, 0}, {0, 0, 0}), std::invalid_argument);
  const auto corners = box_corners({1, 1, 1});
  auto triangles = box_triangles();
  EXPECT_EQ(error_of(Shape::convex_mesh("mesh", at, corners, triangles)), "taken");
  triangles.pop_back();
  says(Shape::convex_mesh("mesh", at, corners, triangles), "the mesh has a hole");
  triangles = box_triangles();
  for (auto& triangle : triangles) std::swap(triangle[0], triangle[1]);
  says(Shape::convex_mesh("mesh", at, corners, triangles), "not convex");
  triangles = box_triangles();
  triangles[0][0] = 8;
  says(Shape::convex_mesh("mesh", at, corners, triangles), "names vertex 8 of 8");
  auto dented = corners;
  dented[7] *= 0.2;
  says(Shape::convex_mesh("mesh", at, dented, box_triangles()), "not convex");
  EXPECT_THROW(Shapes({Shape::sphere("a", {0, 0, 0}, 1), Shape::sphere("a", {1, 0, 0}, 1)}),
               std::invalid_argument);
  EXPECT_THROW(Shapes({Shape::sphere("a", {0, 0, 0}, 1)}, {{"hand", ""}}), std::invalid_argument);
  Solver solver(Robot::builtin("panda"));
  EXPECT_THROW(solver.set_shapes(Shapes({Shape::sphere("a", {0, 0, 0}, 1)}, {{"nobody", "a"}})),
               std::invalid_argument);
}

// --- Robots among shapes ------------------------------------------------------------------------

/// The least distance of what a robot fills to shapes by its points: spheres and capsules exactly,
/// by golden sections; of a spheroid by many points of its surface, which is at least as far as the
/// capsule around it.
double capsule_distance(const Robot& robot, const Eigen::VectorXd& q, const Shape& shape) {
  const Solid solid(shape);
  double least = kInfinity;
  const auto segment = [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius) {
    least = std::min(
        least, solid.distance(to_vec4(0.5 * (a + b)), to_vec4(0.5 * (b - a)), kInfinity).distance -
                   radius);
  };
  for (const Capsule& c : robot.occupancy().capsules) {
    const Eigen::Isometry3d T = robot.fk(q, c.link);
    segment(T * c.a, T * c.b, c.radius);
  }
  for (const Sphere& s : robot.occupancy().spheres) {
    if (has_capsules(robot, s.link)) continue;
    const Eigen::Vector3d centre = robot.fk(q, s.link) * s.center;
    segment(centre, centre, s.radius);
  }
  for (const Spheroid& s : robot.occupancy().spheroids) {
    if (s.link_a == s.link_b && has_capsules(robot, s.link_a)) continue;
    const Eigen::Vector3d a = robot.fk(q, s.link_a) * s.focus_a,
                          b = robot.fk(q, s.link_b) * s.focus_b;
    const double h = 0.5 * (b - a).norm(), A = s.semi_major;
    if (!(A > h)) continue;
    const double B = std::sqrt((A - h) * (A + h));
    const Eigen::Vector3d axis =
        h > 0.0 ? Eigen::Vector3d((b - a) / (2.0 * h)) : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d middle = 0.5 * (a + b);
    segment(middle - (A - B) * axis, middle + (A - B) * axis, B);
  }
  return least;
}

Robot robot_of(int seed, Random& random) {
  Robot robot = random_robot(random, seed % 2 == 0 ? kMixedTree : kSerial);
  const Occupancy wide = random_occupancy(robot, random, 3, 4);
  robot.set_occupancy(seed % 3 == 0 ? with_capsules(robot, wide, random, 8) : wide);
  return robot;
}

TEST(Shapes, the_clearance_is_the_least_distance_to_any_and_says_whose) {
  for (int seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = robot_of(seed, random);
    std::vector<Shape> shapes;
    for (int k = 0; k < 5; ++k)
      shapes.push_back(random_shape(random, random.integer(0, 5), "shape " + std::to_string(k)));
    Options options = timeless();
    options.clearance = seed % 4 == 0 ? 0.05 : 0.0;
    Solver solver(robot, options);
    solver.set_shapes(Shapes(shapes));
    const bool points_too = seed % 5 == 0;
    const ObstacleMatrix points = random_obstacles(random, 10, 1.0);
    if (points_too) solver.set_obstacles(points);
    const Eigen::VectorXd q = random_configuration(robot, random);
    Result result;
    solver.judge(robot.fk(q), q, result);
    double least = kInfinity;
    for (const Shape& shape : shapes) least = std::min(least, capsule_distance(robot, q, shape));
    const double to_points = points_too ? brute_force_clearance(robot, q, points, 100) : kInfinity;
    EXPECT_NEAR(result.clearance, std::min(least, to_points), 1e-9);
    if (result.worst.kind == WorstConstraint::Kind::Shape) {
      const Shape& worst = shapes[static_cast<std::size_t>(result.worst.obstacle)];
      EXPECT_NEAR(capsule_distance(robot, q, worst), least, 1e-9);
      EXPECT_NE(solver.describe(result.worst).find(worst.name), std::string::npos);
    }
    EXPECT_EQ(result.success, result.clearance >= options.clearance - options.clearance_tolerance);
    solver.clear_obstacles();
    solver.judge(robot.fk(q), q, result);
    EXPECT_EQ(result.clearance, kInfinity);
    if (HasFailure()) return;
  }
}

TEST(Shapes, the_capsule_about_a_spheroid_stands_out_by_what_is_said) {
  for (const double A : {0.21, 0.3, 0.4, 0.6, 1.0, 4.0}) {
    const double B = 0.2, h = std::sqrt((A - B) * (A + B)), straight = A - B;
    const Eigen::Vector3d focus(h, 0.0, 0.0);
    double farthest = 0.0;
    const auto look = [&](double x, double y) {
      const double out = spheroid_distance(Eigen::Vector3d(x, y, 0.0), focus, -focus, A).distance;
      EXPECT_GE(out, -1e-9);
      farthest = std::max(farthest, out);
    };
    for (int k = 0; k <= 1000; ++k) {
      look(straight * k / 1000.0, B);
      const double angle = M_PI_2 * k / 1000.0;
      look(straight + B * std::sin(angle), B * std::cos(angle));
    }
    EXPECT_NEAR(farthest, B * (1.0 - std::sqrt(2.0 * B / (A + B))), 1e-6);
  }
}

TEST(Shapes, their_constraints_rows_are_central_differences_in_both_forms) {
  int checked = 0;
  for (int seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = robot_of(seed, random);
    Workbench bench(robot, {});
    std::vector<Shape> shapes;
    for (int k = 0; k < 4; ++k)
      shapes.push_back(random_shape(random, random.integer(0, 5), "shape " + std::to_string(k)));
    Eigen::Isometry3d T(Eigen::Translation3d(random.point(0.6)));
    T.rotate(Eigen::AngleAxisd(random.uniform(0.0, 3.0), random.point(1.0).normalized()));
    if (seed % 8 == 0) shapes.push_back(torus("ring", T, 0.2, 0.06, 8, 5));  // of many parts
    const auto set = std::make_shared<const ShapeSet>(shapes);
    bench.scene.use(set);
    ShapeConstraints& family = bench.problem.constraints.shapes;
    family.reserve(bench.scene.shapes().parts());
    family.use(bench.scene.shapes(), 0.01);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.01);
    const auto place = [&](const Eigen::VectorXd& x) {
      bench.roll_out(x);
      family.place(bench.moving);
      family.find(bench.problem.rollout, [](int) { return 0.2; });
    };
    place(q);
    std::vector<ShapeConstraints::Near> nears;
    std::vector<Eigen::VectorXd> rows;
    for (int k = 0; k < family.count(); ++k) {
      nears.push_back(family.at(k));
      rows.emplace_back(Eigen::VectorXd::Zero(robot.dof()));
      family.add_row(nears.back(), bench.problem.rollout, rows.back().data());
      bench.problem.rollout.clear_wrenches();
      family.add_wrenches(nears.back(), 3.0, bench.problem.rollout);
      Eigen::VectorXd gradient(robot.dof());
      bench.problem.rollout.reverse(gradient.data(), robot.dof());
      EXPECT_LT((gradient - 3.0 * rows.back()).cwiseAbs().maxCoeff(), 1e-12);
    }
    for (std::size_t n = 0; n < nears.size(); n += 1 + nears.size() / 12) {
      const auto c = [&](const Eigen::VectorXd& x) {
        place(x);
        for (int k = 0; k < family.count(); ++k)
          if (family.key(k) == constraint_key(nears[n].hull, nears[n].found.part))
            return family.at(k).c;
        return -1.0;
      };
      const auto slope = smooth_gradient(c, q);
      if (!slope) continue;  // at a kink
      EXPECT_LT((rows[n] - *slope).cwiseAbs().maxCoeff(), 5e-4)
          << rows[n].transpose() << "\n"
          << slope->transpose() << "\nhull " << nears[n].hull << " source "
          << bench.hulls.moving[static_cast<std::size_t>(nears[n].hull)].source << " rigid "
          << bench.hulls.moving[static_cast<std::size_t>(nears[n].hull)].rigid << " shape "
          << static_cast<int>(shapes[static_cast<std::size_t>(nears[n].found.shape)].kind) << " c "
          << nears[n].c << " gradients " << nears[n].gradients.count << " body "
          << nears[n].gradients.each[0].body;
      ++checked;
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(checked, 400);
}

TEST(Shapes, solves_keep_off_them_by_every_method) {
  for (const auto inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    int solved = 0;
    for (int seed = 1; seed <= 40; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Robot robot =
          with_hulls(Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)]));
      const Eigen::VectorXd q = random_configuration(robot, random, 0.02);
      std::vector<Shape> shapes;
      while (shapes.size() < 6) {
        const Shape shape = random_shape(random, static_cast<int>(shapes.size()),
                                         "shape " + std::to_string(shapes.size()));
        if (capsule_distance(robot, q, shape) > 0.02) shapes.push_back(shape);
      }
      Options options = timeless(GoalType::Pose, Method::Default, inner);
      options.max_restarts = 300;
      Solver solver(robot, options);
      solver.set_shapes(Shapes(shapes));
      const Result result = solver.solve(robot.fk(q));
      solved += result.success;
      if (!result.success) continue;
      for (const Shape& shape : shapes)
        EXPECT_GE(capsule_distance(robot, result.q, shape), -options.clearance_tolerance);
    }
    EXPECT_GE(solved, inner == InnerMethod::Lbfgs ? 30 : 38);
  }
}

TEST(Shapes, contact_that_is_allowed_counts_for_those_two_only) {
  const Robot robot = with_hulls(Robot::builtin("ur10"));
  const Shape table = Shape::half_space("table", {0, 0, 1}, {0, 0, -0.001});
  Options options = timeless();
  Solver solver(robot, options);
  solver.set_shapes(Shapes({table}));
  const Eigen::Isometry3d target = robot.fk(Eigen::VectorXd::LinSpaced(6, -1.2, 0.4));
  Result result = solver.solve(target);
  EXPECT_EQ(result.status, Status::BaseCollision);
  EXPECT_NE(solver.describe(result.worst).find("to table"), std::string::npos);
  std::vector<ContactRule> allowed;  // of what no joint moves
  const std::vector<bool> moves = hulls_that_move(robot);
  for (std::size_t k = 0; k < robot.occupancy().spheres.size(); ++k)
    if (!moves[k]) allowed.push_back({robot.occupancy().spheres[k].link, "table"});
  for (const Spheroid& s : robot.occupancy().spheroids)
    if (s.link_a == allowed.back().one) allowed.push_back({s.link_b, "table"});
  solver.set_shapes(Shapes({table}, allowed));
  result = solver.solve(target);
  EXPECT_EQ(result.status, Status::Solved) << solver.describe(result.worst);
  // The other links are still kept off it.
  const std::string tip = robot.link_names().back();
  Result low;
  Eigen::VectorXd q = Eigen::VectorXd::Zero(6);
  q[1] = 0.6;
  solver.judge(robot.fk(q), q, low);
  EXPECT_FALSE(low.success);
  EXPECT_EQ(low.worst.kind, WorstConstraint::Kind::Shape);
}

TEST(Shapes, batches_give_the_same_answers_and_trackers_keep_off) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  const Shapes shapes({Shape::box("wall", Eigen::Isometry3d(Eigen::Translation3d(0.45, 0.3, 0.4)),
                                  {0.3, 0.05, 0.8})});
  Options options = timeless();
  Solver solver(robot, options);
  solver.set_shapes(shapes);
  Random random(4);
  std::vector<Eigen::Isometry3d> targets;
  for (int k = 0; k < 60; ++k) targets.push_back(robot.fk(random_configuration(robot, random)));
  Options few = options;
  few.max_restarts = 20;
  Solver quick(robot, few);
  quick.set_shapes(shapes);
  const std::vector<Result> batch = quick.solve_batch(targets);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    const Result one = quick.solve(targets[k]);
    EXPECT_EQ(one.success, batch[k].success);
    EXPECT_EQ(one.q, batch[k].q);
  }
  TrackerOptions loop;
  loop.period = 0.002;
  loop.max_time = 10.0;
  Tracker tracker(robot, options, loop);
  tracker.set_shapes(shapes);
  Eigen::VectorXd start = robot.mid_configuration();
  const Result begin = solver.solve(robot.fk(start), start);
  ASSERT_TRUE(begin.success);
  tracker.reset(begin.q);
  const Shape& wall = shapes.shapes()[0];
  Eigen::Isometry3d goal = robot.fk(begin.q);
  for (int k = 0; k < 400; ++k) {  // through the wall, if it were not there
    goal.translation().y() += 0.0015;
    const TrackerResult& step = tracker.step(goal);
    ASSERT_GE(capsule_distance(robot, step.q, wall), -1e-4) << k;
  }
}

TEST(Shapes, whoever_looks_at_many_looks_at_the_clock_meanwhile) {
  Random random(3);
  const Robot robot = Robot::builtin("panda");
  Workbench bench(robot, {});
  std::vector<Shape> boxes;
  for (int k = 0; k < 5000; ++k) {
    const Eigen::Isometry3d T(Eigen::Translation3d(random.point(0.7)));
    boxes.push_back(Shape::box("box" + std::to_string(k), T, Eigen::Vector3d::Constant(0.1)));
  }
  bench.scene.use(std::make_shared<const ShapeSet>(boxes));
  Constraints& constraints = bench.problem.constraints;
  constraints.shapes.reserve(bench.scene.shapes().parts());
  const Eigen::VectorXd q = robot.mid_configuration();
  const double whole = bench.least_squares.evaluate(q);
  const int found = constraints.shapes.count();
  ASSERT_TRUE(std::isfinite(whole));
  ASSERT_GT(found, 20);

  const std::function<bool()> nobody;
  const Deadline struck(0.0, nobody), late(1e9, nobody);
  for (const Deadline* deadline : {&late, &struck}) {
    bench.problem.deadline = deadline;
    constraints.watch(deadline);
    const double value = bench.least_squares.evaluate(q);
    EXPECT_EQ(value, deadline == &late ? whole : kInfinity);
    EXPECT_EQ(constraints.shapes.was_cut(), deadline == &struck);
    EXPECT_LT(constraints.shapes.count(), deadline == &struck ? found / 2 : found + 1);
    EXPECT_EQ(bench.least_squares.holds(), false);
  }
}

}  // namespace
}  // namespace pdoik::detail
