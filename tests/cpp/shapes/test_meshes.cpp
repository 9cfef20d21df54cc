#include <gtest/gtest.h>

#include <cmath>

#include "arms.hpp"
#include "meshes.hpp"
#include "pdoik/solver.hpp"
#include "pdoik/tracker.hpp"
#include "random_shapes.hpp"
#include "shapes/convex_distance.hpp"
#include "shapes/shape_parts.hpp"
#include "shapes/shape_set.hpp"

/// Meshes of any form and grids as obstacles: what they are made of, distances from them, and
/// solves in and among them.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kFar = std::numeric_limits<double>::infinity();

Eigen::Isometry3d somewhere(Random& random) {
  Eigen::Isometry3d T(Eigen::Translation3d(random.point(0.5)));
  T.linear() = Eigen::Quaterniond(Eigen::Vector4d(random.uniform(-1, 1), random.uniform(-1, 1),
                                                  random.uniform(-1, 1), random.uniform(-1, 1)))
                   .normalized()
                   .toRotationMatrix();
  return T;
}

/// Of a segment from all parts.
SegmentSolidDistance nearest_part(const std::vector<Solid>& parts, const Eigen::Vector3d& middle,
                                  const Eigen::Vector3d& half) {
  SegmentSolidDistance nearest{kFar, {}, {}};
  for (const Solid& part : parts) {
    const auto found = part.distance(to_vec4(middle), to_vec4(half), kFar);
    if (found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

/// The signed distance of a point from the solid of `torus`, which its facets are within of.
double ring_distance(const Eigen::Vector3d& p, double radius, double thick) {
  return std::hypot(std::hypot(p.x(), p.y()) - radius, p.z()) - thick;
}

TEST(Mesh, segments_outside_are_as_far_as_their_nearest_points_are_from_its_triangles) {
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Shape mesh = torus("ring", somewhere(random), 0.3, 0.1, 12, 7);
    const std::vector<Solid> parts = parts_of(mesh);
    for (int k = 0; k < 40; ++k) {
      const Eigen::Vector3d middle = random.point(0.8), half = random.point(0.3);
      double least = kFar;
      for (int n = -100; n <= 100; ++n)
        least = std::min(least, surface_distance(mesh, middle + n / 100.0 * half));
      const SegmentSolidDistance found = nearest_part(parts, middle, half);
      if (found.distance < 0.0) {
        EXPECT_LT(least, 0.005 * half.norm() + 1e-9 - 2.0 * found.distance);
        continue;
      }
      EXPECT_LE(found.distance, least + 1e-12);
      EXPECT_GE(found.distance, least - 0.01 * half.norm());
      const Eigen::Vector3d at = to_vector3(found.point);
      EXPECT_NEAR(surface_distance(mesh, at), found.distance, 1e-9);
      EXPECT_NEAR(to_vector3(found.gradient).norm(), 1.0, 1e-9);
      EXPECT_NEAR(surface_distance(mesh, at - found.distance * to_vector3(found.gradient)), 0.0,
                  1e-7);
    }
  }
}

TEST(Mesh, of_a_closed_one_boxes_fill_the_inside_and_nothing_else) {
  for (int seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const double radius = 0.3, thick = random.uniform(0.06, 0.15);
    Shape mesh = torus("ring", somewhere(random), radius, thick, 60, 30);
    if (seed % 2 == 0) {  // whichever way its triangles turn
      for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    }
    ASSERT_EQ(open_edges(mesh), 0);
    int inside = 0;
    std::vector<Solid> boxes;
    for (const Solid& part : parts_of(mesh))
      if (!part.is_surface()) boxes.push_back(part);
    ASSERT_FALSE(boxes.empty());
    const double diagonal = std::sqrt(3.0) * 2.0 * (radius + thick) / 60.0;
    for (int k = 0; k < 4000; ++k) {
      const Eigen::Vector3d p = random.point(radius + thick), placed = mesh.T_base_shape * p;
      bool is_in_box = false;
      for (const Solid& box : boxes)
        is_in_box = is_in_box || box.distance(to_vec4(placed)).distance <= 0.0;
      const double depth = -ring_distance(p, radius, thick);
      if (is_in_box) {
        EXPECT_GT(depth, 0.0);
      }
      if (depth > diagonal) {
        EXPECT_TRUE(is_in_box) << depth;
        ++inside;
      }
    }
    EXPECT_GT(inside, 50);
  }
}

TEST(Mesh, open_edges_are_counted_whatever_vertices_are_shared) {
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  Shape mesh = box_mesh("box", T, {0.2, 0.3, 0.4}, 3);  // whose faces have vertices of their own
  EXPECT_EQ(open_edges(mesh), 0);
  mesh.triangles.pop_back();
  EXPECT_EQ(open_edges(mesh), 3);
  for (const Solid& part : parts_of(mesh)) EXPECT_TRUE(part.is_surface());
  mesh.triangles.resize(1);
  EXPECT_EQ(open_edges(mesh), 3);
}

TEST(Mesh, held_boxes_are_as_far_from_one_of_a_box_as_from_the_box) {
  for (int seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Eigen::Isometry3d T = somewhere(random);
    const Eigen::Vector3d size(random.uniform(0.1, 0.5), random.uniform(0.1, 0.5), 0.3);
    const std::vector<Solid> parts = parts_of(box_mesh("mesh", T, size, 2));
    const Solid box(Shape::box("box", T, size));
    const Solid held(random_shape(random, random.integer(0, 3)));
    const Frame frame = to_frame(somewhere(random));
    const double expected = convex_distance(held, frame, box).distance;
    double least = kFar;
    for (const Solid& part : parts)
      least = std::min(least, convex_distance(held, frame, part).distance);
    if (expected > 1e-6) {
      EXPECT_NEAR(least, expected, 1e-7);
    } else {
      EXPECT_LT(least, 1e-6);
    }
  }
}

TEST(Grid, boxes_hold_each_cell_that_is_taken_once_and_no_other) {
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const std::array<int, 3> counts{random.integer(1, 9), random.integer(1, 9),
                                    random.integer(2, 9)};
    std::vector<std::uint8_t> taken(static_cast<std::size_t>(counts[0] * counts[1] * counts[2]));
    for (auto& cell : taken) cell = random.uniform(0.0, 1.0) < 0.6 ? 1 : 0;
    taken[0] = 1;
    const Shape grid = Shape::grid("grid", Eigen::Isometry3d::Identity(), taken, counts, 0.1);
    EXPECT_LT(grid.vertices.size() / 2, taken.size());
    std::size_t cell = 0;
    for (int i = 0; i < counts[0]; ++i) {
      for (int j = 0; j < counts[1]; ++j) {
        for (int k = 0; k < counts[2]; ++k, ++cell) {
          const Eigen::Vector3d middle = 0.1 * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
          int holding = 0;
          for (std::size_t b = 0; b < grid.vertices.size(); b += 2)
            holding += Eigen::AlignedBox3d(grid.vertices[b], grid.vertices[b + 1]).contains(middle);
          EXPECT_EQ(holding, taken[cell]);
        }
      }
    }
  }
}

TEST(Mesh, nonsense_is_refused_by_name) {
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  const auto refused = [](const Shape& shape) {
    try {
      check_shape(shape);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  EXPECT_NE(refused(Shape::mesh("m", T, corners, {})).find("expected 1 at least"),
            std::string::npos);
  EXPECT_NE(refused(Shape::mesh("m", T, corners, {{{0, 1, 2}}})).find("has an area"),
            std::string::npos);
  EXPECT_NE(refused(Shape::mesh("m", T, corners, {{{0, 1, 9}}})).find("names vertex 9"),
            std::string::npos);
  EXPECT_EQ(refused(Shape::mesh("m", T, corners, {{{0, 1, 3}}})), "");
  const Eigen::AlignedBox3d flat(Eigen::Vector3d::Zero(), Eigen::Vector3d(1, 1, 0));
  EXPECT_NE(refused(Shape::boxes("b", T, {&flat, 1})).find("box 0 has no room"), std::string::npos);
  EXPECT_THROW(Shape::grid("g", T, std::vector<std::uint8_t>(8), {2, 2, 2}, 0.1),
               std::invalid_argument);
  EXPECT_THROW(Shape::grid("g", T, std::vector<std::uint8_t>(7, 1), {2, 2, 2}, 0.1),
               std::invalid_argument);
  EXPECT_THROW(Shape::grid("g", T, std::vector<std::uint8_t>(8, 1), {2, 2, 2}, 0.0),
               std::invalid_argument);
  EXPECT_THROW(Shape::grid("g", T, {}, {-1, 1, 1}, 0.1), std::invalid_argument);
  Solver solver(Robot::builtin("panda"), {});
  const Shape ring = torus("ring", T, 0.1, 0.02, 8, 5);
  try {
    solver.attach("panda_link8", {&ring, 1}, {});
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("convex pieces"), std::string::npos);
  }
}

/// How near what the robot's capsules surround comes to a mesh, less their radii.
double capsules_to_mesh(const Robot& robot, const Eigen::VectorXd& q, const Shape& mesh) {
  double least = kFar;
  std::vector<Eigen::Isometry3d> T(robot.bodies().size());
  robot.body_poses(q, T);
  for (const Capsule& capsule : robot.occupancy().capsules) {
    const int link = robot.link_index(capsule.link);
    const Eigen::Isometry3d at =
        T[static_cast<std::size_t>(robot.body_of_link(link))] * robot.T_body_link(link);
    const Eigen::Vector3d a = at * capsule.a, b = at * capsule.b;
    for (int n = 0; n <= 60; ++n) {
      least = std::min(least, surface_distance(mesh, a + n / 60.0 * (b - a)) - capsule.radius);
    }
  }
  return least;
}

TEST(Mesh, answers_in_and_among_them_are_clear) {
  int asked = 0, solved = 0;
  for (int seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = Robot::builtin(arm_names()[static_cast<std::size_t>(seed % 3)]);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.02);
    std::vector<Shape> rings;
    for (int tries = 0; rings.size() < 3 && tries < 60; ++tries) {
      const Shape ring =
          torus("ring" + std::to_string(rings.size()), somewhere(random), 0.25, 0.05, 14, 7);
      if (capsules_to_mesh(robot, q, ring) > 0.01) rings.push_back(ring);
    }
    Solver solver(robot, {});
    solver.set_shapes(Shapes(rings));
    const Result result = solver.solve(robot.fk(q));
    ++asked;
    if (!result.success) continue;
    ++solved;
    double least = kFar;
    for (const Shape& ring : rings)
      least = std::min(least, capsules_to_mesh(robot, result.q, ring));
    EXPECT_GT(least, -1e-4);
    EXPECT_LE(result.clearance, least + 1e-9);
  }
  EXPECT_GE(solved, asked - 2);
}

TEST(Mesh, a_tracker_stops_before_one) {
  const Robot robot = without_pieces(Robot::builtin("panda"));
  Eigen::VectorXd q(7);
  q << 0.0, -0.3, 0.0, -2.2, 0.0, 2.0, 0.8;
  Eigen::Isometry3d goal = robot.fk(q);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = goal.translation() + Eigen::Vector3d(0.0, 0.35, 0.0);
  for (const bool is_open : {false, true}) {
    SCOPED_TRACE(is_open);
    Shape wall = box_mesh("wall", T, {1.0, 0.04, 1.0}, 6);
    if (is_open) wall.triangles.pop_back();
    TrackerOptions options;
    options.period = 0.002;
    options.max_time = 10.0;
    Tracker tracker(robot, {}, options);
    tracker.reset(q);
    tracker.set_shapes(Shapes({wall}));
    Eigen::Isometry3d target = goal;
    for (int k = 0; k < 300; ++k) {
      target.translation().y() += 0.002;
      const TrackerResult& step = tracker.step(target);
      if (k % 10 != 0) continue;
      ASSERT_GE(capsules_to_mesh(robot, step.q, wall), -1e-4) << k;
    }
  }
}

}  // namespace
}  // namespace pdoik::detail
