#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "arms.hpp"
#include "finite_differences.hpp"
#include "pdoik/tracker.hpp"
#include "tree_bench.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The rotation vector of R.
Eigen::Vector3d log_of(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

/// Goals of every kind that a random configuration meets.
std::vector<Goal> goals_of_all_kinds(const Robot& robot, const Eigen::VectorXd& q, Random& random) {
  std::vector<Goal> goals;
  for (int tip = 0; tip < static_cast<int>(robot.tips().size()); ++tip) {
    const Eigen::Isometry3d T = robot.fk(q, robot.tips()[static_cast<std::size_t>(tip)]);
    Goal goal;
    goal.tip = tip;
    goal.axis = random.direction();
    goal.T_tip_tool = random.pose(0.3);
    goal.type = static_cast<GoalType>(random.integer(0, 3));
    goal.weight = random.uniform(0.3, 3.0);
    goal.T_base_tip = T * goal.T_tip_tool;
    if (goal.type == GoalType::LookAt) {
      goal.T_base_tip.translation() +=
          random.uniform(0.2, 1.0) * (goal.T_base_tip.linear() * goal.axis);
    } else if (random.integer(0, 1) == 1) {
      goal.between(-random.point(0.2).cwiseAbs(), random.point(0.2).cwiseAbs());
      if (goal.type == GoalType::Pose)
        goal.turned_between(Eigen::Vector3d(-0.2, 0.0, -1.0), Eigen::Vector3d(0.1, 0.0, 2.0));
    }
    if (tip > 0 && random.integer(0, 1) == 1) {
      goal.relative_to = tip - 1;
      goal.T_base_tip =
          robot.fk(q, robot.tips()[static_cast<std::size_t>(tip - 1)]).inverse() * goal.T_base_tip;
    }
    goals.push_back(goal);
  }
  return goals;
}

/// Whether a configuration meets a goal, by forward kinematics alone.
void expect_met(const Robot& robot, Goal goal, const Eigen::VectorXd& q, double tolerance) {
  const Eigen::Isometry3d T =
      robot.fk(q, robot.tips()[static_cast<std::size_t>(goal.tip)]) * goal.T_tip_tool;
  if (goal.relative_to >= 0)
    goal.T_base_tip =
        robot.fk(q, robot.tips()[static_cast<std::size_t>(goal.relative_to)]) * goal.T_base_tip;
  const Eigen::Vector3d off =
      goal.T_base_tip.linear().transpose() * (T.translation() - goal.T_base_tip.translation());
  const Eigen::Vector3d axis = goal.axis.normalized();
  if (goal.type == GoalType::LookAt) {
    EXPECT_LT(angle_between(T.linear() * axis, goal.T_base_tip.translation() - T.translation()),
              goal.rotation_slack.maxCoeff() + tolerance);
    return;
  }
  EXPECT_TRUE((off.cwiseAbs().array() <= goal.position_slack.array() + tolerance).all())
      << off.transpose();
  if (goal.type == GoalType::Axis) {
    EXPECT_LT(angle_between(T.linear() * axis, goal.T_base_tip.linear() * axis),
              goal.rotation_slack.maxCoeff() + tolerance);
  }
  if (goal.type == GoalType::Pose) {
    EXPECT_TRUE((log_of(goal.T_base_tip.linear().transpose() * T.linear()).cwiseAbs().array() <=
                 goal.rotation_slack.array() + tolerance)
                    .all());
  }
}

TEST(Goals, the_gradient_of_every_kind_is_the_central_difference) {
  int checked = 0;
  std::array<int, 4> kinds{};
  for (int seed = 1; seed <= 80; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_tree(random, 1 + seed % 3);
    Options options;
    options.rotation_weight = random.uniform(0.1, 1.0);
    Workbench bench(robot, options);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.05),
                          there = random_configuration(robot, random, 0.05);
    std::vector<Goal> goals = goals_of_all_kinds(robot, there, random);
    goals.push_back(goals.front());  // two of one tip
    goals.back().T_base_tip = random.pose(0.5);
    for (Goal& goal : goals) {
      ++kinds[static_cast<std::size_t>(goal.type)];
      goal.soft = random.integer(0, 3) == 0;
      if (goal.type < GoalType::Position && random.integer(0, 2) == 0)
        goal.priority = Priority::Position;
    }
    bench.problem.set_goals(goals);
    bench.least_squares.wishes_count = seed % 2 == 0 ? 0.7 : 0.0;
    const auto f = [&](const Eigen::VectorXd& x) { return bench.least_squares.evaluate(x); };
    const auto expected = smooth_gradient(f, q);
    if (!expected) continue;
    Eigen::MatrixXd H(q.size(), q.size());
    Eigen::VectorXd g(q.size());
    bench.least_squares.evaluate(q);
    bench.least_squares.linearise(H, g);
    EXPECT_LT((g - *expected).norm(), 3e-6 * (1.0 + expected->norm()));
    ++checked;
  }
  EXPECT_GT(checked, 60);
  EXPECT_GT(*std::ranges::min_element(kinds), 10);
}

