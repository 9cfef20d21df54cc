#include <gtest/gtest.h>

#include <cmath>

#include "arms.hpp"
#include "pdoik/path.hpp"
#include "room.hpp"

/// Whole paths: what is called one is judged between its rows, and what is not says where it ends.
namespace pdoik {
namespace {

using namespace pdoik::testing;

using Stations = std::vector<std::vector<Goal>>;

/// A circle of the tool's own plane, beside a configuration.
Stations circle(const Solver& solver, const Eigen::VectorXd& q, double radius, int count,
                double rounds = 1.0) {
  const Robot& robot = solver.robot();
  Stations stations;
  for (int k = 0; k < count; ++k) {
    const double angle = rounds * 2.0 * M_PI * k / count;
    Eigen::Isometry3d T = robot.fk(q, robot.tips()[0]);
    T.translate(Eigen::Vector3d(radius * std::cos(angle) - radius, radius * std::sin(angle), 0.0));
    stations.push_back({solver.goal(T)});
  }
  return stations;
}

/// Everything that a whole path promises, by forward kinematics at many places of it.
void expect_kept(Solver& solver, const Stations& stations, const PathResult& path, bool closed,
                 const PathOptions& options = {}) {
  ASSERT_EQ(path.pieces.size(), 1U);
  ASSERT_EQ(path.at[0], 0.0);
  const auto count = static_cast<int>(stations.size()) + (closed ? 1 : 0);
  ASSERT_EQ(path.at[path.at.size() - 1], count - 1);
  const Robot& robot = solver.robot();
  int met = 0;
  for (Eigen::Index row = 0; row < path.q.rows(); ++row) {
    const double at = path.at[row];
    if (at == std::floor(at)) {
      Result verdict;
      solver.judge(stations[static_cast<std::size_t>(at) % stations.size()], path.q.row(row),
                   verdict);
      ASSERT_TRUE(verdict.holds) << solver.describe(verdict.worst);
      ++met;
    }
    if (row == 0) continue;
    ASSERT_GE(at, path.at[row - 1]);
    const Eigen::VectorXd from = path.q.row(row - 1), to = path.q.row(row);
    EXPECT_LE((to - from).cwiseAbs().maxCoeff(), options.max_joint_step + 1e-12);
    for (double share = 0.0; share < 1.0; share += 0.1) {
      const Eigen::VectorXd q = from + share * (to - from);
      EXPECT_GT(room(solver, q), -1e-4);
      const double place = path.at[row - 1] + share * (at - path.at[row - 1]);
      const auto k = static_cast<std::size_t>(place);
      const Goal &one = stations[k % stations.size()].front(),
                 &other = stations[(k + 1) % stations.size()].front();
      const double part = place - std::floor(place);
      const Eigen::Isometry3d T = robot.fk(q, robot.tips()[0]);
      const Eigen::Vector3d on_path =
          one.T_base_tip.translation() +
          part * (other.T_base_tip.translation() - one.T_base_tip.translation());
      EXPECT_LT((T.translation() - on_path).norm(), options.position_tolerance);
      const Eigen::Vector3d axis = one.axis.normalized();
      const Eigen::Vector3d wanted = ((1.0 - part) * (one.T_base_tip.linear() * axis) +
                                      part * (other.T_base_tip.linear() * axis))
                                         .normalized();
      const Eigen::Vector3d is = T.linear() * axis;
      EXPECT_LT(std::atan2(is.cross(wanted).norm(), is.dot(wanted)),
                1.05 * options.rotation_tolerance);
    }
  }
  EXPECT_EQ(met, count);
}

TEST(Paths, are_kept_between_their_rows_open_and_closed) {
  int whole = 0;
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    Solver solver(robot);
    Random random(3);
    for (int trial = 0; trial < 6; ++trial) {
      SCOPED_TRACE(name + " " + std::to_string(trial));
      const Eigen::VectorXd q =
          trial == 0 ? bent_arm(robot) : random_configuration(robot, random, 0.2);
      const Stations stations = circle(solver, q, 0.06, 40);
      const bool closed = trial % 2 == 0;
      const PathResult path = solver.solve_path({.stations = stations, .closed = closed});
      if (path.status != PathStatus::Whole) continue;
      ++whole;
      expect_kept(solver, stations, path, closed);
      if (closed) {
        EXPECT_EQ((path.q.row(0) - path.q.row(path.q.rows() - 1)).cwiseAbs().maxCoeff(), 0.0);
      }
    }
  }
  EXPECT_GE(whole, 7);
}

TEST(Paths, with_a_free_axis_are_clear_of_shapes_all_along) {
  int whole = 0;
  for (const std::string& name : arm_names()) {
    const Robot robot = Robot::builtin(name);
    Solver solver(robot);
    Random random(11);
    for (int trial = 0; trial < 5; ++trial) {
      SCOPED_TRACE(name + " " + std::to_string(trial));
      const Eigen::VectorXd q = bent_arm(robot);
      std::vector<Shape> boxes;
      while (boxes.size() < 4) {
        Eigen::Isometry3d T = random.pose(0.7);
        const Shape box =
            Shape::box("box" + std::to_string(boxes.size()), T, Eigen::Vector3d(0.15, 0.2, 0.1));
        solver.set_shapes(Shapes({box}));
        if (room(solver, q) > 0.0) boxes.push_back(box);
      }
      solver.set_shapes(Shapes(boxes));
      Stations stations = circle(solver, q, 0.05, 30);
      for (auto& goals : stations) goals.front().type = GoalType::Axis;
      const PathResult path = solver.solve_path({.stations = stations});
      if (path.status != PathStatus::Whole) continue;
      ++whole;
      expect_kept(solver, stations, path, false);
    }
  }
  EXPECT_GE(whole, 10);
}

TEST(Paths, a_start_and_an_end_are_kept) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Eigen::VectorXd q = bent_arm(robot);
  const Stations stations = circle(solver, q, 0.05, 30);
  const PathResult from = solver.solve_path({.stations = stations, .start = &q});
  ASSERT_EQ(from.status, PathStatus::Whole);
  EXPECT_EQ((from.q.row(0).transpose() - q).cwiseAbs().maxCoeff(), 0.0);
  const Eigen::VectorXd last = from.q.row(from.q.rows() - 1);
  const PathResult both = solver.solve_path({.stations = stations, .start = &q, .end = &last});
  ASSERT_EQ(both.status, PathStatus::Whole);
  EXPECT_EQ((both.q.row(both.q.rows() - 1).transpose() - last).cwiseAbs().maxCoeff(), 0.0);
  expect_kept(solver, stations, both, false);
}

