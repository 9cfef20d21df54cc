#include <gtest/gtest.h>

#include <map>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "obstacles/shape_clearance.hpp"
#include "pdoik/errors.hpp"
#include "random_shapes.hpp"
#include "shapes/convex_distance.hpp"
#include "workbench.hpp"

/// Links' own convex pieces: where capsules touch something, these say whether the link does.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

/// Of a link: a piece, which is a box, and the capsule about it.
struct BoxedLink {
  std::string link;
  Eigen::Isometry3d T_link_box;
  Eigen::Vector3d size;  ///< the first is the longest
};

ConvexPiece piece_of(const BoxedLink& box) {
  ConvexPiece piece{box.link, {}, {}, 0.0};
  for (const Eigen::Vector3d& corner : box_corners(box.size))
    piece.vertices.push_back(box.T_link_box * corner);
  piece.triangles = box_triangles();
  return piece;
}

/// An arm whose links are two boxes each, within capsules and balls.
struct BoxedArm {
  explicit BoxedArm(int seed) : random(static_cast<std::uint64_t>(seed)) {
    const std::vector<std::string> names = arm_names();
    robot = Robot::builtin(names[static_cast<std::size_t>(seed) % names.size()]);
    Occupancy occupancy;
    for (const std::string& link : robot.link_names()) {
      if (link == robot.link_names().front() && seed % 2 == 0) continue;
      occupancy.spheres.push_back({link, Eigen::Vector3d::Zero(), 0.02});
      for (int k = 0; k < 2; ++k) {
        BoxedLink box{link, Eigen::Isometry3d(Eigen::Translation3d(random.point(0.08))), {}};
        box.T_link_box.rotate(
            Eigen::AngleAxisd(random.uniform(0.0, 3.0), random.point(1.0).normalized()));
        const double across = random.uniform(0.02, 0.08);
        box.size = {across + random.uniform(0.0, 0.1), across, random.uniform(0.02, across)};
        const Eigen::Vector3d end = 0.5 * box.size[0] * box.T_link_box.linear().col(0),
                              middle = box.T_link_box.translation();
        occupancy.capsules.push_back(
            {link, middle - end, middle + end, 0.5 * std::hypot(box.size[1], box.size[2]) + 1e-6});
        occupancy.pieces.push_back(piece_of(box));
        boxes.push_back(std::move(box));
      }
    }
    robot.set_occupancy(occupancy);
    robot.set_ignored_pairs({});
  }
  BoxedArm(const BoxedArm&) = delete;

  /// Of one of its boxes, in the base frame.
  Solid solid(const BoxedLink& box, const Eigen::VectorXd& q) const {
    return Solid(Shape::box("box", robot.fk(q, box.link) * box.T_link_box, box.size));
  }
  /// The least of `distance(box, as a solid)` over all boxes.
  template <class Distance>
  double least(const Eigen::VectorXd& q, Distance&& distance) const {
    double least = kInfinity;
    for (const BoxedLink& box : boxes) least = std::min(least, distance(box, solid(box, q)));
    return least;
  }

  Random random;
  Robot robot = Robot::builtin("panda");
  std::vector<BoxedLink> boxes;
};

const Frame kBase = to_frame(Eigen::Isometry3d::Identity());

/// Verdicts on what is really this far away [m]. How deep capsules say that something is in them
/// may be less than the way out of the piece: the less counts.
struct Counts {
  void check(double said, double truly, double by_capsules) {
    EXPECT_LE(by_capsules, said + 1e-9);
    if (std::abs(truly) > 1e-9) {
      EXPECT_EQ(said < 0.0, truly < 0.0) << said << " " << truly;
    }
    if (truly >= 0.0) {
      EXPECT_LE(said, truly + 1e-9);
      freed += by_capsules < -1e-4 ? 1 : 0;
      return;
    }
    ++touching;
    EXPECT_GE(said, std::max(truly, by_capsules) - 1e-8);
    exact += std::abs(said - truly) < 1e-8 ? 1 : 0;
  }
  int touching = 0, freed = 0, exact = 0;
};