TEST(Goals, answers_meet_goals_of_every_kind_by_forward_kinematics) {
  int solved = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot =
        random_tree(random, 2 + seed % 2, {.joints = 16, .branches = true, .prismatic = 0.1});
    const std::vector<Goal> goals =
        goals_of_all_kinds(robot, random_configuration(robot, random, 0.05), random);
    Solver solver(robot, {.max_time = 0.5});
    Result result;
    solver.solve({.goals = goals}, result);
    if (!result.success) continue;
    ++solved;
    for (const Goal& goal : goals) expect_met(robot, goal, result.q, 1.5e-5);
  }
  EXPECT_GE(solved, 57);
}

TEST(Goals, a_region_is_the_box_that_it_says) {
  Goal goal;
  goal.T_base_tip =
      Eigen::Translation3d(1.0, 2.0, 3.0) * Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ());
  const double inf = std::numeric_limits<double>::infinity();
  goal.between({-0.1, 0.0, -inf}, {0.3, inf, inf});
  const auto is_inside = [&](const Eigen::Vector3d& local) {
    const Eigen::Vector3d at = Eigen::Vector3d(1.0, 2.0, 3.0) +
                               Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()) * local;
    const Eigen::Vector3d off = goal.T_base_tip.inverse() * at;
    return (off.cwiseAbs().array() <= goal.position_slack.array() + 1e-9).all();
  };
  EXPECT_TRUE(is_inside({-0.1, 0.0, 70.0}));
  EXPECT_TRUE(is_inside({0.3, 5.0, -70.0}));
  EXPECT_FALSE(is_inside({-0.101, 1.0, 0.0}));
  EXPECT_FALSE(is_inside({0.301, 1.0, 0.0}));
  EXPECT_FALSE(is_inside({0.0, -0.001, 0.0}));
  EXPECT_THROW(goal.between({0.1, 0, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(goal.turned_between({0, 0, -inf}, {0, 0, inf}), std::invalid_argument);
}

TEST(Goals, the_centre_of_mass_is_where_it_is_asked_for) {
  const Robot robot = Robot::builtin("h1");
  Random random(3);
  Solver solver(robot, {.max_time = 1.0});
  int solved = 0;
  for (int k = 0; k < 10; ++k) {
    const Eigen::VectorXd q = random_configuration(robot, random, 0.1);
    Goal mass;
    mass.type = GoalType::CenterOfMass;
    mass.T_base_tip.translation() = robot.center_of_mass(q);
    mass.position_slack = {0.0, 0.005, 0.02};
    Goal hand;
    hand.tip = 2;
    hand.type = GoalType::Position;
    hand.T_base_tip = robot.fk(q, robot.tips()[2]);
    const std::vector<Goal> goals{mass, hand};
    Result result;
    solver.solve({.goals = goals}, result);
    if (!result.success) continue;
    ++solved;
    const Eigen::Vector3d off = robot.center_of_mass(result.q) - mass.T_base_tip.translation();
    EXPECT_TRUE((off.cwiseAbs().array() <= mass.position_slack.array() + 1.1e-6).all());
    expect_met(robot, hand, result.q, 1.1e-5);
  }
  EXPECT_GE(solved, 9);
}

TEST(Goals, any_of_many_is_the_one_that_can_be_met) {
  const Robot robot = Robot::builtin("panda");
  Random random(5);
  Solver solver(robot, timeless());
  for (int k = 0; k < 20; ++k) {
    std::vector<std::vector<Goal>> grasps(16, {solver.goal(random.pose(0.3))});
    for (auto& grasp : grasps) {
      grasp.front().T_base_tip = random.pose(0.3);
      grasp.front().T_base_tip.translation().z() -= 1.5;  // out of reach
    }
    const int reachable = random.integer(0, 15);
    grasps[static_cast<std::size_t>(reachable)].front().T_base_tip =
        robot.fk(random_configuration(robot, random, 0.05));
    Result result;
    solver.solve({.any_of = grasps}, result);
    ASSERT_TRUE(result.success);
    EXPECT_EQ(result.goal_index, reachable);
    EXPECT_EQ(solver.explain({.any_of = grasps}, result),
              "goal " + std::to_string(reachable + 1) + " of 16: solved");
    expect_met(robot, grasps[static_cast<std::size_t>(reachable)].front(), result.q, 1.5e-5);
  }
}

TEST(Goals, the_cheapest_that_can_be_met_is_taken_and_the_nearest_where_that_is_wanted) {
  const Robot robot = Robot::builtin("panda");
  Random random(6);
  Options options = timeless();
  Solver solver(robot, options);
  options.prefer = Prefer::Nearest;
  options.max_restarts = 20;
  Solver near(robot, options);
  int nearer = 0;
  for (int k = 0; k < 10; ++k) {
    std::vector<std::vector<Goal>> grasps;
    std::vector<double> costs;
    for (int i = 0; i < 8; ++i) {
      grasps.push_back({solver.goal(robot.fk(random_configuration(robot, random, 0.05)))});
      costs.push_back(random.uniform(0.0, 1.0));
    }
    grasps[2].front().T_base_tip.translation().x() += 3.0;  // out of reach, and cheapest
    costs[2] = -1.0;
    const auto cheapest = std::min_element(costs.begin() + 3, costs.end());
    const int wanted = static_cast<int>(std::min({costs[0], costs[1], *cheapest}) == *cheapest
                                            ? cheapest - costs.begin()
                                        : costs[0] < costs[1] ? 0
                                                              : 1);
    const Eigen::VectorXd q0 = random_configuration(robot, random, 0.05);
    Result result;
    solver.solve({.any_of = grasps, .costs = costs, .q0 = &q0}, result);
    ASSERT_TRUE(result.success);
    EXPECT_EQ(result.goal_index, wanted);

    near.solve({.any_of = grasps, .q0 = &q0}, result);
    ASSERT_TRUE(result.success);
    for (const auto& grasp : grasps) {
      Result alone;
      near.solve({.goals = grasp, .q0 = &q0}, alone);
      // No less is a promise of a search with a budget, so it is counted.
      nearer += alone.success && (alone.q - q0).norm() < (result.q - q0).norm() - 1e-3;
    }
  }
  EXPECT_LE(nearer, 4);
}

/// Six revolute joints whose last three axes meet and whose second and third are parallel, or whose
/// second to fourth are parallel and last two meet.
Robot six_joints(Random& random, bool parallels) {
  RobotDescription description;
  description.name = "six";
  const auto turned = [&](double angle) {
    return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitX()).toRotationMatrix();
  };
  description.links.push_back({.name = "base"});
  for (int k = 0; k < 6; ++k) {
    const std::string name = "link" + std::to_string(k);
    description.links.push_back({.name = name});
    JointDescription joint;
    joint.name = "joint" + std::to_string(k);
    joint.parent_link = k == 0 ? "base" : "link" + std::to_string(k - 1);
    joint.child_link = name;
    joint.type = JointType::Revolute;
    joint.axis = Eigen::Vector3d::UnitZ();
    joint.lower = -M_PI;
    joint.upper = M_PI;
    Eigen::Isometry3d& T = joint.T_parent_child;
    T.setIdentity();
    const bool follows_parallel = parallels ? k == 2 || k == 3 : k == 2;
    const bool meets = parallels ? k == 5 : k >= 4;
    if (!meets) T.translation() = random.point(0.4);
    T.linear() =
        follows_parallel
            ? Eigen::AngleAxisd(random.uniform(-3, 3), Eigen::Vector3d::UnitZ()).toRotationMatrix()
            : turned(random.uniform(0.5, 2.5));
    if (follows_parallel && random.integer(0, 1) == 1) T.linear() = T.linear() * turned(M_PI);
    description.joints.push_back(joint);
  }
  return Robot(description);
}

TEST(Goals, closed_form_has_every_solution_of_arms_of_six_joints) {
  int solutions = 0;
  for (int seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = seed % 3 == 0 ? Robot::builtin("ur10") : six_joints(random, seed % 3 == 1);
    Options options = timeless();
    options.self_collision = false;
    Solver solver(robot, options);
    const Eigen::VectorXd q = random_configuration(robot, random, 0.01);
    const Goal goal = solver.goal(robot.fk(q));
    const Solutions all = solver.solve_all({.goals = {&goal, 1}});
    EXPECT_TRUE(all.complete);
    EXPECT_EQ(all.coverage, 1.0);
    const auto has = [&](const Eigen::VectorXd& wanted, double rounding) {
      return std::ranges::any_of(all.results, [&](const Result& found) {
        double off = 0.0;
        for (Eigen::Index i = 0; i < wanted.size(); ++i)
          off = std::max(off, std::abs(std::remainder(found.q[i] - wanted[i], 2.0 * M_PI)));
        return off < rounding;
      });
    };
    EXPECT_TRUE(has(q, 1e-3));
    for (const Result& each : all.results) expect_met(robot, goal, each.q, 1.5e-5);
    solutions += static_cast<int>(all.results.size());
    // And whatever a search comes to is one of them.
    for (int k = 0; k < 30; ++k) {
      const Eigen::VectorXd q0 = random_configuration(robot, random);
      Result result;
      solver.solve({.goals = {&goal, 1}, .q0 = &q0}, result);
      // Tolerances let it be farther off beside a singularity.
      EXPECT_TRUE(!result.success || has(result.q, 0.05));
    }
  }
  EXPECT_GT(solutions, 240);
}

TEST(Goals, solutions_of_a_redundant_arm_are_distinct_and_as_many_as_asked) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(9);
  for (int k = 0; k < 5; ++k) {
    const testing::Problem problem = solvable_problem(robot, random, 30);
    Solver solver(robot, timeless());
    solver.set_obstacles(problem.obstacles);
    const Goal goal = solver.goal(problem.target);
    const Solutions all =
        solver.solve_all({.goals = {&goal, 1}, .q0 = &problem.q}, {.limit = 12, .distinct = 0.2});
    EXPECT_FALSE(all.complete);
    EXPECT_GT(all.results.size(), 3U);
    EXPECT_LE(all.results.size(), 12U);
    for (std::size_t i = 0; i < all.results.size(); ++i) {
      expect_met(robot, goal, all.results[i].q, 1.5e-5);
      EXPECT_TRUE(all.results[i].success);
      EXPECT_LE((all.results[i > 0 ? i - 1 : 0].q - problem.q).norm(),
                (all.results[i].q - problem.q).norm());
      for (std::size_t j = 0; j < i; ++j)
        EXPECT_GT((all.results[i].q - all.results[j].q).cwiseAbs().maxCoeff(), 0.2);
    }
  }
}

