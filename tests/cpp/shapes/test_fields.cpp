#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "arms.hpp"
#include "pdoik/solver.hpp"
#include "pdoik/tracker.hpp"
#include "random_shapes.hpp"
#include "shapes/convex_distance.hpp"
#include "shapes/field_distance.hpp"
#include "shapes/shape_set.hpp"
#include "shapes/solid.hpp"

/// Fields of signed distances as obstacles: values and gradients between the cells, the least along
/// segments and of solids in them, and what follows from truncated and unknown values.
namespace pdoik::detail {
namespace {

using namespace pdoik::testing;
using Eigen::Vector3d;

constexpr double kFar = std::numeric_limits<double>::infinity();
using Distance = std::function<double(const Vector3d&)>;

/// Of the middles of cells of one edge about the frame's origin.
struct Sampled {
  Sampled(const Distance& distance, const std::array<int, 3>& counts_in, double cell_in)
      : counts(counts_in), cell(cell_in) {
    for (int i = 0; i < counts[0]; ++i) {
      for (int j = 0; j < counts[1]; ++j) {
        for (int k = 0; k < counts[2]; ++k)
          values.push_back(static_cast<float>(distance(middle(i, j, k))));
      }
    }
  }
  Vector3d middle(int i, int j, int k) const {
    return cell * Vector3d(i + 0.5 - 0.5 * counts[0], j + 0.5 - 0.5 * counts[1],
                           k + 0.5 - 0.5 * counts[2]);
  }
  /// The frame whose grid has its middle at the origin of T.
  Eigen::Isometry3d frame(const Eigen::Isometry3d& T) const {
    return T * Eigen::Translation3d(-0.5 * cell * Vector3d(counts[0], counts[1], counts[2]));
  }
  Shape shape(const Eigen::Isometry3d& T, const DistanceField::Options& options = {}) const {
    return Shape::distance_field("field", frame(T), DistanceField(values, counts, cell, options));
  }
  std::array<int, 3> counts;
  double cell;
  std::vector<float> values;
};

Eigen::Isometry3d somewhere(Random& random) {
  Eigen::Isometry3d T(Eigen::Translation3d(random.point(0.5)));
  T.linear() = Eigen::Quaterniond(Eigen::Vector4d(random.uniform(-1, 1), random.uniform(-1, 1),
                                                  random.uniform(-1, 1), random.uniform(-1, 1)))
                   .normalized()
                   .toRotationMatrix();
  return T;
}

double box_distance(const Vector3d& p, const Vector3d& half) {
  const Vector3d over = p.cwiseAbs() - half;
  return over.cwiseMax(0.0).norm() + std::min(over.maxCoeff(), 0.0);
}

/// Of two boxes and a ball.
double things(const Vector3d& p) {
  return std::min({box_distance(p - Vector3d(0.12, 0.0, -0.1), Vector3d(0.1, 0.05, 0.08)),
                   box_distance(p + Vector3d(0.15, 0.1, 0.0), Vector3d(0.02, 0.12, 0.2)),
                   (p - Vector3d(-0.05, 0.15, 0.1)).norm() - 0.07});
}

/// The interpolation and what is beside its box by their definition, in the frame of the grid's
/// middle.
double looked_up(const Sampled& field, const Vector3d& p) {
  Vector3d at, inside;
  for (int a = 0; a < 3; ++a) {
    const int count = field.counts[static_cast<std::size_t>(a)];
    at[a] = p[a] / field.cell + 0.5 * count - 0.5;
    inside[a] = std::clamp(at[a], 0.0, count - 1.0);
  }
  double value = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    std::size_t place = 0;
    for (int a = 0; a < 3; ++a) {
      const int count = field.counts[static_cast<std::size_t>(a)];
      const int low = std::min(static_cast<int>(inside[a]), count - 2);
      const bool is_high = (corner >> a & 1) != 0;
      weight *= is_high ? inside[a] - low : 1.0 - (inside[a] - low);
      place = place * static_cast<std::size_t>(count) + static_cast<std::size_t>(low + is_high);
    }
    value += weight * static_cast<double>(field.values[place]);
  }
  const double off = field.cell * (at - inside).norm();
  return off == 0.0 ? value : value > 0.0 ? std::hypot(value, off) : value + off;
}

TEST(DistanceField, points_are_as_far_as_the_interpolation_says_and_its_gradient_is_exact) {
  const Sampled sampled(things, {31, 27, 25}, 0.02);
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Eigen::Isometry3d T = somewhere(random);
    const Solid solid(sampled.shape(T));
    const Vector3d local = random.point(0.4);
    const SolidDistance found = solid.distance(to_vec4(T * local));
    EXPECT_NEAR(found.distance, looked_up(sampled, local), 1e-12);
    constexpr double kStep = 1e-6;
    const auto cell_of = [&](const Vector3d& p) {
      return Eigen::Vector3i(
          (p / sampled.cell + Vector3d(15.0, 13.0, 12.0)).array().floor().cast<int>());
    };
    for (int a = 0; a < 3; ++a) {
      const Vector3d step = kStep * Vector3d::Unit(a);
      if (cell_of(local - step) != cell_of(local + step)) continue;
      const double slope =
          (looked_up(sampled, local + step) - looked_up(sampled, local - step)) / (2.0 * kStep);
      EXPECT_NEAR((T.linear().transpose() * to_vector3(found.gradient))[a], slope, 1e-6);
    }
  }
}

