#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "brute_force.hpp"
#include "finite_differences.hpp"
#include "workbench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kContactGap = 1e-8;  // the solver aims this far beyond contact

std::unique_ptr<Workbench> bench_of(int seed, GoalType goal, Random& random) {
  const RobotKind serial{.joints = 6, .prismatic = 0.2, .continuous = 0.1};
  Robot robot = random_robot(random, seed % 2 == 0 ? kMixedTree : serial);
  robot.set_occupancy(random_occupancy(robot, random, 3, 5));
  Options options;
  options.goal = goal;
  options.goal_axis = random.direction();
  options.rotation_weight = random.uniform(0.1, 1.0);
  options.collision_weight = random.uniform(0.3, 3.0);
  auto bench = std::make_unique<Workbench>(robot, options);
  bench->set_obstacles(random_obstacles(random, 20, 0.8, seed % 3 == 0 ? 0.15 : 0.0));
  bench->set_target(robot.fk(random_configuration(robot, random)));
  return bench;
}

template <class Check>
void for_seeds(int seeds, Check&& check) {
  for (int seed = 1; seed <= seeds; ++seed) {
    for (const GoalType goal : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", goal " +
                   std::to_string(static_cast<int>(goal)));
      Random random(static_cast<std::uint64_t>(seed));
      check(*bench_of(seed, goal, random), random, seed);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

/// Penetration in metres of every pair that joints can part, shape (pairs,): true distances for
/// points with a radius, half the excess of the half sum for points without.
Eigen::VectorXd penetrations(const Workbench& bench, const Eigen::VectorXd& q) {
  const Occupancy& occupancy = bench.robot.occupancy();
  const std::vector<bool> moves = hulls_that_move(bench.robot);
  const Eigen::MatrixXd paper = paper_constraints(bench.robot, q, bench.obstacles);
  std::vector<double> all;
  for (Eigen::Index i = 0; i < paper.rows(); ++i) {
    if (!moves[static_cast<std::size_t>(i)]) continue;
    const auto sphere_count = static_cast<Eigen::Index>(occupancy.spheres.size());
    for (Eigen::Index j = 0; j < paper.cols(); ++j) {
      const double radius = bench.obstacles.cols() > 3 ? bench.obstacles(j, 3) : 0.0;
      double c = i < sphere_count ? paper(i, j) : 0.5 * paper(i, j);
      if (i >= sphere_count && radius > 0.0 && c < radius) {
        const Spheroid& s = occupancy.spheroids[static_cast<std::size_t>(i - sphere_count)];
        const Eigen::Vector3d a = bench.robot.fk(q, s.link_a) * s.focus_a,
                              b = bench.robot.fk(q, s.link_b) * s.focus_b;
        if (2.0 * s.semi_major > (a - b).norm()) {
          c = radius -
              spheroid_distance(bench.obstacles.row(j).head<3>().transpose(), a, b, s.semi_major)
                  .distance;
        }
      }
      all.push_back(c);
    }
  }
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

/// Whether a point with a radius is about to enter a spheroid, where its constraint changes form,
/// or a pair to touch.
bool near_a_kink(const Workbench& bench, const Eigen::VectorXd& q, double within) {
  const Eigen::VectorXd c = penetrations(bench, q);
  if ((c.array().abs() < within).any()) return true;
  const Eigen::MatrixXd paper = paper_constraints(bench.robot, q, bench.obstacles);
  for (Eigen::Index j = 0; j < paper.cols() && bench.obstacles.cols() > 3; ++j) {
    if (((0.5 * paper.col(j).array() - bench.obstacles(j, 3)).abs() < within).any()) return true;
  }
  return false;
}

TEST(LeastSquares, the_objective_is_half_the_weighted_sum_of_squared_errors_and_penetrations) {
  int touching = 0;
  for_seeds(30, [&](Workbench& bench, Random& random, int) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    const Eigen::Isometry3d T = bench.robot.fk(q);
    double rotation = 0.0;
    if (bench.options.goal == GoalType::Pose) {
      rotation = Eigen::AngleAxisd(T.linear() * bench.target.linear().transpose()).angle();
    } else if (bench.options.goal == GoalType::Axis) {
      const Eigen::Vector3d axis = bench.options.goal_axis.normalized();
      rotation =
          std::acos(std::clamp((T.linear() * axis).dot(bench.target.linear() * axis), -1.0, 1.0));
    }
    const double v = bench.options.collision_weight, w = bench.options.rotation_weight;
    const Eigen::ArrayXd c = (penetrations(bench, q).array() + kContactGap).max(0.0);
    const double expected = 0.5 * ((T.translation() - bench.target.translation()).squaredNorm() +
                                   w * w * rotation * rotation + v * v * c.square().sum());
    EXPECT_NEAR(bench.least_squares.evaluate(q), expected, 1e-9 * (1.0 + expected));
    touching += (c > 0.0).any();
  });
  EXPECT_GT(touching, 30);
}

TEST(LeastSquares, its_gradient_is_the_central_difference_of_the_objective) {
  int checked = 0, with_radius = 0;
  for_seeds(60, [&](Workbench& bench, Random& random, int seed) {
    Eigen::VectorXd q = random_configuration(bench.robot, random);
    if (seed % 4 == 0)
      q = q.cwiseMax(bench.robot.lower())
              .cwiseMin(bench.robot.lower().cwiseMax(q.array().matrix()));
    constexpr double h = 1e-6;
    if (near_a_kink(bench, q, 20.0 * h)) return;
    const Eigen::VectorXd difference = central_gradient(
        [&](const Eigen::VectorXd& at) { return bench.least_squares.evaluate(at); }, q, h);
    Eigen::MatrixXd H(q.size(), q.size());
    Eigen::VectorXd g(q.size());
    bench.least_squares.evaluate(q);
    bench.least_squares.linearise(H, g);
    ASSERT_LT((g - difference).lpNorm<Eigen::Infinity>(),
              2e-7 + 1e-8 * g.lpNorm<Eigen::Infinity>());
    ++checked;
    with_radius += bench.obstacles.cols() > 3 && penetrations(bench, q).maxCoeff() > 0.0;
  });
  EXPECT_GT(checked, 120);
  EXPECT_GT(with_radius, 15);
}

TEST(LeastSquares, its_hessian_is_positive_semidefinite) {
  for_seeds(30, [](Workbench& bench, Random& random, int) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    Eigen::MatrixXd H(q.size(), q.size());
    Eigen::VectorXd g(q.size());
    bench.least_squares.evaluate(q);
    bench.least_squares.linearise(H, g);
    const Eigen::MatrixXd full = H.selfadjointView<Eigen::Upper>();
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full).eigenvalues();
    EXPECT_GT(values.minCoeff(), -1e-12 * (1.0 + values.maxCoeff()));
    EXPECT_GT(values.maxCoeff(), 0.0);
  });
}