TEST(Goals, where_position_comes_first_it_holds_and_no_turn_nearby_is_better) {
  int compromises = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = random_tree(random, 1, {.joints = 5});
    Solver solver(robot, {.max_time = 1.0});
    Goal goal = solver.goal(robot.fk(random_configuration(robot, random, 0.2)));
    goal.T_base_tip.linear() = random.rotation();
    goal.priority = Priority::Position;
    Result result;
    solver.solve({.goals = {&goal, 1}}, result);
    if (result.status != Status::Nearest) continue;
    ++compromises;
    EXPECT_FALSE(result.success);
    EXPECT_TRUE(result.holds);
    EXPECT_LT(position_error(robot, result.q, goal.T_base_tip), 1.1e-5);
    const double turned =
        log_of(goal.T_base_tip.linear().transpose() * robot.fk(result.q).linear()).norm();
    EXPECT_NEAR(result.rotation_error, turned, 1e-9);
    // Anywhere on the way that keeps the position, a little further, it is no less.
    Goal place = goal;
    place.type = GoalType::Position;
    place.priority = Priority::Both;
    for (int k = 0; k < 20; ++k) {
      const Eigen::VectorXd near = (result.q + random.vector(result.q.size(), -0.05, 0.05))
                                       .cwiseMax(robot.lower())
                                       .cwiseMin(robot.upper());
      Result other;
      solver.solve({.goals = {&place, 1}, .q0 = &near}, other);
      if (!other.success) continue;
      const double theirs =
          log_of(goal.T_base_tip.linear().transpose() * robot.fk(other.q).linear()).norm();
      EXPECT_GT(theirs, turned - 1e-3);
    }
  }
  EXPECT_GE(compromises, 12);
}