TEST(Pieces, say_whether_a_link_touches_points_shapes_and_itself) {
  Counts points, shapes, self;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    BoxedArm arm(seed);
    Options options;
    options.self_collision = true;
    Solver exact(arm.robot, options);
    options.exact_contact = false;
    Solver wide(arm.robot, options);
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::VectorXd q = random_configuration(arm.robot, arm.random, 0.01);
      const std::string& link = arm.robot.link_names()[static_cast<std::size_t>(
          arm.random.integer(1, static_cast<int>(arm.robot.link_names().size()) - 1))];
      const Eigen::Vector3d near = arm.robot.fk(q, link).translation() + arm.random.point(0.12);
      Result said, coarse;
      const auto judge = [&] {
        exact.judge(arm.robot.fk(q), q, said);
        wide.judge(arm.robot.fk(q), q, coarse);
      };
      ObstacleMatrix point(1, 4);
      point << near.transpose(), arm.random.uniform(0.0, 0.02);
      exact.set_obstacles(point);
      wide.set_obstacles(point);
      judge();
      points.check(said.clearance,
                   arm.least(q,
                             [&](const BoxedLink&, const Solid& box) {
                               return box.distance(to_vec4(near)).distance - point(0, 3);
                             }),
                   coarse.clearance);
      const double truly = [&] {
        double least = kInfinity;
        for (const BoxedLink& one : arm.boxes) {
          for (const BoxedLink& two : arm.boxes) {
            const int a = arm.robot.body_of_link(arm.robot.link_index(one.link)),
                      b = arm.robot.body_of_link(arm.robot.link_index(two.link));
            if (a >= b - 1) continue;
            least = std::min(least,
                             convex_distance(arm.solid(one, q), kBase, arm.solid(two, q)).distance);
          }
        }
        return least;
      }();
      self.check(said.self_distance, truly, coarse.self_distance);
      exact.set_obstacles(ObstacleMatrix(0, 3));
      wide.set_obstacles(ObstacleMatrix(0, 3));
      Shape shape = random_shape(arm.random, arm.random.integer(0, 5), "shape");
      if (shape.kind == Shape::Kind::HalfSpace) continue;
      shape.T_base_shape.translation() = near;
      shape.size *= 0.3;
      exact.set_shapes(Shapes({shape}));
      wide.set_shapes(Shapes({shape}));
      judge();
      const Solid still(shape);
      const double apart = arm.least(q, [&](const BoxedLink&, const Solid& box) {
        return convex_distance(box, kBase, still).distance;
      });
      shapes.check(said.clearance, apart, coarse.clearance);
      exact.set_shapes(Shapes());
      wide.set_shapes(Shapes());
    }
    if (HasFailure()) return;
  }
  for (const Counts& counts : {points, shapes, self}) {
    EXPECT_GT(counts.touching, 50);
    EXPECT_GT(counts.freed, 15);
    EXPECT_GT(counts.exact, counts.touching / 2);
  }
}

TEST(Pieces, that_any_links_touch_is_told_as_their_constraints_tell_it) {
  int touching = 0, freed = 0, deep = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    BoxedArm arm(seed);
    Options options;
    options.self_collision = true;
    // Of a link's ball no more than this stands out: what is deeper is known without pieces.
    if (seed % 2 == 0) {
      Occupancy occupancy = arm.robot.occupancy();
      for (Capsule& capsule : occupancy.capsules) capsule.overhang = 0.7 * capsule.radius;
      arm.robot.set_occupancy(occupancy);
      arm.robot.set_ignored_pairs({});
    }
    const auto made = std::make_unique<Workbench>(arm.robot, options);
    options.exact_contact = false;
    const auto made_coarse = std::make_unique<Workbench>(arm.robot, options);
    SelfConstraints &self = made->problem.constraints.self,
                    &by_capsules = made_coarse->problem.constraints.self;
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::VectorXd q = random_configuration(arm.robot, arm.random, 0.01);
      for (Workbench* bench : {made.get(), made_coarse.get()}) {
        bench->roll_out(q);
        bench->problem.constraints.self.find(bench->problem.rollout, [](int) { return 0.0; });
      }
      const bool touches = self.count() > 0, is_near = by_capsules.count() > 0;
      const std::int64_t looks = self.looks();
      EXPECT_EQ(self.any_touches(), touches);
      EXPECT_EQ(by_capsules.any_touches(), is_near);
      touching += touches ? 1 : 0;
      freed += is_near && !touches ? 1 : 0;
      deep += touches && self.looks() == looks ? 1 : 0;
    }
  }
  EXPECT_GT(touching, 100);
  EXPECT_GT(freed, 30);
  EXPECT_GT(deep, 20);
}