TEST(Paths, a_lock_is_kept) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Eigen::VectorXd q = bent_arm(robot);
  const Stations stations = circle(solver, q, 0.04, 20);
  const std::vector<Lock> locks{{2, q[2]}};
  const PathResult path = solver.solve_path({.stations = stations, .locks = locks});
  ASSERT_EQ(path.status, PathStatus::Whole);
  EXPECT_EQ((path.q.col(2).array() - q[2]).abs().maxCoeff(), 0.0);
}

TEST(Paths, a_joint_with_whole_turns_begins_where_it_can_wind) {
  // The tool turns by three half turns about the last joint's axis, which has two turns in all.
  const Robot robot = Robot::builtin("ur10");
  Solver solver(robot);
  const Eigen::VectorXd q = bent_arm(robot);
  for (const double way : {3.0 * M_PI, -3.0 * M_PI}) {
    Stations stations;
    for (int k = 0; k <= 60; ++k) {
      Eigen::Isometry3d T = robot.fk(q, robot.tips()[0]);
      T.rotate(Eigen::AngleAxisd(way * k / 60.0, Eigen::Vector3d::UnitZ()));
      stations.push_back({solver.goal(T)});
    }
    const PathResult path = solver.solve_path({.stations = stations});
    ASSERT_EQ(path.status, PathStatus::Whole) << solver.explain({.stations = stations}, path);
    EXPECT_NEAR(std::abs(path.q(path.q.rows() - 1, 5) - path.q(0, 5)), 3.0 * M_PI, 1e-3);
  }
}