TEST(Goals, what_is_soft_is_least_among_what_is_hard) {
  const Robot robot = Robot::builtin("panda");
  Random random(4);
  Solver solver(robot, timeless());
  int seen = 0;
  for (int k = 0; k < 10; ++k) {
    const Eigen::VectorXd q = random_configuration(robot, random, 0.1);
    Goal place = solver.goal(robot.fk(q));
    place.type = GoalType::Position;
    Goal look;
    look.type = GoalType::LookAt;
    look.T_base_tip.translation() = random.point(1.0);
    look.soft = true;
    const std::vector<Goal> goals{place, look};
    Result without, with;
    solver.solve({.goals = {&place, 1}, .q0 = &q}, without);
    solver.solve({.goals = goals, .q0 = &q}, with);
    ASSERT_TRUE(without.success && with.success);
    expect_met(robot, place, with.q, 1.1e-5);
    const auto off = [&](const Eigen::VectorXd& at) {
      const Eigen::Isometry3d T = robot.fk(at);
      return angle_between(T.linear().col(2), look.T_base_tip.translation() - T.translation());
    };
    EXPECT_LT(off(with.q), off(without.q));
    seen += off(with.q) < 1e-3;
  }
  EXPECT_GE(seen, 5);
}

TEST(Goals, locked_joints_stay_and_idle_ones_do_not_move) {
  const Robot robot = Robot::builtin("h1");
  Random random(2);
  Options options = timeless();
  options.self_collision = false;  // what is idle may have to make room
  Solver solver(robot, options);
  for (int k = 0; k < 20; ++k) {
    const Eigen::VectorXd q0 = random_configuration(robot, random, 0.1),
                          to = random_configuration(robot, random, 0.1);
    Goal hand;
    hand.tip = 2;
    hand.type = GoalType::Position;
    Eigen::VectorXd there = q0;
    const int link = robot.tips()[2];
    std::vector<bool> moves(static_cast<std::size_t>(robot.dof()), false);
    for (int b = robot.body_of_link(link); b > 0;
         b = robot.bodies()[static_cast<std::size_t>(b)].parent)
      moves[static_cast<std::size_t>(robot.bodies()[static_cast<std::size_t>(b)].dof)] = true;
    int locked = -1;
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      if (!moves[static_cast<std::size_t>(i)]) continue;
      if (locked < 0) locked = static_cast<int>(i);
      there[i] = to[i];
    }
    hand.T_base_tip = robot.fk(there, link);
    const Lock lock{locked, there[locked]};
    Result result;
    solver.solve({.goals = {&hand, 1}, .q0 = &q0, .locks = {&lock, 1}}, result);
    ASSERT_TRUE(result.success);
    EXPECT_EQ(result.q[locked], there[locked]);
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      EXPECT_TRUE(moves[static_cast<std::size_t>(i)] || result.q[i] == q0[i]);
    }
  }
}