TEST(Pieces, say_how_near_what_is_held_is_to_a_link) {
  Counts held;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    BoxedArm arm(seed);
    Options options;
    Solver exact(arm.robot, options);
    options.exact_contact = false;
    Solver wide(arm.robot, options);
    const std::string hand = arm.robot.link_names().back();
    Eigen::Isometry3d T_hand_box(Eigen::Translation3d(0.0, 0.0, 0.25));
    const Shape box = Shape::box("box", T_hand_box, {0.1, 0.08, 0.4});
    for (Solver* solver : {&exact, &wide}) solver->attach(hand, {&box, 1});
    for (int trial = 0; trial < 60; ++trial) {
      const Eigen::VectorXd q = random_configuration(arm.robot, arm.random, 0.01);
      Result said, coarse;
      exact.judge(arm.robot.fk(q), q, said);
      wide.judge(arm.robot.fk(q), q, coarse);
      const Solid carried(Shape::box("box", arm.robot.fk(q, hand) * T_hand_box, box.size));
      const int last = arm.robot.body_of_link(arm.robot.link_index(hand));
      const double truly = arm.least(q, [&](const BoxedLink& one, const Solid& solid) {
        const int body = arm.robot.body_of_link(arm.robot.link_index(one.link));
        return body == last ? kInfinity : convex_distance(solid, kBase, carried).distance;
      });
      if (wide.options().keeps_off_itself(arm.robot)) continue;
      held.check(said.self_distance, truly, coarse.self_distance);
    }
    if (HasFailure()) return;
  }
  EXPECT_GT(held.touching, 50);
  EXPECT_GT(held.freed, 10);
}

/// Checks rows and wrenches of all that a family finds where the arm is, against differences of c.
/// @returns How many were by pieces.
template <class Family, class Place, class IsByPieces>
int check_rows(Workbench& bench, Family& family, const Eigen::VectorXd& q, Place&& place,
               IsByPieces&& is_by_pieces) {
  place(q);
  int checked = 0;
  std::map<ConstraintKey, Eigen::VectorXd> rows;
  for (int k = 0; k < family.count(); ++k) {
    const auto at = family.at(k);
    if (!is_by_pieces(at)) continue;
    Eigen::VectorXd row = Eigen::VectorXd::Zero(q.size()), gradient(q.size());
    family.add_row(at, bench.problem.rollout, row.data());
    bench.problem.rollout.clear_wrenches();
    family.add_wrenches(at, 3.0, bench.problem.rollout);
    bench.problem.rollout.reverse(gradient.data(), static_cast<int>(q.size()));
    EXPECT_LT((gradient - 3.0 * row).cwiseAbs().maxCoeff(), 1e-12);
    rows[family.key(k)] = row;
  }
  for (const auto& [key, row] : rows) {
    const auto c = [&](const Eigen::VectorXd& x) {
      place(x);
      for (int k = 0; k < family.count(); ++k)
        if (family.key(k) == key) return static_cast<double>(family.at(k).c);
      return -1.0;
    };
    const auto slope = smooth_gradient(c, q);
    if (!slope) continue;  // at a kink
    EXPECT_LT((row - *slope).cwiseAbs().maxCoeff(), 1e-3);
    ++checked;
  }
  return checked;
}