TEST(DistanceField, it_is_off_by_less_than_cells_are_wide) {
  const Sampled sampled(things, {31, 27, 25}, 0.02);
  const Solid solid(sampled.shape(Eigen::Isometry3d::Identity()));
  Random random(5);
  double worst = 0.0;
  for (int k = 0; k < 20'000; ++k) {
    const Vector3d p = random.point(1.0).cwiseProduct(Vector3d(0.29, 0.25, 0.23));
    const double off = solid.distance(to_vec4(p)).distance - things(p);
    worst = std::max(worst, std::abs(off));
  }
  EXPECT_LT(worst, 0.5 * std::sqrt(3.0) * 0.02);
  EXPECT_GT(worst, 0.1 * 0.02);  // or the points lie nowhere near an edge
}

/// The least of many points of a segment, and by what it may be too large.
double least_along(const Solid& solid, const Vector3d& middle, const Vector3d& half, int steps) {
  double least = kFar;
  for (int n = -steps; n <= steps; ++n)
    least = std::min(
        least, solid.distance(to_vec4(middle + static_cast<double>(n) / steps * half)).distance);
  return least;
}

TEST(DistanceField, segments_are_as_far_as_the_nearest_of_their_points) {
  const Sampled sampled(things, {31, 27, 25}, 0.02);
  int touching = 0;
  for (std::uint64_t seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Eigen::Isometry3d T = somewhere(random);
    const Solid solid(sampled.shape(T));
    const Vector3d middle = T * random.point(seed % 4 == 0 ? 0.6 : 0.25),
                   half = T.linear() * random.point(seed % 5 == 0 ? 0.02 : 0.3);
    constexpr int kSteps = 3000;
    const double least = least_along(solid, middle, half, kSteps);
    const SegmentSolidDistance found = solid.distance(to_vec4(middle), to_vec4(half), kFar);
    EXPECT_LE(found.distance, least + 1.1e-6);
    EXPECT_GE(found.distance, least - solid.steepest() * half.norm() / kSteps);
    EXPECT_NEAR(solid.distance(found.point).distance, found.distance, 1e-9);
    touching += found.distance < 0.0 ? 1 : 0;
    // With a bound what is nearer is found as well, and nothing else is said to be.
    for (const double than : {found.distance + 1e-5, found.distance - 1e-5}) {
      const double again = solid.distance(to_vec4(middle), to_vec4(half), than).distance;
      if (found.distance < than)
        EXPECT_NEAR(again, found.distance, 2e-6);
      else
        EXPECT_GE(again, than);
    }
    EXPECT_LE(solid.bound(to_vec4(middle), to_vec4(half), 0.03), found.distance - 0.03 + 1e-9);
    EXPECT_LE(solid.bound(to_vec4(middle), half.norm() + 0.03), found.distance - 0.03 + 1e-9);
  }
  EXPECT_GT(touching, 100);
}

