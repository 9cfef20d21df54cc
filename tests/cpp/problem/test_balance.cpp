#include <gtest/gtest.h>

#include "problem/balance.hpp"
#include "tree_bench.hpp"

namespace pdoik::detail {
namespace {

using namespace pdoik::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Balance::Term> all_terms(const Balance& balance) {
  std::vector<Balance::Term> terms;
  balance.for_each([](int) { return kInfinity; },
                   [&](const Balance::Term& term) { terms.push_back(term); });
  return terms;
}

void place(Balance& balance, const Robot& robot, const Eigen::VectorXd& q) {
  std::vector<Eigen::Isometry3d> T(robot.bodies().size());
  robot.body_poses(q, T);
  balance.place([&](int body) { return to_frame(T[static_cast<std::size_t>(body)]); });
}

TEST(Balance, the_centre_of_mass_is_that_of_all_links_the_base_included) {
  for (int seed = 1; seed <= 30; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_tree(random, 1);
    const Eigen::VectorXd q = random_configuration(robot, random);
    Balance balance(robot, random_balance(robot, q, random, false));
    place(balance, robot, q);
    EXPECT_LT((to_vector3(balance.com()) - robot.center_of_mass(q)).norm(), 1e-12);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double mass = 0.0;
    for (const LinkDescription& link : robot.links()) {
      sum += link.mass * (robot.fk(q, link.name) * link.center_of_mass);
      mass += link.mass;
    }
    EXPECT_LT((to_vector3(balance.com()) - sum / mass).norm(), 1e-12);
  }
}

/// Whether p is inside the convex hull of `corners` by more than `margin`: by asking every line
/// through two corners that has all corners on one side.
bool inside(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p, double margin) {
  bool result = true;
  for (const Eigen::Vector2d& a : corners) {
    for (const Eigen::Vector2d& b : corners) {
      if ((b - a).norm() < 1e-9) continue;
      const Eigen::Vector2d outward = Eigen::Vector2d((b - a).y(), -(b - a).x()).normalized();
      const bool edge = std::all_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& c) {
        return outward.dot(c - a) <= 1e-9;
      });
      if (edge && outward.dot(p - a) > -margin) result = false;
    }
  }
  return result;
}

TEST(Balance, edges_hold_exactly_where_the_centre_of_mass_is_over_the_shrunken_hull_of_contacts) {
  int in = 0, out = 0;
  for (int seed = 1; seed <= 300; ++seed) {
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_tree(random, 1);
    const Eigen::VectorXd q = random_configuration(robot, random);
    BalanceOptions options = random_balance(robot, q, random, seed % 2 == 0);
    options.com_lower.setConstant(-kInfinity);
    options.com_upper.setConstant(kInfinity);
    // Around the centre of mass, so that it is inside now and then.
    const Eigen::Isometry3d T = robot.fk(q, options.contacts[0].link);
    for (Eigen::Vector3d& p : options.contacts[0].points)
      p = T.inverse() * (robot.center_of_mass(q) + random.point(0.3));
    Balance balance(robot, options);
    place(balance, robot, q);

    const Eigen::Vector3d up = options.up.normalized();
    const Eigen::Vector3d side = up.unitOrthogonal(), ahead = up.cross(side);
    const auto flat = [&](const Eigen::Vector3d& p) {
      return Eigen::Vector2d(side.dot(p), ahead.dot(p));
    };
    std::vector<Eigen::Vector2d> corners;
    for (const Contact& contact : options.contacts) {
      for (const Eigen::Vector3d& p : contact.points)
        corners.push_back(flat(robot.fk(q, contact.link) * p));
    }
    double worst = -kInfinity;
    for (const auto& term : all_terms(balance))
      if (term.slot >= Balance::kBox) worst = std::max(worst, term.c);
    const bool expected = inside(corners, flat(robot.center_of_mass(q)), options.support_margin);
    EXPECT_EQ(worst < 0.0, expected) << "seed " << seed;
    (expected ? in : out) += 1;
  }
  EXPECT_GT(in, 30);
  EXPECT_GT(out, 30);
}

TEST(Balance, contacts_on_one_line_or_in_one_point_are_constraints_too) {
  Random random(1);
  const Robot robot = random_tree(random, 1);
  const Eigen::VectorXd q = random_configuration(robot, random);
  const Eigen::Vector3d com = robot.center_of_mass(q);
  const std::string base = robot.base_link();
  for (const Eigen::Vector3d& step :
       {Eigen::Vector3d(0.1, 0.0, 0.0), Eigen::Vector3d(0.0, 0.0, 0.0)}) {
    BalanceOptions options;
    const Eigen::Vector3d from = com + Eigen::Vector3d(-0.05, 0.3, 0.0);
    options.contacts = {{base, {from, from + step, from + 2.0 * step}}};
    Balance balance(robot, options);
    place(balance, robot, q);
    double worst = -kInfinity;
    for (const auto& term : all_terms(balance)) {
      EXPECT_TRUE(std::isfinite(term.c) || term.slot < Balance::kBox);
      if (term.slot >= Balance::kBox) worst = std::max(worst, term.c);
    }
    EXPECT_GT(worst, 0.29);
  }
}

}  // namespace
}  // namespace pdoik::detail
