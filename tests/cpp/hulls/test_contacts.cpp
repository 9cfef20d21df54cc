#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <regex>

#include "arms.hpp"
#include "common/named_things.hpp"
#include "finite_differences.hpp"
#include "pdoik/tracker.hpp"
#include "random_shapes.hpp"
#include "shapes/convex_distance.hpp"
#include "workbench.hpp"

/// Rules of contact: which counts of several, and that all who keep pairs apart keep each by its
/// own clearance.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// --- Names
// ----------------------------------------------------------------------------------------

TEST(NamedThings, patterns_mean_what_regular_expressions_say) {
  Random random(5);
  const auto word = [&](const std::string& letters) {
    std::string text;
    for (int k = random.integer(0, 7); k > 0; --k)
      text += letters[static_cast<std::size_t>(
          random.integer(0, static_cast<int>(letters.size()) - 1))];
    return text;
  };
  int fit = 0;
  for (int k = 0; k < 20000; ++k) {
    const std::string pattern = word("ab*?"), name = word("ab");
    std::string expression;
    for (const char letter : pattern)
      expression += letter == '*' ? ".*" : letter == '?' ? "." : std::string(1, letter);
    const bool expected = std::regex_match(name, std::regex(expression));
    EXPECT_EQ(fits(pattern, name), expected) << pattern << " and " << name;
    fit += expected;
  }
  EXPECT_GT(fit, 1000);
}