TEST(DistanceField, along_a_segment_the_distance_changes_as_its_gradient_says) {
  const Sampled sampled(
      [](const Vector3d& p) { return (p - Vector3d(0.1, 0.05, 0.0)).norm() - 0.1; }, {30, 30, 30},
      0.02);
  int looked_at = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Solid solid(sampled.shape(Eigen::Isometry3d::Identity()));
    const Vector3d middle = random.point(0.25), half = random.point(0.2);
    const auto at = [&](const Vector3d& moved, const Vector3d& turned) {
      return solid.distance(to_vec4(moved), to_vec4(turned), kFar);
    };
    const SegmentSolidDistance found = at(middle, half);
    const Vector3d point = to_vector3(found.point);
    if (point.cwiseAbs().maxCoeff() > 0.28) continue;  // beside the grid
    // The segment as a part of a body that moves and turns.
    const Vector3d move = random.point(1.0), axis = random.point(1.0);
    constexpr double kStep = 1e-6;
    const auto after = [&](double step) {
      const auto moved = [&](const Vector3d& p) {
        return Vector3d(p + step * (move + axis.cross(p)));
      };
      return at(moved(middle), moved(middle + half) - moved(middle)).distance;
    };
    const double forth = (after(kStep) - found.distance) / kStep,
                 back = (found.distance - after(-kStep)) / kStep;
    if (std::abs(forth - back) > 1e-3) continue;  // a border of cells
    ++looked_at;
    EXPECT_NEAR(to_vector3(found.gradient).dot(move + axis.cross(point)), 0.5 * (forth + back),
                1e-3);
  }
  EXPECT_GT(looked_at, 100);
}

TEST(DistanceField, nothing_passes_through_a_wall_of_a_cell_unseen) {
  const double cell = 0.02;
  // Thinner than a cell, and so placed that no value is negative.
  const Sampled sampled(
      [&](const Vector3d& p) { return std::abs(p.x() - 0.5 * cell) - 0.2 * cell; }, {40, 40, 40},
      cell);
  Random random(3);
  for (int k = 0; k < 300; ++k) {
    const Solid solid(sampled.shape(Eigen::Isometry3d::Identity()));
    Vector3d from = random.point(0.35), to = random.point(0.35);
    from.x() = -0.05 - 0.3 * random.uniform(0, 1), to.x() = 0.05 + 0.3 * random.uniform(0, 1);
    const auto found = solid.distance(to_vec4(0.5 * (from + to)), to_vec4(0.5 * (to - from)), kFar);
    EXPECT_LT(found.distance, 0.5 * std::sqrt(3.0) * cell - 0.2 * cell);
  }
}

TEST(DistanceField, truncated_distances_follow_from_those_that_are_known) {
  const double cell = 0.02;
  for (const double truncation : {0.05, 0.08}) {
    const auto clipped = [&](const Vector3d& p) {
      return std::clamp(things(p), -truncation, truncation);
    };
    const Sampled sampled(clipped, {31, 27, 25}, cell), whole(things, {31, 27, 25}, cell);
    for (const double told : {truncation, -1.0}) {
      DistanceField::Options options;
      options.truncation = told;
      const DistanceField field(sampled.values, sampled.counts, cell, options);
      for (std::size_t c = 0; c < whole.values.size(); ++c) {
        const auto expected = static_cast<double>(whole.values[c]),
                   found = static_cast<double>(field.values()[c]);
        if (std::abs(expected) < 0.99 * truncation) {
          EXPECT_EQ(field.values()[c], sampled.values[c]);
        } else if (expected > 0.0) {
          EXPECT_GE(found, expected - 1e-6);
          EXPECT_LE(found, expected + cell);
        } else {
          EXPECT_LE(found, -truncation + 1e-6 + cell);
        }
      }
    }
  }
}