TEST(Paths, what_cannot_be_is_called_so_and_where) {
  const Robot robot = Robot::builtin("ur10");
  Solver solver(robot);
  const Eigen::VectorXd q = bent_arm(robot);
  Stations stations;
  for (int k = 0; k < 50; ++k) {  // out of reach from some station on
    Eigen::Isometry3d T = robot.fk(q, robot.tips()[0]);
    T.translation() *= 1.0 + 0.04 * k;
    stations.push_back({solver.goal(T)});
  }
  const PathResult path = solver.solve_path({.stations = stations});
  EXPECT_EQ(path.status, PathStatus::Impossible);
  ASSERT_FALSE(path.unsolved.empty());
  const int first = path.unsolved.front();
  Result before, there;
  solver.solve({.goals = stations[static_cast<std::size_t>(first) - 1]}, before);
  solver.solve({.goals = stations[static_cast<std::size_t>(first)]}, there);
  EXPECT_TRUE(before.success);
  EXPECT_FALSE(there.success);
  EXPECT_NE(solver.explain({.stations = stations}, path).find("station " + std::to_string(first)),
            std::string::npos);
}

TEST(Paths, a_post_across_a_seam_is_named_and_pieces_meet_what_can_be_met) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  Eigen::VectorXd q = robot.mid_configuration();
  q << 0.0, 0.2, 0.0, -2.0, 0.0, 2.2, 0.785;
  const Eigen::Isometry3d T = robot.fk(q, robot.tips()[0]);
  Stations stations;
  for (int k = 0; k <= 60; ++k) {
    Eigen::Isometry3d at = T;
    at.translation().y() += 0.01 * (k - 30);
    stations.push_back({solver.goal(at)});
  }
  Eigen::Isometry3d post = Eigen::Isometry3d::Identity();
  post.translation() = T.translation();
  solver.set_shapes(Shapes({Shape::cylinder("post", post, 0.03, 2.0)}));
  const PathResult path = solver.solve_path({.stations = stations});
  EXPECT_TRUE(path.status == PathStatus::NotFound || path.status == PathStatus::Impossible);
  ASSERT_FALSE(path.unsolved.empty());
  EXPECT_NE(solver.explain({.stations = stations}, path).find("post"), std::string::npos);
  ASSERT_EQ(path.pieces.size(), 2U);
  EXPECT_EQ(path.pieces[0].from, 0.0);
  EXPECT_EQ(path.pieces[0].to + 1, path.unsolved.front());
  EXPECT_EQ(path.pieces[1].from - 1, path.unsolved.back());
  EXPECT_EQ(path.pieces[1].to, 60.0);
  // The move from one side to the other goes around it.
  ASSERT_GT(path.pieces[0].last_move, path.pieces[0].first_move);
  for (int k = path.pieces[0].first_move + 1; k <= path.pieces[0].last_move; ++k) {
    const Eigen::VectorXd from = path.moves.row(k - 1), to = path.moves.row(k);
    for (double share = 0.0; share <= 1.0; share += 0.002)
      ASSERT_GT(room(solver, from + share * (to - from)), -1e-4);
  }
}