TEST(NamedThings, a_name_means_the_pieces_of_an_object) {
  EXPECT_EQ(object_of("cup/1"), "cup");
  EXPECT_EQ(object_of("a/b/12"), "a/b");
  for (const char* whole : {"cup", "cup/", "/1", "cup/a", "cup/1a", ""})
    EXPECT_EQ(object_of(whole), whole);
  const NamedThings things({"cup", "cup/1", "cup/2", "cups", "table"});
  EXPECT_EQ(things.find("cup"), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(things.find("cup/1"), std::vector<int>{1});
  EXPECT_EQ(things.find("cup?"), std::vector<int>{3});
  EXPECT_EQ(things.find("c*"), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_TRUE(things.find("cupboard").empty());
  EXPECT_EQ(nearest_names("tabel", things.names()), std::vector<std::string>{"table"});
  EXPECT_TRUE(nearest_names("something else", things.names()).empty());
}

// --- All pairs by brute force
// -----------------------------------------------------------------------

/// What rules want of two things, by their definition.
double wanted(const std::vector<ContactRule>& rules, const std::string& one,
              const std::string& other, double otherwise) {
  const auto means = [](const std::string& name, const std::string& thing) {
    const std::string object(object_of(thing));
    return name == thing || name == object || fits(name, thing) || fits(name, object);
  };
  int best = -1;
  double clearance = otherwise;
  for (const ContactRule& rule : rules) {
    const bool is_of = (means(rule.one, one) && means(rule.other, other)) ||
                       (means(rule.one, other) && means(rule.other, one));
    const int exact = !is_pattern(rule.one) + !is_pattern(rule.other);
    if (!is_of || exact < best) continue;
    best = exact;
    clearance = rule.clearance.value_or(otherwise);
  }
  return clearance;
}

/// An arm whose links have a few capsules each, with two things in its hands, among shapes and
/// points, with rules of all kinds.
struct Situation {
  explicit Situation(int seed)
      : random(static_cast<std::uint64_t>(seed)),
        robot(Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)])) {
    robot.set_occupancy(with_capsules(robot, {}, random, 7));
    const std::vector<std::string> links = robot.link_names();
    robot.set_ignored_pairs({{links[1], links[4]}, {links[2], links[5]}});
    for (const Capsule& capsule : robot.occupancy().capsules)
      if (!std::ranges::count(hulls, capsule.link)) hulls.push_back(capsule.link);
    for (const char* name : {"crate", "crate/1", "wall"})
      shapes.push_back(random_shape(random, random.integer(0, 5), name));
    hands = {links.back(), links[3]};
    for (const char* name : {"cup", "tool"}) {
      held.push_back(random_shape(random, random.integer(0, 3), name));
      held.back().size *= 0.4;
      held.back().T_base_shape.translation() *= 0.4;
    }
    points = random_obstacles(random, 8, 0.8, 0.02);
    options.clearance = 0.01;
    options.self_clearance = 0.005;
    options.self_collision = true;
    const std::vector<std::string> names{hulls.front(), hulls.back(), hands[0], hands[1],
                                         "cup",         "tool",       "crate",  "wall",
                                         "points",      "*",          "c*",     "crate/?"};
    const std::vector<std::optional<double>> clearances{-kInfinity, std::nullopt, -0.03,
                                                        0.0,        0.05,         0.2};
    const auto any = [&](const auto& of) {
      return of[static_cast<std::size_t>(random.integer(0, static_cast<int>(of.size()) - 1))];
    };
    for (int k = random.integer(1, 6); k > 0; --k)
      rules.push_back({any(names), any(names), any(clearances), true});
    if (seed % 4 == 0) of_cup.push_back({"cup", any(names), any(clearances)});
  }

  /// All that count, in their order.
  std::vector<ContactRule> all_rules() const {
    std::vector<ContactRule> all;
    for (const LinkPair& pair : robot.ignored_pairs()) all.push_back({pair.first, pair.second});
    all.insert(all.end(), rules.begin(), rules.end());
    all.insert(all.end(), of_cup.begin(), of_cup.end());
    return all;
  }
  std::vector<Attachment> attachments() const {
    return {{{hands[0]}, {held[0]}, of_cup}, {{hands[1]}, {held[1]}}};
  }
  Robot with_hulls_of(const std::string& link) const {
    Robot alone = robot;
    Occupancy own;
    for (const Capsule& capsule : robot.occupancy().capsules)
      if (capsule.link == link) own.capsules.push_back(capsule);
    alone.set_occupancy(own);
    alone.set_ignored_pairs({});
    return alone;
  }

  /// A pair's distance and what is wanted of it.
  struct Pair {
    double distance, wanted;
  };
  /// All pairs whose contact counts: of obstacles, and of the robot with what it holds.
  /// @param to_solve  Those alone that an optimiser looks at: of links that move, and of points
  /// near something held the nearest.
  std::pair<std::vector<Pair>, std::vector<Pair>> pairs(const Eigen::VectorXd& q,
                                                        bool to_solve = false) const {
    std::vector<Pair> obstacles, own;
    const std::vector<ContactRule> all = all_rules();
    const auto add = [&](std::vector<Pair>& to, const std::string& one, const std::string& other,
                         double distance) {
      const double by_default = &to == &own ? options.self_clearance : options.clearance;
      const double least = wanted(all, one, other, by_default);
      if (!std::isinf(least)) to.push_back({distance, least});
    };
    Options plain = timeless();
    plain.ignore_obstacles_without_hulls = true;
    for (const std::string& link : hulls) {
      Solver solver(with_hulls_of(link), plain);
      const bool counts = !to_solve || robot.body_of_link(robot.link_index(link)) > 0;
      solver.set_shapes(Shapes(shapes));
      const std::vector<ObstacleClearance> each = solver.clearances(q);
      for (std::size_t k = 0; k < shapes.size() && counts; ++k)
        add(obstacles, link, shapes[k].name, each[k].distance);
      solver.set_shapes(Shapes());
      for (Eigen::Index k = 0; k < points.rows() && counts; ++k) {
        solver.set_obstacles(ObstacleMatrix(points.row(k)));
        add(obstacles, link, "points", solver.clearances(q).front().distance);
      }
      solver.clear_obstacles();
      for (std::size_t k = 0; k < held.size(); ++k) {
        solver.attach(hands[k], {&held[k], 1});
        Result result;
        solver.judge(robot.fk(q), q, result);
        add(own, link, held[k].name, result.self_distance);
        solver.detach();
      }
    }
    const auto in_base = [&](std::size_t k) {
      Shape shape = held[k];
      shape.T_base_shape = robot.fk(q, hands[k]) * shape.T_base_shape;
      return Solid(shape);
    };
    const Frame base = to_frame(Eigen::Isometry3d::Identity());
    for (std::size_t k = 0; k < held.size(); ++k) {
      const Solid solid = in_base(k);
      for (const Shape& shape : shapes)
        add(obstacles, held[k].name, shape.name,
            convex_distance(solid, base, Solid(shape)).distance);
      double nearest = kInfinity;
      for (Eigen::Index j = 0; j < points.rows(); ++j) {
        const Vec4 o = to_vec4(Eigen::Vector3d(points.row(j).head<3>().transpose()));
        const double distance = solid.distance(o).distance - points(j, 3);
        nearest = std::min(nearest, distance);
        if (!to_solve) add(obstacles, held[k].name, "points", distance);
      }
      if (to_solve) add(obstacles, held[k].name, "points", nearest);
    }
    add(own, "cup", "tool", convex_distance(in_base(0), base, in_base(1)).distance);
    Robot open = robot;
    open.set_ignored_pairs({});
    const HullModel model(open);
    SelfCollision self(open, model, 0.0);
    CollisionState state(model, model.moving);
    std::vector<Eigen::Isometry3d> T_base_body(open.bodies().size());
    open.body_poses(q, T_base_body);
    state.place(T_base_body);
    self.place(state.positions(), state.frames());
    for (int k = 0; k < self.pair_count(); ++k) {
      const auto& [one, other] = self.pair(k).link;
      const auto name = [&](int link) {
        return robot.link_names()[static_cast<std::size_t>(link)];
      };
      add(own, name(one), name(other), self.distance(k));
    }
    return {obstacles, own};
  }

  Random random;
  Robot robot;
  Options options = timeless();
  std::vector<std::string> hulls, hands;  ///< links with hulls; those that hold something
  std::vector<Shape> shapes, held;
  ObstacleMatrix points;
  std::vector<ContactRule> rules, of_cup;
};

