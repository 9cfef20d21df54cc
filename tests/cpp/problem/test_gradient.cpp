#include <gtest/gtest.h>

#include "finite_differences.hpp"
#include "workbench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

/// What one run of the checks is about.
struct Case {
  int seed;
  GoalType goal;
  PenaltyForm form;
  std::string name() const {
    return "seed " + std::to_string(seed) + ", goal " + std::to_string(static_cast<int>(goal)) +
           (form == PenaltyForm::Smooth ? ", smooth" : ", printed");
  }
};

template <class Check>
void for_cases(int seeds, Check&& check) {
  for (int seed = 1; seed <= seeds; ++seed) {
    for (const PenaltyForm form : {PenaltyForm::Smooth, PenaltyForm::Printed}) {
      const Case c{seed, static_cast<GoalType>(seed % 3), form};
      SCOPED_TRACE(c.name());
      check(c);
      if (::testing::Test::HasFailure()) return;
    }
  }
}

/// A robot among points that touch it here and there: serial or tree, points with radii in every
/// third case.
std::unique_ptr<Workbench> bench_of(const Case& c, Random& random) {
  const RobotKind serial{.joints = 6, .prismatic = 0.2, .continuous = 0.1};
  Robot robot = random_robot(random, c.seed % 2 == 0 ? kMixedTree : serial);
  robot.set_occupancy(random_occupancy(robot, random, 3, 5));
  Options options;
  options.goal = c.goal;
  options.goal_axis = random.direction();
  options.clearance = c.seed % 4 == 0 ? 0.02 : 0.0;
  auto bench = std::make_unique<Workbench>(robot, options);
  bench->set_obstacles(random_obstacles(random, 20, 0.8, c.seed % 3 == 0 ? 0.15 : 0.0));
  bench->set_target(robot.fk(random_configuration(robot, random)));
  return bench;
}

/// Omega: ordinary, near the limits, or where a sphere just touches an obstacle.
Eigen::VectorXd omega_of(const Case& c, Workbench& bench, Random& random) {
  const double extent = c.seed % 7 == 0 ? 12.0 : 2.0;
  Eigen::VectorXd omega = random.vector(bench.map.size(), -extent, extent);
  // Half of the points lie a little inside or outside of some hull.
  ObstacleMatrix obstacles = bench.obstacles;
  const Eigen::VectorXd q = bench.positions(omega);
  const Occupancy& occupancy = bench.robot.occupancy();
  for (Eigen::Index k = 1; k < obstacles.rows() / 2; ++k) {
    const Sphere& s = occupancy.spheres[static_cast<std::size_t>(k) % occupancy.spheres.size()];
    const double distance = s.radius + random.uniform(-0.06, 0.06);
    const Eigen::Vector3d centre = bench.robot.fk(q, s.link) * s.center;
    obstacles.row(k).head<3>() = (centre + distance * random.direction()).transpose();
    if (obstacles.cols() > 3) obstacles(k, 3) = 0.0;
  }
  if (c.seed % 4 == 1 && obstacles.cols() == 3) {
    const Sphere& s = occupancy.spheres.front();
    const Eigen::Vector3d centre = bench.robot.fk(q, s.link) * s.center;
    const double depth =
        c.form == PenaltyForm::Printed ? 1e-4 : 0.0;  // the printed form has a kink there
    const double distance = s.radius + bench.options.clearance - depth;
    obstacles.row(0) = (centre + distance * random.direction()).transpose();
  }
  bench.set_obstacles(obstacles);
  return omega;
}

/// The augmented Lagrangian once more, over every pair and with multipliers for every pair.
struct PlainLagrangian {
  explicit PlainLagrangian(const Workbench& b) : bench(b), moves(hulls_that_move(b.robot)) {
    mu.setZero(static_cast<Eigen::Index>(moves.size()), b.obstacles.rows());
  }
  Eigen::MatrixXd constraints(const Eigen::VectorXd& omega) const {
    Eigen::MatrixXd c = paper_constraints(bench.robot, bench.positions(omega), bench.obstacles,
                                          bench.options.clearance);
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      if (!moves[static_cast<std::size_t>(i)])
        c.row(i).setConstant(-1e9);  // nothing the joints can do
    }
    return c;
  }
  double value(const Eigen::VectorXd& omega, const Penalty& penalty) const {
    const Eigen::Isometry3d T = bench.robot.fk(bench.positions(omega));
    const double k = bench.options.point_distance;
    std::vector<Eigen::Vector3d> points{Eigen::Vector3d::Zero()};
    if (bench.options.goal == GoalType::Pose) {
      points.insert(points.end(), {k * Eigen::Vector3d::UnitX(), k * Eigen::Vector3d::UnitY()});
    }
    if (bench.options.goal == GoalType::Axis)
      points.push_back(k * bench.options.goal_axis.normalized());
    double sum = 0.0;
    for (const Eigen::Vector3d& p : points) sum += 0.5 * (T * p - bench.target * p).squaredNorm();
    const Eigen::MatrixXd c = constraints(omega);
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      for (Eigen::Index j = 0; j < c.cols(); ++j) sum += penalty.term(c(i, j), mu(i, j)).value;
    }
    return sum;
  }
  void update(const Eigen::VectorXd& omega, const Penalty& penalty) {
    const Eigen::MatrixXd c = constraints(omega);
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      for (Eigen::Index j = 0; j < c.cols(); ++j)
        mu(i, j) = penalty.updated_multiplier(c(i, j), mu(i, j));
    }
  }
  /// How near omega is to where the penalty is not smooth: the second derivative jumps there, or
  /// the first.
  double distance_to_kink(const Eigen::VectorXd& omega, const Penalty& penalty) const {
    const Eigen::MatrixXd c = constraints(omega);
    double least = 1e9;
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      for (Eigen::Index j = 0; j < c.cols(); ++j)
        least = std::min(least, std::abs(c(i, j) + penalty.reach(mu(i, j))));
    }
    return least;
  }
  /// How many pairs act though they are clearly apart, and would be missed by looking for contact.
  int acting_apart(const Eigen::VectorXd& omega, const Penalty& penalty) const {
    const Eigen::MatrixXd c = constraints(omega);
    int count = 0;
    for (Eigen::Index i = 0; i < c.rows(); ++i) {
      for (Eigen::Index j = 0; j < c.cols(); ++j)
        count += c(i, j) < -5e-4 && penalty.term(c(i, j), mu(i, j)).slope > 0.0;
    }
    return count;
  }
  const Workbench& bench;
  std::vector<bool> moves;
  Eigen::MatrixXd mu;
};

