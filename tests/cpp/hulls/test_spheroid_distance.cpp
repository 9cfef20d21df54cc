#include <gtest/gtest.h>

#include "brute_force.hpp"
#include "finite_differences.hpp"
#include "hulls/spheroid_distance.hpp"
#include "random_robots.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

double level(const Eigen::Vector3d& x, const Eigen::Vector3d& f1, const Eigen::Vector3d& f2) {
  return 0.5 * ((x - f1).norm() + (x - f2).norm());
}

/// A spheroid of semi-axes a and b somewhere, and its own frame with x along the foci.
struct Somewhere {
  Somewhere(Random& random, double a_in, double b_in) : a(a_in), b(b_in), T(random.pose(1.0)) {
    const double f = std::sqrt((a - b) * (a + b));
    f1 = T * Eigen::Vector3d(-f, 0.0, 0.0);
    f2 = T * Eigen::Vector3d(f, 0.0, 0.0);
    const double angle = random.uniform(-M_PI, M_PI);
    side = {0.0, std::cos(angle), std::sin(angle)};
  }
  /// A point in the meridian plane of `side`: x along the axis, y away from it.
  Eigen::Vector3d at(double x, double y) const {
    return T * (x * Eigen::Vector3d::UnitX() + y * side);
  }
  SpheroidDistance distance(const Eigen::Vector3d& point) const {
    return spheroid_distance(point, f1, f2, a);
  }
  double a, b;
  Eigen::Isometry3d T;
  Eigen::Vector3d f1, f2, side;
};