struct Least {
  double distance = kInfinity, room = kInfinity;
};
Least least_of(const std::vector<Situation::Pair>& pairs) {
  Least least;
  for (const auto& [distance, wanted] : pairs) {
    least.distance = std::min(least.distance, distance);
    least.room = std::min(least.room, distance - wanted);
  }
  return least;
}

TEST(Contacts, the_judge_says_of_all_pairs_what_looking_at_each_says) {
  int differ = 0, succeed = 0, violated = 0;
  for (int seed = 1; seed <= 120; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Situation at(seed);
    Solver solver(at.robot, at.options);
    solver.attach(at.attachments());
    solver.set_shapes(Shapes(at.shapes, at.rules));
    solver.set_obstacles(at.points);
    for (int turn = 0; turn < 2; ++turn) {
      const Eigen::VectorXd q = random_configuration(at.robot, at.random);
      Result result;
      solver.judge(at.robot.fk(q), q, result);
      const auto [obstacles, own] = at.pairs(q);
      const Least far = least_of(obstacles), self = least_of(own);
      EXPECT_NEAR(result.clearance, far.distance, 1e-7);
      EXPECT_NEAR(result.room, far.room, 1e-7);
      EXPECT_NEAR(result.self_distance, self.distance, 1e-7);
      EXPECT_NEAR(result.self_room, self.room, 1e-7);
      const double tolerance = at.options.clearance_tolerance,
                   violation = -std::min(far.room, self.room) - tolerance;
      EXPECT_EQ(result.success, violation <= 0.0);
      if (violation > 0.0) {
        EXPECT_NEAR(result.worst.violation, violation, 1e-7);
        ++violated;
      }
      differ += std::abs(far.distance - at.options.clearance - far.room) > 1e-3;
      succeed += result.success;
      double least = kInfinity;
      for (const ObstacleClearance& each : solver.clearances(q))
        least = std::min(least, each.distance);
      EXPECT_NEAR(least, result.clearance, 1e-7);
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(differ, 30);
  EXPECT_GT(succeed, 5);
  EXPECT_GT(violated, 100);
}

TEST(Contacts, the_optimiser_sums_up_what_each_pair_lacks_and_its_gradient_is_central_differences) {
  int checked = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Situation at(seed);
    const auto all = std::make_unique<Workbench>(at.robot, at.options);
    Workbench& bench = *all;
    bench.scene.attach(at.attachments());
    bench.scene.use(std::make_shared<const ShapeSet>(at.shapes, at.rules));
    bench.set_obstacles(at.points);
    bench.problem.constraints.shapes.reserve(bench.scene.shapes().parts());
    bench.problem.constraints.self.use(bench.scene.pairs().margins);
    bench.problem.constraints.attachments.attach(bench.scene);
    const Eigen::VectorXd q = random_configuration(at.robot, at.random, 0.01);
    bench.set_target(at.robot.fk(q));
    const double found = bench.least_squares.evaluate(q);
    double sum = 0.0;
    const auto [obstacles, own] = at.pairs(q, true);
    for (const auto* pairs : {&obstacles, &own}) {
      for (const auto& [distance, wanted] : *pairs) {
        const double lacks = std::max(0.0, wanted - distance + 1e-8);
        sum += lacks * lacks;
      }
    }
    const double weight = at.options.collision_weight;
    EXPECT_NEAR(found, 0.5 * weight * weight * sum, 1e-7 * (1.0 + sum));
    const auto slope = smooth_gradient(
        [&](const Eigen::VectorXd& x) { return bench.least_squares.evaluate(x); }, q);
    if (!slope || sum == 0.0) continue;  // at a kink
    bench.least_squares.evaluate(q);
    Eigen::MatrixXd hessian(q.size(), q.size());
    Eigen::VectorXd gradient(q.size());
    bench.least_squares.linearise(hessian, gradient);
    EXPECT_LT((gradient - *slope).cwiseAbs().maxCoeff(), 1e-4 * (1.0 + slope->norm()))
        << gradient.transpose() << "\n"
        << slope->transpose();
    ++checked;
    if (HasFailure()) return;
  }
  EXPECT_GT(checked, 25);
}

TEST(Contacts, points_with_clearances_of_their_own_are_kept_off_spheroids_by_every_form) {
  int checked[2] = {0, 0};
  for (int seed = 1; seed <= 80; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = with_hulls(Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)]));
    Workbench bench(robot, {});
    const std::vector<ContactRule> rules{{robot.link_names()[4], "points", 0.07},
                                         {robot.link_names()[5], "points"},
                                         {robot.link_names()[2], "points", -0.02}};
    bench.scene.use(std::make_shared<const ShapeSet>(std::vector<Shape>{}, rules));
    bench.set_obstacles(random_obstacles(random, 60, 0.8, 0.03));
    const Eigen::VectorXd q = random_configuration(robot, random, 0.01);
    for (const auto form :
         {ObstacleConstraints::Form::Distance, ObstacleConstraints::Form::Paper}) {
      ObstacleConstraints& family = bench.problem.constraints.obstacles;
      family.use(bench.scene.obstacles(), form);
      const auto place = [&](const Eigen::VectorXd& x) {
        bench.roll_out(x);
        family.find(bench.problem.rollout, [](int) { return 0.1; });
      };
      place(q);
      struct Found {
        ConstraintKey key;
        double c;
        Eigen::VectorXd row;
      };
      std::vector<Found> all;
      for (int k = 0; k < family.count(); ++k) {
        const auto constraint = family.at(k);
        const Hull& hull = *constraint.hull;
        const auto [one, other] = links_of(robot, hull);
        EXPECT_TRUE(one != 5 && other != 5);  // may touch
        if (form == ObstacleConstraints::Form::Distance) {
          EXPECT_GE(family.most(k), constraint.c - 1e-6);
        }
        Eigen::VectorXd row = Eigen::VectorXd::Zero(robot.dof());
        family.add_row(constraint, bench.problem.rollout, row.data());
        all.push_back({family.key(k), constraint.c, row});
        if (!hull.is_sphere()) continue;
        const Vec4& o = (*bench.scene.obstacles())[bench.moving.near(k).obstacle];
        const Vec4 gap = bench.moving.position(hull.a) - o;
        const double margin = one == 4 ? 0.07 : one == 2 ? -0.02 : 0.0;
        EXPECT_NEAR(constraint.c, hull.semi_major + o[3] + margin - std::sqrt(dot3(gap, gap)),
                    1e-9);
      }
      for (std::size_t n = 0; n < all.size(); n += 1 + all.size() / 8) {
        const auto c = [&](const Eigen::VectorXd& x) {
          place(x);
          for (int k = 0; k < family.count(); ++k)
            if (family.key(k) == all[n].key) return family.at(k).c;
          return -1.0;
        };
        const auto slope = smooth_gradient(c, q);
        if (!slope) continue;
        EXPECT_LT((all[n].row - *slope).cwiseAbs().maxCoeff(), 1e-3);
        ++checked[form == ObstacleConstraints::Form::Paper];
      }
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(checked[0], 100);
  EXPECT_GT(checked[1], 100);
}