TEST(LeastSquares,
     its_hessian_is_jacobian_transpose_times_jacobian_of_the_residuals_where_the_rotation_matches) {
  // With a rotation error the library takes the angular velocity for the derivative of the rotation
  // vector: only at zero error are they the same, so the target's orientation is the tip's here.
  int touching = 0;
  for_seeds(40, [&](Workbench& bench, Random& random, int) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    Eigen::Isometry3d target = bench.robot.fk(q);
    target.translation() += random.point(0.5);
    bench.set_target(target);
    constexpr double h = 1e-6;
    if (near_a_kink(bench, q, 20.0 * h)) return;
    const auto residuals = [&](const Eigen::VectorXd& at) {
      const Eigen::Isometry3d T = bench.robot.fk(at);
      Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
      const Eigen::Vector3d axis = bench.options.goal_axis.normalized();
      if (bench.options.goal == GoalType::Pose)
        rotation = vee(T.linear() * target.linear().transpose());
      if (bench.options.goal == GoalType::Axis)
        rotation = (target.linear() * axis).cross(T.linear() * axis);
      const Eigen::VectorXd c = (penetrations(bench, at).array() + kContactGap).max(0.0);
      Eigen::VectorXd r(6 + c.size());
      r << T.translation() - target.translation(), bench.options.rotation_weight * rotation,
          bench.options.collision_weight * c;
      return r;
    };
    const Eigen::VectorXd r = residuals(q);
    Eigen::MatrixXd J(r.size(), q.size());
    for (Eigen::Index i = 0; i < q.size(); ++i) {
      Eigen::VectorXd above = q, below = q;
      above[i] += h, below[i] -= h;
      J.col(i) = (residuals(above) - residuals(below)) / (2.0 * h);
    }
    Eigen::MatrixXd H(q.size(), q.size());
    Eigen::VectorXd g(q.size());
    bench.least_squares.evaluate(q);
    bench.least_squares.linearise(H, g);
    const Eigen::MatrixXd expected = J.transpose() * J, full = H.selfadjointView<Eigen::Upper>();
    ASSERT_LT((full - expected).cwiseAbs().maxCoeff(),
              1e-6 * (1.0 + expected.cwiseAbs().maxCoeff()));
    ASSERT_LT((g - J.transpose() * r).cwiseAbs().maxCoeff(), 1e-6);
    touching += (r.tail(r.size() - 6).array() > 0.0).any();
  });
  EXPECT_GT(touching, 30);
}

TEST(LeastSquares, is_done_exactly_when_pose_and_contact_are_within_tolerance) {
  for_seeds(20, [](Workbench& bench, Random& random, int) {
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    const bool touches = (penetrations(bench, q).array() > 0.0).any();
    bench.set_target(bench.robot.fk(q));
    bench.least_squares.evaluate(q);
    EXPECT_EQ(bench.least_squares.done(), !touches);
    Eigen::Isometry3d off = bench.target;
    off.translation() += 1.01 * bench.options.position_tolerance * random.direction();
    bench.set_target(off);
    bench.least_squares.evaluate(q);
    EXPECT_FALSE(bench.least_squares.done());
  });
}

