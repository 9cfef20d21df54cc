#include <gtest/gtest.h>

#include "arms.hpp"

namespace pdoik {
namespace {

using namespace pdoik::testing;

/// Method::Paper on scenes that never change, so that a change of what it computes does not pass
/// unnoticed. Where it stops depends on rounding a little: q within 1e-6 and iterations within a
/// fifth are the same run.
struct Golden {
  const char* arm;
  GoalType goal;
  std::uint64_t seed;
  bool success;
  int iterations;
  std::vector<double> q;
};

const Golden kGolden[] = {
    {"panda",
     GoalType::Pose,
     1,
     true,
     38,
     {-1.779085007, -1.278079421, -0.449789818, -2.779717762, -1.738618697, 3.101276682,
      0.581993180}},
    {"panda",
     GoalType::Axis,
     5,
     true,
     21,
     {-1.106663003, 1.152675671, -0.891089909, -1.121839900, -0.207720152, 1.287210917,
      0.214600216}},
    {"panda",
     GoalType::Position,
     3,
     true,
     11,
     {0.311275732, -1.181682886, 0.538298260, -2.166481951, 0.223598025, 1.728950740, 0.214600216}},
    {"ur10",
     GoalType::Pose,
     2,
     true,
     36,
     {0.327240893, -1.122025755, 2.809748393, -1.651891001, -1.243225502, 1.668140315}},
    {"ur10",
     GoalType::Axis,
     3,
     true,
     24,
     {0.708936203, 2.612965685, 1.088645086, -1.853361866, -5.561827776, 0.0}},
    {"ur10",
     GoalType::Position,
     5,
     true,
     11,
     {0.955234420, 2.586378424, 3.369226165, 1.030571309, -1.469049190, 0.0}},
    {"iiwa14",
     GoalType::Pose,
     2,
     true,
     30,
     {0.644544684, 1.559079181, -1.478127144, 1.710301408, -1.433483064, 1.825070809,
      -0.216684038}},
    {"iiwa14",
     GoalType::Axis,
     2,
     false,
     56,
     {1.363930048, 0.297987536, -2.967059728, 2.094395102, 0.472381918, 2.094395102, 0.083461158}},
    {"iiwa14",
     GoalType::Position,
     5,
     true,
     15,
     {0.487979573, -1.194884612, 0.476279967, 1.194273016, 0.114827801, 0.517188068, 0.083461158}},
};

TEST(Golden, the_papers_method_ends_where_it_did) {
  for (const Golden& golden : kGolden) {
    SCOPED_TRACE(std::string(golden.arm) + ", " + name_of(golden.goal) + ", seed " +
                 std::to_string(golden.seed));
    const Robot robot = with_hulls(Robot::builtin(golden.arm));
    Options options = timeless(golden.goal, Method::Paper);
    options.position_tolerance = options.rotation_tolerance = 1e-7;  // so that the end is sharp
    Random random(golden.seed);
    const Problem problem = solvable_problem(robot, random, 20);
    Solver solver(robot, options);
    solver.set_obstacles(problem.obstacles);
    const Result result = solver.solve(problem.target);
    EXPECT_EQ(result.success, golden.success);
    EXPECT_NEAR(result.iterations, golden.iterations, 0.2 * golden.iterations + 1);
    ASSERT_EQ(result.q.size(), static_cast<Eigen::Index>(golden.q.size()));
    for (std::size_t i = 0; i < golden.q.size(); ++i) {
      EXPECT_NEAR(result.q[static_cast<Eigen::Index>(i)], golden.q[i], 1e-6) << "joint " << i;
    }
  }
}

}  // namespace
}  // namespace pdoik