/// Fat to thin, b / a from nearly 1 down to 0.01.
template <class Check>
void for_shapes(Check&& check) {
  int seed = 0;
  for (const double ratio : {0.999999, 0.99, 0.8, 0.5, 0.2, 0.05, 0.01}) {
    for (const double a : {0.05, 0.4}) {
      SCOPED_TRACE("b / a = " + std::to_string(ratio) + ", a = " + std::to_string(a));
      Random random(static_cast<std::uint64_t>(++seed));
      check(Somewhere(random, a, ratio * a), random);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

void expect_brute_force(const Somewhere& s, double x, double y, double tolerance) {
  const double expected = brute_force_ellipse_distance(s.a, s.b, x, y);
  ASSERT_NEAR(s.distance(s.at(x, y)).distance, expected, tolerance * s.a)
      << "x " << x << ", y " << y;
}

TEST(SpheroidDistance, is_the_brute_force_minimum_at_random_points) {
  for_shapes([](const Somewhere& s, Random& random) {
    for (int k = 0; k < 200; ++k) {
      const double x = random.uniform(-2.0, 2.0) * s.a;
      const double y = random.uniform(0.0, 2.0) * (k % 2 == 0 ? s.a : s.b);
      expect_brute_force(s, x, y, 1e-12);
    }
  });
}

TEST(SpheroidDistance,
     is_the_brute_force_minimum_on_the_axis_in_the_focal_segment_and_beyond_and_at_the_centre) {
  for_shapes([](const Somewhere& s, Random&) {
    const double cusp =
        (s.a * s.a - s.b * s.b) / s.a;  // of the evolute: beyond it the pole is nearest
    for (const double x : {0.0, 1e-12, 0.5 * cusp, 0.999 * cusp, cusp, 1.001 * cusp, 0.999 * s.a,
                           s.a, 1.001 * s.a, 3.0}) {
      for (const double sign : {1.0, -1.0}) expect_brute_force(s, sign * x, 0.0, 1e-12);
    }
  });
}

TEST(SpheroidDistance, is_the_brute_force_minimum_close_to_the_axis) {
  for_shapes([](const Somewhere& s, Random& random) {
    for (const double y : {1e-15, 3e-15, 1e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-8, 1e-6, 1e-4}) {
      for (int k = 0; k < 20; ++k)
        expect_brute_force(s, random.uniform(-1.3, 1.3) * s.a, y * s.a, 1e-11);
      expect_brute_force(s, 0.0, y * s.a, 1e-11);
      if (HasFailure()) return;
    }
  });
}

TEST(SpheroidDistance, is_zero_on_the_surface_and_changes_sign_there) {
  for_shapes([](const Somewhere& s, Random& random) {
    for (int k = 0; k < 100; ++k) {
      const double t = k < 2 ? k * M_PI_2 : random.uniform(0.0, M_PI);
      const Eigen::Vector2d point(s.a * std::cos(t), s.b * std::sin(t));
      const Eigen::Vector2d normal =
          Eigen::Vector2d(point.x() / (s.a * s.a), point.y() / (s.b * s.b)).normalized();
      const double step = 1e-6 * s.b * s.b / s.a;  // below the least radius of curvature
      EXPECT_NEAR(s.distance(s.at(point.x(), point.y())).distance, 0.0, 1e-14);
      for (const double sign : {1.0, -1.0}) {
        const Eigen::Vector2d off = point + sign * step * normal;
        EXPECT_NEAR(s.distance(s.at(off.x(), off.y())).distance, sign * step, 1e-14 + 1e-6 * step);
      }
    }
  });
}

TEST(SpheroidDistance, names_a_surface_point_that_is_as_far_as_it_says_along_the_normal) {
  for_shapes([](const Somewhere& s, Random& random) {
    for (int k = 0; k < 100; ++k) {
      const Eigen::Vector3d point = s.T * random.point(1.5 * s.a);
      const SpheroidDistance found = s.distance(point);
      EXPECT_NEAR(level(found.nearest, s.f1, s.f2), s.a, 1e-13);
      EXPECT_NEAR((point - found.nearest).norm(), std::abs(found.distance), 1e-13);
      EXPECT_EQ(found.distance < 0.0, level(point, s.f1, s.f2) < s.a);
      const Eigen::Vector3d normal =
          (found.nearest - s.f1).normalized() + (found.nearest - s.f2).normalized();
      EXPECT_LT((point - found.nearest).cross(normal.normalized()).norm(), 1e-10 * s.a * s.a / s.b);
    }
  });
}

TEST(SpheroidDistance, of_coincident_foci_is_that_of_a_sphere) {
  Random random(1);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d centre = random.point(1.0), point = centre + random.point(0.5);
    const Eigen::Vector3d aside =
        k % 2 == 0 ? Eigen::Vector3d::Zero() : Eigen::Vector3d(1e-13 * random.direction());
    const SpheroidDistance found = spheroid_distance(point, centre - aside, centre + aside, 0.3);
    EXPECT_NEAR(found.distance, (point - centre).norm() - 0.3, 1e-12);
  }
  const Eigen::Vector3d centre(0.1, 0.2, 0.3);
  EXPECT_NEAR(spheroid_distance(centre, centre, centre, 0.3).distance, -0.3, 1e-15);
}

TEST(SpheroidDistance, does_not_depend_on_which_focus_comes_first_or_where_it_all_lies) {
  Random random(2);
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector3d f1 = random.point(0.3), f2 = random.point(0.3), point = random.point(1.0);
    const double a = 0.5 * (f1 - f2).norm() + random.uniform(0.01, 0.2);
    const double distance = spheroid_distance(point, f1, f2, a).distance;
    const Eigen::Isometry3d T = random.pose(1.0);
    EXPECT_NEAR(spheroid_distance(point, f2, f1, a).distance, distance, 1e-13);
    EXPECT_NEAR(spheroid_distance(T * point, T * f1, T * f2, a).distance, distance, 1e-12);
  }
}

TEST(SpheroidDistance, by_the_half_sum_of_focal_distances_is_never_underestimated) {
  // Half the sum of distances to the foci less a is a lower bound on the distance outside: what
  // lets hulls grow by a point's radius. Inside it is an upper bound on minus the depth.
  for_shapes([](const Somewhere& s, Random& random) {
    for (int k = 0; k < 200; ++k) {
      const Eigen::Vector3d point = s.T * random.point(1.5 * s.a);
      const double bound = level(point, s.f1, s.f2) - s.a, distance = s.distance(point).distance;
      EXPECT_GE(std::abs(distance) + 1e-14, std::abs(bound));
      EXPECT_GE(distance * bound, -1e-14);
    }
  });
}

TEST(SpheroidDistance,
     by_the_envelope_theorem_its_derivative_is_that_of_the_surface_at_the_nearest_point) {
  for_shapes([](const Somewhere& s, Random& random) {
    for (int k = 0; k < 30; ++k) {
      const Eigen::Vector3d direction = random.direction();
      const Eigen::Vector3d point = s.T * (direction * s.a * random.uniform(1.1, 2.0));
      const SpheroidDistance found = s.distance(point);
      const Eigen::Vector3d to_1 = (s.f1 - found.nearest).normalized(),
                            to_2 = (s.f2 - found.nearest).normalized();
      const double slope = (to_1 + to_2).norm();  // of the sum of distances at the nearest point
      const auto by_foci = [&](const Eigen::VectorXd& foci) {
        return spheroid_distance(point, foci.head<3>(), foci.tail<3>(), s.a).distance;
      };
      Eigen::VectorXd foci(6), expected(6);
      foci << s.f1, s.f2;
      expected << to_1 / slope, to_2 / slope;
      EXPECT_LT((central_gradient(by_foci, foci, 1e-6 * s.b) - expected).norm(), 2e-6 * s.a / s.b);
      const auto by_point = [&](const Eigen::VectorXd& at) {
        return s.distance(Eigen::Vector3d(at)).distance;
      };
      const Eigen::Vector3d outwards = (point - found.nearest).normalized();
      EXPECT_LT((central_gradient(by_point, point, 1e-6 * s.b) - outwards).norm(),
                1e-6 * s.a / s.b);
    }
  });
}

}  // namespace
}  // namespace pdoik::detail