TEST(Gradient,
     of_the_augmented_lagrangian_is_its_central_difference_and_its_value_that_of_plain_loops) {
  int with_multipliers = 0, acting_apart = 0, skipped = 0, checked = 0;
  for_cases(60, [&](const Case& c) {
    Random random(static_cast<std::uint64_t>(c.seed));
    const auto bench = bench_of(c, random);
    const Eigen::VectorXd omega = omega_of(c, *bench, random);
    PlainLagrangian plain(*bench);
    bench->lagrangian.reset_multipliers();
    Penalty penalty{c.form, random.uniform(0.5, 20.0)};
    for (int outer = 0; outer < 4; ++outer) {  // with no multipliers, with some, with updated ones
      const double value = plain.value(omega, penalty);
      Eigen::VectorXd gradient(omega.size());
      ASSERT_NEAR(bench->lagrangian.lagrangian(omega, penalty, gradient), value,
                  1e-10 * (1.0 + value));
      ASSERT_NEAR(bench->lagrangian.last_max_constraint(),
                  std::max(0.0, plain.constraints(omega).maxCoeff()), 1e-12);
      constexpr double h = 1e-6;
      if (c.form == PenaltyForm::Printed && plain.distance_to_kink(omega, penalty) < 20.0 * h) {
        ++skipped;
      } else {
        const auto by_omega = [&](const Eigen::VectorXd& at) {
          Eigen::VectorXd unused(at.size());
          return bench->lagrangian.lagrangian(at, penalty, unused);
        };
        const Eigen::VectorXd difference = central_gradient(by_omega, omega, h);
        // Beside contact the smooth form's second derivative jumps by rho, which the difference
        // sees as rho h.
        ASSERT_LT((gradient - difference).lpNorm<Eigen::Infinity>(),
                  1e-7 + 2.0 * penalty.rho * h + 1e-9 * value / h * 1e-6)
            << "outer iteration " << outer;
        ++checked;
      }
      // Multipliers from a little or a good way off: then some pairs act though they are apart.
      const double away = outer % 2 == 0 ? 0.2 : 0.05;
      const Eigen::VectorXd elsewhere = omega + random.vector(omega.size(), -away, away);
      bench->lagrangian.update_multipliers(elsewhere, penalty);
      plain.update(elsewhere, penalty);
      with_multipliers += plain.mu.maxCoeff() > 0.0;
      penalty.rho *= random.uniform(0.5, 3.0);
      acting_apart += plain.acting_apart(omega, penalty);
    }
  });
  EXPECT_GT(with_multipliers, 100);
  EXPECT_GT(acting_apart, 20);
  EXPECT_LT(skipped, checked / 5);
}

TEST(Gradient, max_constraint_is_the_largest_of_all_pairs_whatever_the_multipliers) {
  for_cases(20, [&](const Case& c) {
    Random random(static_cast<std::uint64_t>(c.seed));
    const auto bench = bench_of(c, random);
    PlainLagrangian plain(*bench);
    for (int k = 0; k < 5; ++k) {
      const Eigen::VectorXd omega = random.vector(bench->map.size(), -3.0, 3.0);
      EXPECT_NEAR(bench->lagrangian.max_constraint(omega),
                  std::max(0.0, plain.constraints(omega).maxCoeff()), 1e-12);
      bench->lagrangian.update_multipliers(omega, {c.form, 10.0});
    }
  });
}

TEST(Gradient, forgets_multipliers_when_told_to) {
  for_cases(10, [&](const Case& c) {
    Random random(static_cast<std::uint64_t>(c.seed));
    const auto bench = bench_of(c, random);
    const Eigen::VectorXd omega = random.vector(bench->map.size(), -1.0, 1.0);
    Eigen::VectorXd before(omega.size()), after(omega.size());
    const Penalty penalty{c.form, 3.0};
    const double value = bench->lagrangian.lagrangian(omega, penalty, before);
    for (int k = 0; k < 3; ++k)
      bench->lagrangian.update_multipliers(random.vector(omega.size(), -1.0, 1.0), penalty);
    bench->lagrangian.reset_multipliers();
    EXPECT_EQ(bench->lagrangian.lagrangian(omega, penalty, after), value);
    EXPECT_EQ(before, after);
  });
}

}  // namespace
}  // namespace pdoik::detail