TEST(Pieces, their_constraints_rows_are_central_differences) {
  int points = 0, shapes = 0, self = 0, held = 0;
  for (int seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    BoxedArm arm(seed);
    Options options;
    options.self_collision = true;
    const auto made = std::make_unique<Workbench>(arm.robot, options);
    Workbench& bench = *made;
    const Eigen::VectorXd q = random_configuration(arm.robot, arm.random, 0.01);
    ObstacleMatrix near(30, 4);
    std::vector<Shape> solids;
    for (int k = 0; k < 30; ++k) {
      const std::string& link = arm.robot.link_names()[static_cast<std::size_t>(
          arm.random.integer(1, static_cast<int>(arm.robot.link_names().size()) - 1))];
      const Eigen::Vector3d at = arm.robot.fk(q, link).translation() + arm.random.point(0.1);
      near.row(k) << at.transpose(), arm.random.uniform(0.0, 0.02);
      if (k >= 6) continue;
      solids.push_back(random_shape(arm.random, arm.random.integer(0, 5), std::to_string(k)));
      solids.back().T_base_shape.translation() = at;
      solids.back().size *= 0.3;
    }
    bench.set_obstacles(near);
    bench.scene.use(std::make_shared<const ShapeSet>(solids));
    Shape box = Shape::box("held", Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.25)),
                           {0.1, 0.08, 0.4});
    bench.scene.attach(arm.robot.link_names().back(), {&box, 1}, {});
    Constraints& all = bench.problem.constraints;
    constexpr double kReach = 0.01;
    const auto reach = [](int) { return kReach; };

    all.obstacles.use(bench.scene.obstacles(), ObstacleConstraints::Form::Distance);
    points += check_rows(
        bench, all.obstacles, q,
        [&](const Eigen::VectorXd& x) {
          bench.roll_out(x);
          all.obstacles.find(bench.problem.rollout, reach);
        },
        [&](const ObstacleConstraints::At& at) { return at.c < 0.0 || at.hull->has_pieces(); });

    all.shapes.reserve(bench.scene.shapes().parts());
    all.shapes.use(bench.scene.shapes(), 0.0);
    shapes += check_rows(
        bench, all.shapes, q,
        [&](const Eigen::VectorXd& x) {
          bench.roll_out(x);
          all.shapes.place(bench.moving);
          all.shapes.find(bench.problem.rollout, reach);
        },
        [](const ShapeConstraints::Near& at) { return at.found.by_piece; });

    self += check_rows(
        bench, all.self, q,
        [&](const Eigen::VectorXd& x) {
          bench.roll_out(x);
          all.self.find(bench.problem.rollout, reach);
        },
        [](const SelfCollision::Near& at) { return at.c > -kReach; });

    all.attachments.attach(bench.scene);
    all.attachments.use(true);
    held += check_rows(
        bench, all.attachments, q,
        [&](const Eigen::VectorXd& x) {
          bench.roll_out(x);
          all.attachments.find(bench.problem.rollout, reach);
        },
        [](const AttachmentConstraints::Near& at) {
          return at.kind == WorstConstraint::Kind::AttachmentHull && at.c > 0.0;
        });
    if (HasFailure()) return;
  }
  EXPECT_GT(points, 200);
  EXPECT_GT(shapes, 50);
  EXPECT_GT(self, 50);
  EXPECT_GT(held, 2);
}