TEST(Goals, derivatives_are_what_solving_again_shows) {
  int checked = 0;
  for (int seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = Robot::builtin(seed % 2 == 0 ? "ur10" : "panda");
    Options options = timeless();
    options.position_tolerance = options.rotation_tolerance = 1e-12;
    Solver solver(robot, options);
    const Eigen::VectorXd q = bent_arm(robot) + random.vector(robot.dof(), -0.2, 0.2);
    Goal goal = solver.goal(robot.fk(q));
    goal.type = static_cast<GoalType>(seed % 4);
    goal.T_tip_tool = random.pose(0.2);
    goal.T_base_tip = robot.fk(q) * goal.T_tip_tool;
    if (goal.type == GoalType::LookAt)
      goal.T_base_tip.translation() += 0.5 * goal.T_base_tip.linear().col(2);
    const Derivatives at = solver.derivatives({&goal, 1}, q);
    ASSERT_EQ(at.dq_dT.rows(), robot.dof());
    ASSERT_EQ(at.dq_dT.cols(), 6);
    const double h = 1e-5;
    bool all = true;
    Eigen::MatrixXd expected(robot.dof(), 6);
    for (int k = 0; k < 6 && all; ++k) {
      Eigen::VectorXd ends[2];
      for (const int side : {0, 1}) {
        Goal moved = goal;
        const double by = side == 0 ? -h : h;
        if (k < 3)
          moved.T_base_tip.translation()[k] += by;
        else
          moved.T_base_tip.linear() =
              Eigen::AngleAxisd(by, Eigen::Vector3d::Unit(k - 3)) * moved.T_base_tip.linear();
        Result result;
        solver.solve({.goals = {&moved, 1}, .q0 = &q}, result);
        all = all && result.success;
        ends[side] = result.q;
      }
      expected.col(k) = (ends[1] - ends[0]) / (2.0 * h);
    }
    if (!all || at.singular_distance < 0.02) continue;
    EXPECT_LT((at.dq_dT - expected).cwiseAbs().maxCoeff(), 1e-4 * (1.0 + expected.norm()));
    EXPECT_GT(at.manipulability, 0.0);
    ++checked;
  }
  EXPECT_GE(checked, 18);
}