// --- Solves, steps and moves
// ------------------------------------------------------------------------

/// An arm that holds a box, whose lower face lies on a table at one configuration.
struct Resting {
  explicit Resting(const std::string& name) : robot(Robot::builtin(name)) {
    hand = robot.link_names().back();
    q = bent_arm(robot);
    const Eigen::Isometry3d T = robot.fk(q, hand);
    Eigen::Isometry3d in_hand = Eigen::Isometry3d::Identity();
    in_hand.translation().z() = 0.2;
    box = Shape::box("box", in_hand, {0.08, 0.08, 0.12});
    Eigen::Isometry3d below = Eigen::Isometry3d::Identity();  // its z axis upwards
    below.translation().z() = 0.26 + 0.5 * kThick;
    below.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
    table = Shape::box("table", T * below, {0.3, 0.3, kThick});
  }
  Options options() const {
    Options result = timeless();
    result.clearance = 0.02;
    return result;
  }
  /// How far the box's lowest corner is above the table.
  double above(const Eigen::VectorXd& at) const {
    double least = kInfinity;
    const Eigen::Isometry3d T = robot.fk(at, hand) * box.T_base_shape;
    for (const Eigen::Vector3d& corner : box_corners(box.size))
      least = std::min(least, (table.T_base_shape.inverse() * (T * corner)).z());
    return least - 0.5 * kThick;
  }

  static constexpr double kThick = 0.02;

  Robot robot;
  std::string hand;
  Eigen::VectorXd q;
  Shape box = Shape::sphere("none", {0, 0, 0}, 1.0), table = box;
};