TEST(Pieces, answers_are_clear_of_everything_by_the_links_themselves) {
  int solved = 0, only_exact = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    BoxedArm arm(seed);
    Options options = timeless();
    options.max_restarts = 30;
    Solver exact(arm.robot, options);
    options.exact_contact = false;
    Solver wide(arm.robot, options);
    const Eigen::VectorXd q = random_configuration(arm.robot, arm.random, 0.02);
    std::vector<Shape> shapes;
    for (int tries = 0; tries < 200 && shapes.size() < 8; ++tries) {
      const std::string& link = arm.robot.link_names()[static_cast<std::size_t>(
          arm.random.integer(1, static_cast<int>(arm.robot.link_names().size()) - 1))];
      Shape shape =
          random_shape(arm.random, arm.random.integer(0, 3), std::to_string(shapes.size()));
      if (shape.kind == Shape::Kind::HalfSpace) continue;
      shape.T_base_shape.translation() =
          arm.robot.fk(q, link).translation() + arm.random.point(0.2);
      shape.size *= 0.4;
      const Solid still(shape);
      const double apart = arm.least(q, [&](const BoxedLink&, const Solid& box) {
        return convex_distance(box, kBase, still).distance;
      });
      if (apart > 1e-3) shapes.push_back(shape);
    }
    exact.set_shapes(Shapes(shapes));
    wide.set_shapes(Shapes(shapes));
    Result result;
    wide.solve(arm.robot.fk(q), nullptr, result);
    const bool is_wide = result.success;
    exact.solve(arm.robot.fk(q), nullptr, result);
    if (!result.success) continue;
    ++solved;
    only_exact += is_wide ? 0 : 1;
    for (const Shape& shape : shapes) {
      const Solid still(shape);
      EXPECT_GE(arm.least(result.q,
                          [&](const BoxedLink&, const Solid& box) {
                            return convex_distance(box, kBase, still).distance;
                          }),
                -1.01 * exact.options().clearance_tolerance);
    }
  }
  EXPECT_GT(solved, 50);
  EXPECT_GT(only_exact, 3);
}

TEST(Pieces, files_give_them_back_to_the_last_bit_and_nonsense_is_named) {
  BoxedArm arm(3);
  const Occupancy& occupancy = arm.robot.occupancy();
  const Occupancy read = load_occupancy(to_yaml(occupancy));
  ASSERT_EQ(read.pieces.size(), occupancy.pieces.size());
  for (std::size_t k = 0; k < read.pieces.size(); ++k) {
    EXPECT_EQ(read.pieces[k].link, occupancy.pieces[k].link);
    EXPECT_EQ(read.pieces[k].vertices, occupancy.pieces[k].vertices);
    EXPECT_EQ(read.pieces[k].triangles, occupancy.pieces[k].triangles);
    EXPECT_EQ(read.pieces[k].tolerance, occupancy.pieces[k].tolerance);
  }
  const auto error_of = [&](auto&& spoil) {
    Occupancy spoilt = occupancy;
    spoil(spoilt);
    try {
      arm.robot.set_occupancy(spoilt);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("nothing");
  };
  const auto says = [](const std::string& text, const char* what) {
    return text.find(what) != std::string::npos;
  };
  EXPECT_TRUE(says(error_of([](Occupancy& o) { o.capsules.clear(); }), "has no capsules"));
  EXPECT_TRUE(says(error_of([](Occupancy& o) { o.pieces[1].link = "nowhere"; }), "nowhere"));
  EXPECT_TRUE(says(error_of([](Occupancy& o) { o.pieces[1].triangles.pop_back(); }), "pieces[1]"));
  EXPECT_TRUE(says(error_of([](Occupancy& o) { o.pieces[1].tolerance = -1.0; }), "tolerance"));
  EXPECT_TRUE(says(error_of([](Occupancy& o) { o.pieces[1].vertices[0] *= 0.1; }), "not convex"));
  for (const char* vertices : {"[[0, 0, 0]]", "0 0", "0 0 x", "0 0 nan", "0 0 1e999", "0,0 0 0"}) {
    const std::string text = std::string("pieces:\n  - {link: a, vertices: ") + vertices;
    EXPECT_THROW(load_occupancy(text + ", triangles: 0 0 0}\n"), LoadError) << vertices;
  }
  EXPECT_THROW(load_occupancy("pieces:\n  - {link: a, vertices: 0 0 0, triangles: 0 0 0.5}\n"),
               LoadError);
}

}  // namespace
}  // namespace pdoik::detail