/// The envelope gradient of points with a radius, straight from the constraint.
TEST(LeastSquares, the_distance_constraints_derivatives_by_the_foci_are_central_differences) {
  Robot robot = Robot::builtin("panda");
  int with_radius = 0;
  for (int seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    Occupancy occupancy;
    Spheroid s{"panda_link3", random.point(0.1), "panda_link5", random.point(0.1), 0.0};
    s.semi_major = 0.35 + random.uniform(0.0, 0.2);
    occupancy.spheroids.push_back(s);
    robot.set_occupancy(occupancy);
    const HullModel hulls(robot);
    CollisionState state(hulls, hulls.moving);
    const Hull hull = hulls.moving.front();
    const Eigen::Vector3d a = random.point(0.2), b = random.point(0.2);
    const double radius = seed % 4 == 0 ? 0.0 : random.uniform(0.01, 0.2);
    const Eigen::Vector3d o =
        0.5 * (a + b) + random.uniform(0.8, 1.6) * s.semi_major * random.direction();
    const auto constraint = [&](const Eigen::VectorXd& foci) {
      state.place(static_cast<std::size_t>(hull.a), to_vec4(foci.head<3>()));
      state.place(static_cast<std::size_t>(hull.b), to_vec4(foci.tail<3>()));
      return distance_constraint(state, hull, Vec4{o.x(), o.y(), o.z(), radius});
    };
    Eigen::VectorXd foci(6), expected(6);
    foci << a, b;
    const Constraint at = constraint(foci);
    if (std::abs(at.c - radius) < 1e-5) continue;  // on the surface itself: a kink
    expected << to_vector3(at.dc_da), to_vector3(at.dc_db);
    const Eigen::VectorXd difference =
        central_gradient([&](const Eigen::VectorXd& f) { return constraint(f).c; }, foci, 1e-6);
    EXPECT_LT((difference - expected).lpNorm<Eigen::Infinity>(), 1e-8);
    with_radius += radius > 0.0 && at.c < radius;
    if (radius > 0.0 && at.c < radius) {
      EXPECT_NEAR(at.c, radius - brute_force_spheroid_distance(o, a, b, s.semi_major), 1e-11);
    }
  }
  EXPECT_GT(with_radius, 50);
}

TEST(LeastSquares, touches_where_some_point_is_in_some_hull) {
  Random random(21);
  int touched = 0, clear = 0;
  Options options;
  options.self_collision = false;
  for (int k = 0; k < 300; ++k) {
    Workbench bench(Robot::builtin(k % 2 == 0 ? "panda" : "ur10"), options);
    bench.set_obstacles(random_obstacles(random, 12, 0.7, k % 3 == 0 ? 0.0 : 0.1));
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    bench.least_squares.count_no_obstacles();
    const double alone = bench.least_squares.evaluate(q);
    const bool touches = bench.least_squares.touches();
    bench.roll_out(q);
    const Clearance least = bench.clearance();
    if (std::abs(least.distance) < 1e-9) continue;
    const bool fixed = bench.scene.fixed().distance < 0.0;  // moving hulls are asked alone
    if (!fixed) {
      EXPECT_EQ(touches, least.distance < 0.0);
    }
    (touches ? touched : clear) += 1;
    bench.least_squares.count_all_obstacles();
    const double with_all = bench.least_squares.evaluate(q);
    if (touches) {
      EXPECT_GT(with_all, alone);
    } else {
      EXPECT_NEAR(with_all, alone, 1e-12);
    }
  }
  EXPECT_GT(touched, 30);
  EXPECT_GT(clear, 30);
}

TEST(LeastSquares, about_a_configuration_counts_the_same_points_and_never_less) {
  Random random(22);
  int counted = 0;
  for (int k = 0; k < 100; ++k) {
    Workbench bench(Robot::builtin("panda"), Options{});
    const bool radii = k % 2 == 1;
    bench.set_obstacles(random_obstacles(random, 120, 0.6, radii ? 0.05 : 0.0));
    const Eigen::VectorXd q = random_configuration(bench.robot, random);
    const double all = bench.least_squares.evaluate(q);
    bench.least_squares.count_obstacles_within(0.1);
    EXPECT_LE(bench.least_squares.obstacle_count(), bench.scene.obstacles()->count());
    const double about = bench.least_squares.evaluate(q);
    if (radii) {
      EXPECT_GE(about, all * (1.0 - 1e-12)) << "the safe side";
    } else {
      EXPECT_NEAR(about, all, 1e-12 * (1.0 + all));
    }
    counted += bench.least_squares.obstacle_count();
    Eigen::MatrixXd H(q.size(), q.size());
    Eigen::VectorXd g(q.size());
    bench.least_squares.linearise(H, g);
    const Eigen::VectorXd difference = central_gradient(
        [&](const Eigen::VectorXd& at) { return bench.least_squares.evaluate(at); }, q, 1e-6);
    EXPECT_LT((g - difference).norm(), 1e-5 * (1.0 + g.norm()));
  }
  EXPECT_GT(counted, 500);
}

}  // namespace
}  // namespace pdoik::detail