TEST(Contacts, a_box_rests_on_its_table_while_all_else_keeps_its_clearance) {
  for (const char* name : {"panda", "ur10", "iiwa14"}) {
    SCOPED_TRACE(name);
    const Resting at(name);
    Solver solver(at.robot, at.options());
    solver.attach(at.hand, {&at.box, 1});
    const Eigen::Isometry3d target = at.robot.fk(at.q);
    solver.set_shapes(Shapes({at.table}));
    const Result barred = solver.solve(target, at.q);
    EXPECT_FALSE(barred.success);
    EXPECT_EQ(solver.describe(barred.worst), "clearance of box to table");
    solver.set_shapes(Shapes({at.table}, {{"box", "table", 0.0}}));
    const Result result = solver.solve(target, at.q);
    ASSERT_TRUE(result.success) << solver.describe(result.worst);
    EXPECT_NEAR(result.clearance, at.above(result.q), 1e-9);
    EXPECT_GE(at.above(result.q), -1e-6 - 1e-9);
    EXPECT_LT(result.clearance, 0.001);
    EXPECT_NEAR(result.room, std::min(at.above(result.q), result.room), 1e-9);
    // No deeper than contact.
    Eigen::Isometry3d lower = target;
    lower.translation() -= 0.005 * at.table.T_base_shape.linear().col(2);
    EXPECT_FALSE(solver.solve(lower, at.q).success);
    solver.set_shapes(Shapes({at.table}, {{"b?x", "table", -0.006}}));
    EXPECT_TRUE(solver.solve(lower, at.q).success);
    // The links still keep off as far as the options say.
    Solver empty_handed(solver);
    empty_handed.detach();
    Result alone;
    empty_handed.judge(at.robot.fk(result.q), result.q, alone);
    EXPECT_GE(alone.clearance, 0.02 - 1e-6);
    // A batch, and a solver that is copied, know the rules too.
    const std::vector<Eigen::Isometry3d> targets(4, lower);
    const std::vector<Eigen::VectorXd> starts{at.q};
    for (const Result& each : solver.solve_batch(targets, starts)) EXPECT_TRUE(each.success);
    EXPECT_TRUE(Solver(solver).solve(lower, at.q).success);
  }
}

TEST(Contacts, a_tracker_sets_a_box_down_and_a_move_slides_it_along) {
  const Resting at("panda");
  TrackerOptions unhurried;
  unhurried.max_time = 1e9;
  const std::vector<ContactRule> rules{{"box", "table", 0.0}};
  const Eigen::Vector3d up = at.table.T_base_shape.linear().col(2);
  Eigen::Isometry3d above = at.robot.fk(at.q);
  above.translation() += 0.06 * up;
  Solver solver(at.robot, at.options());
  solver.attach(at.hand, {&at.box, 1});
  solver.set_shapes(Shapes({at.table}, rules));
  const Result start = solver.solve(above, at.q);
  ASSERT_TRUE(start.success);
  for (const bool may_rest : {true, false}) {
    Tracker tracker(at.robot, at.options(), unhurried);
    tracker.attach(at.hand, {&at.box, 1});
    tracker.set_shapes(Shapes({at.table}, may_rest ? rules : std::vector<ContactRule>{}));
    tracker.reset(start.q);
    Eigen::Isometry3d goal = above;
    for (int k = 0; k < 90; ++k) {  // 30 mm farther than the table
      goal.translation() -= 0.001 * up;
      const TrackerResult& step = tracker.step(goal);
      EXPECT_GE(at.above(step.q), (may_rest ? 0.0 : 0.02) - 1e-5);
    }
    EXPECT_LT(at.above(tracker.q()), (may_rest ? 0.0 : 0.02) + 2e-3);
  }
  // A plane that moves is the one that rules speak of where it will be as well.
  Tracker tracker(at.robot, at.options(), unhurried);
  tracker.attach(at.hand, {&at.box, 1});
  const Eigen::Matrix<double, 1, 3> velocity = (0.01 * up).transpose();
  tracker.set_shapes(Shapes({at.table}, rules), velocity);
  tracker.reset(start.q);
  EXPECT_EQ(tracker.step(above).tracking, TrackerStatus::Tracking);

  Eigen::VectorXd one, other;
  Eigen::Isometry3d beside = at.robot.fk(at.q);
  for (const double way : {-0.1, 0.1}) {
    Eigen::Isometry3d T = beside;
    T.translation() += way * at.table.T_base_shape.linear().col(0) + 1e-3 * up;
    const Result end = solver.solve(T, at.q);
    ASSERT_TRUE(end.success);
    (way < 0.0 ? one : other) = end.q;
  }
  MotionOptions wanted;
  wanted.max_time = 1e9;
  const MotionResult move = solver.plan_motion({.from = &one, .to = &other}, wanted);
  ASSERT_EQ(move.status, MotionStatus::Solved);
  double least = kInfinity;
  for (Eigen::Index k = 0; k + 1 < move.q.rows(); ++k) {
    for (int n = 0; n <= 200; ++n) {
      const Eigen::VectorXd q = (move.q.row(k) + n / 200.0 * (move.q.row(k + 1) - move.q.row(k)));
      least = std::min(least, at.above(q));
      Solver alone(at.robot, at.options());
      if (n % 20 != 0) continue;
      Result result;
      alone.set_shapes(Shapes({at.table}));
      alone.judge(at.robot.fk(q), q, result);
      EXPECT_GE(result.clearance, 0.02 - 1e-4);
    }
  }
  EXPECT_GE(least, -1e-4);
  Solver strict(at.robot, at.options());
  strict.attach(at.hand, {&at.box, 1});
  strict.set_shapes(Shapes({at.table}));
  EXPECT_EQ(strict.plan_motion({.from = &one, .to = &other}, wanted).status,
            MotionStatus::BlockedStart);
}