TEST(Goals, what_cannot_be_by_construction_is_refused) {
  const Robot robot = Robot::builtin("h1");
  Solver solver(robot);
  const auto expect_refused = [&](std::vector<Goal> goals, const std::string& words) {
    Result result;
    try {
      solver.solve({.goals = goals}, result);
      ADD_FAILURE() << words;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  Goal goal;
  Goal other = goal;
  other.T_base_tip.translation().x() = 0.2;
  expect_refused({goal, other}, "contradict each other: their positions are 0.2 m apart");
  other = goal;
  other.T_base_tip.rotate(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()));
  expect_refused({goal, other}, "contradict each other: their orientations are 0.5 rad apart");
  Goal one, two;
  one.tip = 2, one.relative_to = 3, two.tip = 3, two.relative_to = 2;
  two.T_base_tip.translation().y() = 0.1;
  expect_refused({one, two}, "contradict each other");
  Goal mass;
  mass.type = GoalType::CenterOfMass;
  mass.soft = true;
  expect_refused({mass}, "centre of mass is soft");
  Goal place;
  place.type = GoalType::Position;
  place.priority = Priority::Position;
  expect_refused({place}, "has no orientation that could come second");
  expect_refused(std::vector<Goal>(65, goal), "65 goals, expected at most 64");

  Result result;
  const std::vector<std::vector<Goal>> lists{{goal}, {}};
  EXPECT_THROW(solver.solve({.any_of = lists}, result), std::invalid_argument);
  EXPECT_THROW(solver.solve({.goals = {&goal, 1}, .any_of = lists}, result), std::invalid_argument);
  const Lock outside{0, 9.0}, nowhere{19, 0.0};
  EXPECT_THROW(solver.solve({.goals = {&goal, 1}, .locks = {&outside, 1}}, result),
               std::invalid_argument);
  EXPECT_THROW(solver.solve({.goals = {&goal, 1}, .locks = {&nowhere, 1}}, result),
               std::invalid_argument);
  EXPECT_THROW(solver.solve_all({.goals = {&goal, 1}}, {.limit = -1}), std::invalid_argument);
}

TEST(Goals, a_tracker_keeps_a_grip_while_hands_move) {
  const Robot robot = Robot::builtin("h1");
  Options options;
  options.self_collision = false;
  Tracker tracker(robot, options, {.period = 0.01, .max_time = 10.0});
  Eigen::VectorXd q = robot.mid_configuration();
  tracker.reset(q);
  const int left = robot.tips()[2], right = robot.tips()[3];
  Goal grip;
  grip.tip = 3;
  grip.relative_to = 2;
  grip.T_base_tip = robot.fk(q, left).inverse() * robot.fk(q, right);
  grip.type = GoalType::Position;
  grip.stands = true;
  Goal lead;
  lead.tip = 2;
  lead.type = GoalType::Position;
  lead.T_base_tip = robot.fk(q, left);
  const Eigen::Vector3d from = lead.T_base_tip.translation();
  for (int k = 0; k < 60; ++k) {
    lead.T_base_tip.translation() = from + 0.001 * k * Eigen::Vector3d(0.5, 0.0, 1.0);
    const std::vector<Goal> goals{grip, lead};
    const TrackerResult& step = tracker.step(goals);
    ASSERT_NE(step.tracking, TrackerStatus::InvalidInput) << step.complaint;
    const Eigen::Isometry3d held = robot.fk(step.q, left) * grip.T_base_tip;
    EXPECT_LT((robot.fk(step.q, right).translation() - held.translation()).norm(), 1.01e-4);
  }
  EXPECT_LT((robot.fk(tracker.q(), left).translation() - lead.T_base_tip.translation()).norm(),
            5e-3);
}

}  // namespace
}  // namespace pdoik