TEST(Paths, misuse_is_named_with_its_station) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Eigen::VectorXd q = bent_arm(robot);
  const Stations good = circle(solver, q, 0.05, 10);
  const auto expect_refused = [&](const PathRequest& request, const std::string& says,
                                  const PathOptions& options = {}) {
    try {
      solver.solve_path(request, options);
      FAIL() << "expected it to be refused: " << says;
    } catch (const std::invalid_argument& refused) {
      EXPECT_NE(std::string(refused.what()).find(says), std::string::npos) << refused.what();
    }
  };
  const Stations one(good.begin(), good.begin() + 1);
  expect_refused({.stations = one}, "has 1 stations, expected at least 2");
  Stations twice = good;
  twice[4] = twice[3];
  expect_refused({.stations = twice}, "station 4 is the same as station 3");
  Stations mixed = good;
  mixed[5].front().type = GoalType::Position;
  expect_refused({.stations = mixed}, "station 5 asks another kind of thing");
  Stations broken = good;
  broken[2].front().T_base_tip.translation().x() = std::nan("");
  expect_refused({.stations = broken}, "station 2: ");
  Stations soft = good;
  for (auto& goals : soft) goals.front().soft = true;
  expect_refused({.stations = soft}, "soft");
  Eigen::VectorXd elsewhere = q;
  elsewhere[0] += 0.3;
  expect_refused({.stations = good, .start = &elsewhere}, "start does not meet station 0");
  elsewhere[0] = 9.0;
  expect_refused({.stations = good, .start = &elsewhere}, "beyond its limit");
  expect_refused({.stations = good, .end = &q, .closed = true}, "needs no end");
  expect_refused({.stations = good}, "max_time", {.max_time = 0.0});
  expect_refused({.stations = good}, "the cost of limits", {.costs = {.limits = -1.0}});
}

TEST(Paths, costs_keep_a_path_off_what_they_are_of) {
  const Robot robot = Robot::builtin("panda");
  Solver solver(robot);
  const Stations stations = circle(solver, bent_arm(robot), 0.1, 40);
  // What the cost of limits is of: the joint that is nearest to one, of its range.
  const auto cost = [&](const PathResult& path) {
    double sum = 0.0;
    for (Eigen::Index row = 0; row < path.q.rows(); ++row) {
      const Eigen::VectorXd q = path.q.row(row), half = 0.5 * (robot.upper() - robot.lower());
      const Eigen::VectorXd off = (q - robot.mid_configuration()).cwiseAbs().cwiseQuotient(half);
      sum += std::pow(off.maxCoeff(), 4);
    }
    return sum;
  };
  const PathResult plain = solver.solve_path({.stations = stations});
  const PathResult kept = solver.solve_path({.stations = stations}, {.costs = {.limits = 10.0}});
  ASSERT_EQ(plain.status, PathStatus::Whole);
  ASSERT_EQ(kept.status, PathStatus::Whole);
  EXPECT_LT(cost(kept), 0.95 * cost(plain));
  EXPECT_GE(kept.length, plain.length * (1.0 - 1e-2));
}

TEST(Paths, two_hands_keep_their_grip_along_one) {
  const Robot robot = Robot::builtin("h1");
  Solver solver(robot);
  const Eigen::VectorXd q = robot.mid_configuration();
  const int one = robot.tips()[0], other = robot.tips()[1];
  const Eigen::Isometry3d grip = robot.fk(q, one).inverse() * robot.fk(q, other);
  Stations stations;
  for (int k = 0; k <= 10; ++k) {
    Goal hand, second;
    hand.type = GoalType::Position;
    hand.T_base_tip = robot.fk(q, one);
    hand.T_base_tip.translation().z() += 0.005 * k;
    second.tip = 1;
    second.type = GoalType::Position;
    second.relative_to = 0;
    second.T_base_tip = grip;
    stations.push_back({hand, second});
  }
  const PathResult path = solver.solve_path({.stations = stations});
  ASSERT_EQ(path.status, PathStatus::Whole) << solver.explain({.stations = stations}, path);
  for (Eigen::Index row = 0; row < path.q.rows(); ++row) {
    const Eigen::VectorXd at = path.q.row(row);
    const Eigen::Isometry3d T = robot.fk(at, one).inverse() * robot.fk(at, other);
    EXPECT_LT((T.translation() - grip.translation()).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace pdoik