TEST(Contacts, a_path_slides_a_box_along_its_table) {
  const Resting at("panda");
  Solver solver(at.robot, at.options());
  solver.attach(at.hand, {&at.box, 1});
  std::vector<std::vector<Goal>> stations;
  for (int k = 0; k <= 10; ++k) {
    Eigen::Isometry3d T = at.robot.fk(at.q);
    T.translation() += 0.01 * (k - 5) * at.table.T_base_shape.linear().col(1) +
                       1e-4 * at.table.T_base_shape.linear().col(2);
    stations.push_back({solver.goal(T)});
  }
  PathOptions wanted;
  wanted.max_time = 1e9;
  PathRequest request;
  request.stations = stations;
  for (const std::optional<double> clearance : {std::optional<double>(), std::optional(0.0)}) {
    solver.set_shapes(Shapes({at.table}, {{"box", "table", clearance}}));
    if (!clearance) {
      EXPECT_NE(solver.solve_path(request, wanted).status, PathStatus::Whole);
      continue;
    }
    const PathResult path = solver.solve_path(request, wanted);
    ASSERT_EQ(path.status, PathStatus::Whole);
    double least = kInfinity;
    for (Eigen::Index k = 0; k < path.q.rows(); ++k) {
      const Eigen::VectorXd q = path.q.row(k);
      least = std::min(least, at.above(q));
      Result judged;
      solver.judge(at.robot.fk(q), q, judged);
      EXPECT_GE(judged.room, -1e-6);
    }
    EXPECT_GE(least, -1e-6);
    EXPECT_LT(least, 1e-3);
    EXPECT_NEAR(path.clearance, least, 1e-9);
  }
}

TEST(Contacts, every_method_keeps_each_pair_apart_as_far_as_is_wanted_of_it) {
  for (const auto inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    int solved = 0;
    for (int seed = 1; seed <= 24; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Situation at(3 * seed + 1);
      Options options = timeless(GoalType::Pose, Method::Default, inner);
      options.max_restarts = 200;
      options.clearance = 0.02;
      options.self_collision = true;
      at.options.clearance = options.clearance;
      at.options.self_clearance = options.self_clearance;
      // Of points no negative ones, which one method knows alone.
      for (ContactRule& rule : at.rules)
        if (rule.clearance == -0.03) rule.clearance = 0.01;
      at.of_cup.clear();
      Solver solver(at.robot, options);
      solver.attach(at.attachments());
      solver.set_shapes(Shapes(at.shapes, at.rules));
      solver.set_obstacles(at.points);
      const Eigen::VectorXd q = random_configuration(at.robot, at.random, 0.1);
      const Result result = solver.solve(at.robot.fk(q), q);
      if (!result.success) continue;
      ++solved;
      const auto [obstacles, own] = at.pairs(result.q);
      EXPECT_GE(least_of(obstacles).room, -2e-6);
      EXPECT_GE(least_of(own).room, -2e-6);
    }
    EXPECT_GE(solved, 2);
  }
}