TEST(DistanceField, what_is_not_known_is_free_or_solid) {
  const double cell = 0.02;
  // Known in front of a wall at x = 0 and a little into it, and nothing of the upper half.
  const auto seen = [&](const Vector3d& p) {
    return p.x() > 0.05 || p.z() > 0.0 ? std::nan("") : -p.x();
  };
  const Sampled sampled(seen, {30, 20, 20}, cell);
  DistanceField::Options options;
  options.truncation = kFar;
  const auto at = [&](const DistanceField& field, int i, int j, int k) {
    return static_cast<double>(field.values()[static_cast<std::size_t>((i * 20 + j) * 20 + k)]);
  };
  const DistanceField free(sampled.values, sampled.counts, cell, options);
  options.unknown = DistanceField::Unknown::Occupied;
  const DistanceField solid(sampled.values, sampled.counts, cell, options);
  for (int i = 0; i < 30; ++i) {
    for (int k = 0; k < 20; ++k) {
      const Vector3d p = sampled.middle(i, 10, k);
      if (std::isnan(seen(p))) {
        EXPECT_GT(at(free, i, 10, k), 0.0);
        EXPECT_LT(at(solid, i, 10, k), 0.0);
        continue;
      }
      EXPECT_NEAR(at(free, i, 10, k), -p.x(), 1e-6);
      // Unknown is what is above, from the border of the cells on.
      EXPECT_NEAR(at(solid, i, 10, k), std::min(-p.x(), -p.z()), 0.5 * cell);
    }
  }
  // Beside the wall what is unknown and free is as far from it as from its known part.
  const Vector3d above = sampled.middle(5, 10, 15);
  EXPECT_NEAR(at(free, 5, 10, 15), std::hypot(above.x(), above.z()), 1.5 * cell);
}

TEST(DistanceField, solids_in_it_are_as_far_as_the_nearest_of_their_points) {
  const Sampled sampled(things, {31, 27, 25}, 0.02);
  int kinds[3] = {0, 0, 0}, exact = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Eigen::Isometry3d T_field = somewhere(random), T_body = somewhere(random);
    const Solid field(sampled.shape(T_field));
    Shape shape = random_shape(random, random.integer(0, 3), "moving");
    if (seed % 4 == 0) shape = random_shape(random, 5, "moving");
    const Eigen::Isometry3d there = T_field * Eigen::Translation3d(random.point(0.3));
    // Where its middle is in the field.
    const Solid moving(shape);
    Eigen::Isometry3d T = T_body;
    T.translation() += there.translation() - T_body * to_vector3(moving.centre());
    const ConvexDistance found = convex_distance(moving, to_frame(T), field);
    // Points of it, within its rounding.
    double least = kFar;
    for (int n = 0; n < 20'000; ++n) {
      const Vec4 p = moving.centre() + to_vec4(moving.radius() * random.point(1.0));
      const SolidDistance off = moving.distance(p);
      const double beyond = off.distance + moving.rounding();
      const Vec4 in = beyond > 0.0 ? p - broadcast(beyond) * off.gradient : p;
      least = std::min(least, field.distance(transform(to_frame(T), in)).distance);
    }
    const double over = found.distance - (least - moving.rounding());
    EXPECT_LE(over, 0.5 * std::sqrt(3.0) * 0.02 * field.steepest());
    exact += over < 1e-5 ? 1 : 0;
    // It is the value of one of its points.
    const Vec4 body_point = to_local(to_frame(T), found.point);
    EXPECT_LE(moving.distance(body_point).distance + moving.rounding(), 1e-9);
    EXPECT_NEAR(field.distance(found.point).distance - moving.rounding(), found.distance, 1e-9);
    ++kinds[found.distance > 0.05 ? 0 : found.distance > 0.0 ? 1 : 2];
  }
  for (const int kind : kinds) EXPECT_GT(kind, 20);
  EXPECT_GT(exact, 350);
}

}  // namespace
}  // namespace pdoik::detail