TEST(Contacts, links_keep_off_one_another_as_far_as_a_rule_says) {
  const Robot robot = without_pieces(Robot::builtin("panda"));
  const std::string one = robot.link_names()[1], other = robot.link_names()[6];
  Random random(11);
  int nearer = 0;
  for (int k = 0; k < 60; ++k) {
    const Eigen::VectorXd q = random_configuration(robot, random, 0.1);
    Options options = timeless();
    options.self_collision = true;
    Solver solver(robot, options);
    const Result usual = solver.solve(robot.fk(q), q);
    if (!usual.success) continue;
    solver.set_shapes(Shapes({}, {{one, other, 0.25}}));
    const Result result = solver.solve(robot.fk(q), usual.q);
    const auto apart = [&](const Eigen::VectorXd& at) {
      Occupancy two;
      for (const Capsule& capsule : robot.occupancy().capsules)
        if (capsule.link == one || capsule.link == other) two.capsules.push_back(capsule);
      Robot pair = robot;
      pair.set_occupancy(two);
      pair.set_ignored_pairs({});
      Solver judge(pair, options);
      Result judged;
      judge.judge(robot.fk(at), at, judged);
      return judged.self_distance;
    };
    if (result.success) {
      EXPECT_GE(apart(result.q), 0.25 - 1e-6);
      EXPECT_NEAR(std::min(result.self_room, apart(result.q) - 0.25), result.self_room, 1e-9);
    }
    nearer += apart(usual.q) < 0.25 && result.success;
    // The same solver without the rule is as before.
    solver.set_shapes(Shapes());
    EXPECT_EQ(solver.solve(robot.fk(q), q).q, usual.q);
    // Pairs that are ignored are looked at where a rule says so by their names.
    const LinkPair ignored = robot.ignored_pairs().front();
    EXPECT_EQ(PairMargins(robot).between(robot.link_index(ignored.first),
                                         robot.link_index(ignored.second)),
              -kInfinity);
    const std::vector<ContactRule> by_pattern{{"*", "*", 0.1}},
        by_name{{ignored.second, ignored.first, std::nullopt}};
    for (const auto* rules : {&by_pattern, &by_name}) {
      const PairMargins margins(robot, options, {}, {*rules, {}});
      EXPECT_EQ(margins.between(robot.link_index(ignored.first), robot.link_index(ignored.second)),
                rules == &by_name ? 0.0 : -kInfinity);
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(nearer, 3);
}

// --- What is carried
// --------------------------------------------------------------------------------

TEST(Contacts, two_hands_hold_a_box_and_touch_it_with_their_fingers) {
  const Robot robot = Robot::builtin("h1", "pelvis", {"left_elbow_link", "right_elbow_link"});
  const std::string left = "left_elbow_link", right = "right_elbow_link";
  const Eigen::VectorXd q = robot.mid_configuration();
  const Eigen::Isometry3d T_left_right = robot.fk(q, left).inverse() * robot.fk(q, right);
  Eigen::Isometry3d between = Eigen::Isometry3d::Identity();
  between.translation() = 0.5 * T_left_right.translation();
  // So large that it is in both forearms.
  const double wide = 2.0 * T_left_right.translation().norm();
  const Shape box = Shape::box("box", between, {wide, wide, wide});
  Options options = timeless();
  options.self_collision = true;
  const auto touched = [&](const std::vector<std::string>& links, bool also_torso) {
    Solver solver(robot, options);
    Attachment thing{links, {box}};
    if (also_torso)
      for (const std::string& link : robot.link_names())
        if (link != left && link != right) thing.contacts.push_back({"box", link});
    solver.attach(std::vector{thing});
    Result result;
    std::vector<Goal> goals(2);
    goals[0].T_base_tip = robot.fk(q, left);
    goals[1].T_base_tip = robot.fk(q, right);
    goals[1].tip = 1;
    solver.judge(goals, q, result);
    return result;
  };
  EXPECT_LT(touched({left}, true).self_room, 0.0);
  EXPECT_LT(touched({right}, true).self_room, 0.0);
  const Result held = touched({left, right}, true);
  EXPECT_TRUE(held.success) << held.worst.index << " " << held.worst.obstacle;
  EXPECT_LT(touched({left, right}, false).self_room, 0.0);  // the rest is in its way

  Solver solver(robot, options);
  solver.attach(std::vector<Attachment>{{{left, right}, {box}},
                                        {{right}, {Shape::sphere("ball", {0, 0, 0}, 0.01)}}});
  ASSERT_EQ(solver.attached().size(), 2U);
  EXPECT_EQ(solver.attached()[0].links, (std::vector<std::string>{left, right}));
  solver.detach(right);  // lets go: it moves with the left one, and the ball is put down
  ASSERT_EQ(solver.attached().size(), 1U);
  EXPECT_EQ(solver.attached()[0].links, std::vector<std::string>{left});
  EXPECT_TRUE(solver.attached()[0].shapes.front().T_base_shape.isApprox(between));
  solver.detach(left);
  EXPECT_TRUE(solver.attached().empty());
  for (const std::vector<std::string>& links :
       {std::vector<std::string>{}, {left, left}, {left, "nobody"}, {left, "pelvis"}}) {
    EXPECT_THROW(solver.attach(std::vector<Attachment>{{links, {box}}}), std::invalid_argument);
  }
}

TEST(Contacts, objects_are_put_down_by_name_with_all_their_pieces) {
  const Robot robot = Robot::builtin("panda");
  const std::string hand = robot.link_names().back(), elbow = robot.link_names()[4];
  const auto ball = [](const std::string& name) {
    return Shape::sphere(name, Eigen::Vector3d::Zero(), 0.01);
  };
  Solver solver(robot, timeless());
  const std::vector<Attachment> things{
      {{hand}, {ball("cup"), ball("cup/1"), ball("cups")}, {{"cup", "table", 0.01}}},
      {{elbow}, {ball("tool")}}};
  solver.attach(things);
  ASSERT_EQ(solver.attached().size(), 2U);
  EXPECT_EQ(solver.attached()[0].contacts, things[0].contacts);
  EXPECT_EQ(solver.attached()[0].shapes.size(), 3U);
  solver.detach("cup");
  ASSERT_EQ(solver.attached().size(), 2U);
  EXPECT_EQ(solver.attached()[0].shapes.front().name, "cups");
  // All or none.
  EXPECT_THROW(
      solver.attach(std::vector<Attachment>{{{hand}, {ball("new")}}, {{hand}, {ball("tool")}}}),
      std::invalid_argument);
  EXPECT_EQ(solver.attached().size(), 2U);
  try {
    solver.detach("cupz");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("nearest: cups"), std::string::npos) << error.what();
  }
  solver.detach();
  EXPECT_TRUE(solver.attached().empty());
}

TEST(Contacts, rules_that_make_no_sense_are_refused_by_name) {
  const Robot robot = Robot::builtin("panda");
  const Shape table = Shape::half_space("table", {0, 0, 1}, {0, 0, -1});
  Solver solver(robot, timeless());
  const auto says = [&](const ContactRule& rule, const std::string& words) {
    try {
      solver.set_shapes(Shapes({table}, {rule}));
      ADD_FAILURE() << "was taken; expected '" << words << "'";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  says({"panda_link8", "tabel"}, "'tabel' is not there");
  says({"panda_link8", "tabel"}, "nearest: table");
  says({"panda_lnik8", "table"}, "nearest: panda_link8");
  says({"gripper*", "table"}, "'gripper*' means nothing that there is");
  says({"", "table"}, "expected two names");
  says({"panda_link8", "table", std::nan("")}, "panda_link8");
  says({"panda_link8", "table", kInfinity}, "within 1e6");
  // What was there stays, and what may be missing may.
  const Shapes good({table}, {{"nobody", "table", 0.1, true}, {"*", "table", 0.5}});
  solver.set_shapes(good);
  EXPECT_THROW(solver.set_shapes(Shapes({}, {{"x", "y"}})), std::invalid_argument);
  Result result;
  const Eigen::VectorXd q = robot.mid_configuration();
  solver.judge(robot.fk(q), q, result);
  EXPECT_NEAR(result.clearance - 0.5, result.room, 1e-12);
  // A rule may speak of what is carried when it is taken in, and of nothing once that is put down.
  const Shape cup = Shape::sphere("cup", {0, 0, 0.1}, 0.03);
  solver.attach("panda_link8", {&cup, 1});
  solver.set_shapes(Shapes({table}, {{"cup", "table"}}));
  solver.detach("cup");
  solver.judge(robot.fk(q), q, result);
  EXPECT_TRUE(result.success);
  says({"cup", "table"}, "'cup' is not there");
  // Points go into hulls by the one method that can.
  for (const InnerMethod inner : {InnerMethod::LevenbergMarquardt, InnerMethod::Lbfgs}) {
    Solver of_points(robot, timeless(GoalType::Pose, Method::Default, inner));
    const Shapes into({}, {{"panda_link5", "points", -0.01}});
    if (inner == InnerMethod::Lbfgs) {
      EXPECT_THROW(of_points.set_shapes(into), std::invalid_argument);
    } else {
      of_points.set_shapes(into);
    }
    of_points.set_shapes(Shapes({}, {{"panda_link5", "points"}}));  // any depth is none
  }
}

TEST(Contacts, what_no_joint_moves_has_its_own_clearance_too) {
  const Robot robot = Robot::builtin("panda");
  const Eigen::Isometry3d target = robot.fk(bent_arm(robot));
  Options options = timeless();
  options.clearance = 0.03;
  Solver solver(robot, options);
  const Shape floor = Shape::half_space("floor", {0, 0, 1}, {0, 0, -0.01});
  const auto status = [&](const std::vector<ContactRule>& rules) {
    solver.set_shapes(Shapes({floor}, rules));
    return solver.solve(target, bent_arm(robot)).status;
  };
  Result result;
  solver.set_shapes(Shapes({floor}));
  solver.judge(target, bent_arm(robot), result);
  const double depth = -result.clearance;  // of the base's capsules in the floor, by their size
  EXPECT_EQ(status({}), Status::BaseCollision);
  EXPECT_EQ(status({{"panda_link0", "floor", -depth - 0.001}}), Status::Solved);
  EXPECT_EQ(status({{"panda_link0", "floor", -depth + 0.001}}), Status::BaseCollision);
  EXPECT_EQ(status({{"panda_link0", "floor"}}), Status::Solved);
  // The same of points.
  const auto among_point = [&](const std::vector<ContactRule>& rules) {
    Solver of_points(robot, options);
    of_points.set_shapes(Shapes({}, rules));
    of_points.set_obstacles(ObstacleMatrix(Eigen::RowVector3d(0.0, 0.0, 0.05)));
    return of_points.solve(target, bent_arm(robot)).status;
  };
  EXPECT_EQ(among_point({}), Status::BaseCollision);
  EXPECT_EQ(among_point({{"panda_link0", "points"}, {"panda_link1", "points"}}), Status::Solved);
}

}  // namespace
}  // namespace pdoik::detail
