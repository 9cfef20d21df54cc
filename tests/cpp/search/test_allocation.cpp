#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "arms.hpp"
#include "binomial.hpp"
#include "hulls/self_collision.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/tracker.hpp"
#include "tree_bench.hpp"

// Every allocation of the whole test program passes through these, since a program's own malloc
// takes precedence over the C library's; operator new and Eigen call malloc. Sanitizers bring their
// own and are left alone.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && defined(__GLIBC__)
#define PDOIK_COUNTS_ALLOCATIONS 1

namespace {
thread_local bool counting = false;
thread_local int counted = 0;
thread_local std::size_t counted_bytes = 0;
void note(std::size_t size = 0) {
  if (!counting) return;
  ++counted;
  counted_bytes += size;
}
}  // namespace

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) { return note(size), __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) {
  return note(count * size), __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) { return note(size), __libc_realloc(old, size); }
void* memalign(std::size_t alignment, std::size_t size) {
  return note(size), __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return note(size), __libc_memalign(alignment, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  note(size);
  *result = __libc_memalign(alignment, size);
  return *result == nullptr ? 12 : 0;  // ENOMEM
}
void free(void* p) {
  if (p != nullptr) note();  // releasing memory takes the allocator's lock as well
  __libc_free(p);
}
}
#endif

namespace pdoik {
namespace {

#ifdef PDOIK_COUNTS_ALLOCATIONS

using namespace pdoik::testing;

/// Allocations and releases while `work` runs.
template <class Work>
int allocations(Work&& work) {
  counted = 0;
  counting = true;
  work();
  counting = false;
  return counted;
}

TEST(Allocation, the_counter_counts_every_way_of_allocating) {
  void* volatile p = nullptr;
  EXPECT_EQ(allocations([&] { p = std::malloc(10); }), 1);
  EXPECT_EQ(allocations([&] { p = std::realloc(p, 100000); }), 1);
  EXPECT_EQ(allocations([&] { std::free(p); }), 1);
  EXPECT_EQ(allocations([&] {
              int* volatile one = new int;
              delete one;
            }),
            2);
  EXPECT_EQ(allocations([] {
              struct alignas(64) Wide {
                char c[64];
              };
              Wide* volatile wide = new Wide;
              delete wide;
            }),
            2);
  EXPECT_EQ(allocations([] {
              Eigen::VectorXd v(100);
              v.setZero();
            }),
            2);
  EXPECT_EQ(allocations([] { std::vector<Eigen::Isometry3d> v(3); }), 2);
  EXPECT_EQ(allocations([] {
              Eigen::Vector3d v(1.0, 2.0, 3.0);
              v.normalize();
            }),
            0);
}

/// Solves with a result that has been used once.
int allocations_of_solves(const Robot& robot, const Options& options, int obstacles,
                          double radius) {
  Random random(21);
  Solver solver(robot, options);
  Result result;
  int sum = 0, solved = 0;
  for (int k = 0; k < 20; ++k) {
    const Problem problem = solvable_problem(robot, random, obstacles, radius);
    const Eigen::VectorXd q0 = random_configuration(robot, random);
    Eigen::Isometry3d target = problem.target;
    if (k % 5 == 4)
      target.translation() += Eigen::Vector3d(9.0, 0.0, 0.0);  // also when there is no solution
    solver.set_obstacles(problem.obstacles);
    if (k == 0) solver.solve(target, &q0, result);
    sum += allocations([&] { solver.solve(target, k % 2 == 0 ? &q0 : nullptr, result); });
    solved += result.success;
  }
  EXPECT_GT(solved, 3);
  return sum;
}

TEST(Allocation, a_solve_after_set_up_allocates_nothing_whatever_the_method_goal_and_obstacles) {
  for (const std::string& arm : arm_names()) {
    const Robot robot = with_hulls(Robot::builtin(arm));
    for (const GoalType goal : {GoalType::Pose, GoalType::Axis, GoalType::Position}) {
      for (const auto& [method, inner] :
           {std::pair(Method::Default, InnerMethod::LevenbergMarquardt),
            std::pair(Method::Default, InnerMethod::Lbfgs),
            std::pair(Method::Paper, InnerMethod::Lbfgs)}) {
        for (const auto& [obstacles, radius] :
             {std::pair(0, 0.0), std::pair(30, 0.0), std::pair(30, 0.05)}) {
          SCOPED_TRACE(arm + ", " + name_of(goal) + ", " +
                       (method == Method::Paper ? "paper, " : "default, ") +
                       std::to_string(obstacles) + " obstacles of radius " +
                       std::to_string(radius));
          Options options = timeless(goal, method, inner);
          options.max_restarts = 5;
          EXPECT_EQ(allocations_of_solves(robot, options, obstacles, radius), 0);
        }
      }
    }
  }
}

TEST(Allocation, a_solve_of_a_robot_with_followers_slides_and_turns_allocates_nothing) {
  Random random(4);
  Robot robot =
      random_robot(random, {.joints = 8, .prismatic = 0.3, .continuous = 0.3, .mimic = 0.3});
  robot.set_occupancy(random_occupancy(robot, random, 2, 2));
  Options options = timeless(GoalType::Position);
  options.max_restarts = 5;
  EXPECT_EQ(allocations_of_solves(robot, options, 10, 0.02), 0);
}

/// What a tree is asked with everything on.
struct FullRequest {
  std::vector<Goal> goals;
  Eigen::VectorXd q0, posture, max_step;
  ObstacleMatrix obstacles;
};

FullRequest full_request(const Robot& robot, Random& random, int obstacles) {
  FullRequest full;
  full.goals = random_goals(robot, random, true);
  full.q0 = random_configuration(robot, random);
  full.posture = random_configuration(robot, random);
  full.max_step = random.vector(robot.dof(), 0.5, 3.0);
  full.obstacles = random_obstacles(random, obstacles, 1.0, 0.02);
  return full;
}

Options full_options(const Robot& robot, Random& random, Prefer prefer) {
  Options options = timeless();
  options.max_restarts = 5;
  options.prefer = prefer;
  options.self_collision = true;
  options.joint_weights = random.vector(robot.dof(), 0.5, 2.0);
  options.balance = random_balance(robot, robot.mid_configuration(), random, true);
  options.balance.com_lower -= Eigen::Vector3d::Constant(0.3);
  options.balance.com_upper += Eigen::Vector3d::Constant(0.3);
  options.balance.support_margin = -1.0;
  return options;
}

Robot roomy_tree(Random& random) {
  Robot robot = random_tree(random, 2, {.joints = 14, .branches = true, .prismatic = 0.1});
  robot.set_occupancy(random_occupancy(robot, random, 2, 2));
  return robot;
}

TEST(Allocation, a_solve_of_a_tree_with_everything_on_allocates_nothing) {
  int solved = 0, settled = 0;
  for (const Prefer prefer : {Prefer::First, Prefer::Nearest}) {
    for (int seed = 1; seed <= 8; ++seed) {
      SCOPED_TRACE("seed " + std::to_string(seed));
      Random random(static_cast<std::uint64_t>(seed));
      const Robot robot = roomy_tree(random);
      Solver solver(robot, full_options(robot, random, prefer));
      Result result;
      for (int k = 0; k < 6; ++k) {
        const FullRequest full = full_request(robot, random, 20);
        solver.set_obstacles(full.obstacles);
        const Request request{.goals = full.goals,
                              .q0 = &full.q0,
                              .posture = k % 2 == 0 ? &full.posture : nullptr,
                              .max_step = k % 3 == 0 ? &full.max_step : nullptr};
        if (k == 0) solver.solve(request, result);
        EXPECT_EQ(allocations([&] { solver.solve(request, result); }), 0) << k;
        solved += result.success;
        settled += result.success && request.posture != nullptr;
      }
    }
  }
  EXPECT_GE(solved, fewest_by_luck(96, 0.56));
  EXPECT_GE(settled, fewest_by_luck(48, 0.58));
}

TEST(Allocation, a_solve_of_a_tree_by_the_paper_s_minimiser_allocates_nothing) {
  Random random(1);
  const Robot robot = roomy_tree(random);
  Options options = full_options(robot, random, Prefer::First);
  options.inner = InnerMethod::Lbfgs;
  Solver solver(robot, options);
  Result result;
  for (int k = 0; k < 4; ++k) {
    FullRequest full = full_request(robot, random, 20);
    for (Goal& goal : full.goals) goal.position_slack = goal.rotation_slack = {0.0, 0.0, 0.0};
    solver.set_obstacles(full.obstacles);
    const Request request{.goals = full.goals, .q0 = &full.q0, .posture = &full.posture};
    if (k == 0) solver.solve(request, result);
    EXPECT_EQ(allocations([&] { solver.solve(request, result); }), 0) << k;
  }
}

TEST(Allocation, a_tracker_that_carries_something_allocates_nothing_among_new_points) {
  const Robot robot = Robot::builtin("panda");
  Options options;
  options.self_collision = true;
  const Eigen::VectorXd q = robot.mid_configuration();
  for (const bool among_shapes : {false, true}) {
    Tracker tracker(robot, options, {.period = 0.001, .max_time = 10.0});
    if (among_shapes) {
      Eigen::Isometry3d aside = Eigen::Isometry3d::Identity();
      aside.translation() << 0.5, 0.9, 0.2;
      tracker.set_shapes(Shapes({Shape::box("box", aside, Eigen::Vector3d::Constant(0.1))}));
    }
    const Shape held =
        Shape::box("held", Eigen::Isometry3d::Identity(), Eigen::Vector3d(0.05, 0.05, 0.1));
    tracker.attach(robot.tip_links()[0], {&held, 1});
    tracker.reset(q);
    Random random(5);
    tracker.step(robot.fk(q));
    for (int k = 0; k < 20; ++k) {
      const ObstacleMatrix cloud = random_obstacles(random, 60, 1.5, 0.01);
      EXPECT_EQ(allocations([&] { tracker.set_obstacles(cloud); }), 0) << k;
      EXPECT_EQ(allocations([&] { tracker.step(robot.fk(q)); }), 0) << k;
    }
    Cloud cloud(random_obstacles(random, 60, 1.5, 0.01));
    tracker.set_obstacles(cloud);
    for (int k = 0; k < 5; ++k) {
      cloud.remove({Eigen::Vector3d::Constant(0.2 * k - 1.0), Eigen::Vector3d::Constant(0.2 * k)});
      EXPECT_EQ(allocations([&] { tracker.step(robot.fk(q)); }), 0) << k;
    }
  }
}

TEST(Allocation, a_tracker_takes_its_memory_at_construction) {
  int statuses[4] = {};
  for (int seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(static_cast<std::uint64_t>(seed));
    const Robot robot = roomy_tree(random);
    Options options = full_options(robot, random, Prefer::First);
    options.max_obstacles = 50;
    TrackerOptions tracking{.period = 0.01, .max_time = seed % 4 == 0 ? 1e-9 : 10.0};
    tracking.max_speed = Eigen::VectorXd::Constant(robot.dof(), 10.0);
    if (seed % 2 == 0) tracking.max_acceleration = 5.0 * tracking.max_speed;
    Tracker tracker(robot, options, tracking);
    const Eigen::VectorXd q = random_configuration(robot, random), posture = q.array() + 0.01;
    std::vector<Goal> goals;
    for (int tip = 0; tip < 2; ++tip) {
      Goal goal;
      goal.tip = tip;
      goal.T_base_tip = robot.fk(q, robot.tips()[static_cast<std::size_t>(tip)]);
      goals.push_back(goal);
    }
    EXPECT_EQ(allocations([&] { tracker.reset(q); }), 0);
    EXPECT_EQ(allocations([&] { tracker.set_posture(posture); }), 0);
    for (int k = 0; k < 20; ++k) {
      const ObstacleMatrix cloud = random_obstacles(random, k % 5 * 12, 1.5, 0.01);
      EXPECT_EQ(allocations([&] { EXPECT_TRUE(tracker.set_obstacles(cloud)); }), 0) << k;
      if (k == 10) goals[0].T_base_tip.translation().x() += 3.0;
      EXPECT_EQ(allocations([&] { tracker.step(goals); }), 0) << k;
      ++statuses[static_cast<int>(tracker.step(goals).tracking)];
    }
  }
  EXPECT_GT(statuses[static_cast<int>(TrackerStatus::Tracking)], 0);
  EXPECT_GT(statuses[static_cast<int>(TrackerStatus::Infeasible)], 0);
  EXPECT_GT(statuses[static_cast<int>(TrackerStatus::DeadlineStruck)], 0);
}

Goal moved_aside(Goal goal) {
  goal.T_base_tip.translation().x() += 0.1;
  return goal;
}

TEST(Allocation, a_tracker_that_is_given_what_makes_no_sense_says_so_without_allocating) {
  Random random(3);
  const Robot robot = roomy_tree(random);
  Options options = full_options(robot, random, Prefer::First);
  options.max_obstacles = 50;
  Tracker tracker(robot, options, {.max_time = 10.0});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect_refused = [&](std::vector<Goal> goals, const char* word) {
    const TrackerResult* step = nullptr;
    EXPECT_EQ(allocations([&] { step = &tracker.step(goals); }), 0) << word;
    EXPECT_EQ(step->tracking, TrackerStatus::InvalidInput);
    EXPECT_NE(std::string(step->complaint).find(word), std::string::npos) << step->complaint;
    EXPECT_EQ(step->q, tracker.q());
  };
  const Goal good = random_goals(robot, random, false).front();
  std::vector<std::pair<Goal, const char*>> bad(11, {good, ""});
  bad[0].first.T_base_tip.translation().x() = nan, bad[0].second = "NaN";
  bad[1].first.T_base_tip.linear() *= 1.5, bad[1].second = "not a rigid transform";
  bad[2].first.tip = 7, bad[2].second = "tip is 7";
  bad[3].first.axis.setZero(), bad[3].second = "axis";
  bad[4].first.weight = -1.0, bad[4].second = "weight";
  bad[5].first.position_slack.x() = nan, bad[5].second = "position_slack";
  bad[6].first.rotation_slack.x() = -1.0, bad[6].second = "rotation_slack";
  bad[7].first.weight = nan, bad[7].second = "weight";
  bad[8].first.T_base_tip.linear()(0, 0) = nan, bad[8].second = "NaN";
  bad[9].first.relative_to = good.tip, bad[9].second = "relative to itself";
  bad[10].first.relative_to = 9, bad[10].second = "relative to tip 9";
  for (const auto& [goal, word] : bad) expect_refused({goal}, word);
  expect_refused({}, "no goal");
  expect_refused({good, moved_aside(good)}, "contradict");

  const auto expect_cloud_refused = [&](const ObstacleMatrix& points, const char* word) {
    EXPECT_EQ(allocations([&] { EXPECT_FALSE(tracker.set_obstacles(points)); }), 0) << word;
    expect_refused({good}, word);
  };
  ObstacleMatrix points = ObstacleMatrix::Constant(10, 4, 1.0);
  points(3, 1) = nan;
  expect_cloud_refused(points, "row 3");
  points(3, 1) = 1e7;
  expect_cloud_refused(points, "1e6 m in row 3");
  points(3, 1) = 0.0, points(4, 3) = -1.0;
  expect_cloud_refused(points, "negative radius in row 4");
  expect_cloud_refused(ObstacleMatrix::Constant(10, 5, 1.0), "shape (10, 5)");
  expect_cloud_refused(ObstacleMatrix::Constant(51, 3, 1.0), "max_obstacles, 50");
  EXPECT_EQ(allocations([&] { tracker.hold("said from outside"); }), 2) << "the string's own";
}

TEST(Allocation, a_large_cloud_takes_as_much_memory_as_its_points_do_whatever_the_method) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(5);
  constexpr int kCount = 200000;
  const ObstacleMatrix points = random_obstacles(random, kCount, 1.0, 0.01);
  for (const auto& [method, inner] : {std::pair(Method::Default, InnerMethod::LevenbergMarquardt),
                                      std::pair(Method::Default, InnerMethod::Lbfgs),
                                      std::pair(Method::Paper, InnerMethod::Lbfgs)}) {
    Solver solver(robot, timeless(GoalType::Pose, method, inner));
    counted_bytes = 0;
    allocations([&] { solver.set_obstacles(points); });
    EXPECT_LT(counted_bytes, 130U * kCount + (8U << 20U));  // room for all near, and for all far
    counted_bytes = 0;
    allocations([&] { Solver copy(solver); });
    EXPECT_LT(counted_bytes, 16U << 20U) << "a copy shares the cloud";
  }
}

TEST(Allocation, a_tracker_of_one_tip_steps_without_allocating) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Tracker tracker(robot, timeless(), {.max_time = 10.0});
  const Eigen::Isometry3d target = robot.fk(robot.mid_configuration().array() + 1e-3);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(allocations([&] { tracker.step(target); }), 0);
}

TEST(Allocation, new_obstacles_allocate_only_when_there_are_more_than_ever_before) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(5);
  Options options = timeless();
  options.max_obstacles = 100;
  Solver solver(robot, options);
  for (const int count : {100, 0, 37, 99, 100}) {
    const ObstacleMatrix points = random_obstacles(random, count, 1.0, 0.01);
    EXPECT_EQ(allocations([&] { solver.set_obstacles(points); }), 0) << count;
  }
  const ObstacleMatrix many = random_obstacles(random, 300, 1.0, 0.01);
  EXPECT_GT(allocations([&] { solver.set_obstacles(many); }), 0);
  EXPECT_EQ(allocations([&] { solver.set_obstacles(many); }), 0);
  Result result;
  const Eigen::Isometry3d target = robot.fk(robot.mid_configuration());
  solver.solve(target, nullptr, result);
  EXPECT_EQ(allocations([&] { solver.solve(target, nullptr, result); }), 0);
}

TEST(Allocation, what_is_carried_and_what_may_touch_take_theirs_before_the_solve) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(7);
  Options options = timeless();
  options.max_restarts = 60;
  options.touch = {.radius = 0.1};
  Solver solver(robot, options);
  Tracker tracker(robot, options);
  Eigen::Isometry3d in_hand = Eigen::Isometry3d::Identity();
  in_hand.translation().z() = 0.15;
  const Shape cube = Shape::box("cube", in_hand, {0.05, 0.05, 0.05});
  std::vector<Shape> shapes;
  for (int k = 0; k < 8; ++k) {
    Eigen::Isometry3d T = random.pose(0.8);
    shapes.push_back(Shape::cylinder("can " + std::to_string(k), T, 0.05, 0.2));
  }
  const ObstacleMatrix points = random_obstacles(random, 200, 1.0);
  // Some pairs by rules of their own, which take theirs then as well.
  const std::vector<ContactRule> rules{{"cube", "can 0", 0.0},
                                       {"cube", "can 1"},
                                       {"*", "can 2", 0.02},
                                       {robot.link_names()[5], "points", 0.01},
                                       {robot.link_names()[1], robot.link_names()[5], 0.03}};
  solver.attach(robot.link_names().back(), {&cube, 1});
  tracker.attach(robot.link_names().back(), {&cube, 1});
  solver.set_shapes(Shapes(shapes, rules));
  tracker.set_shapes(Shapes(shapes, rules));
  solver.set_obstacles(points);
  tracker.set_obstacles(points);
  Result result;
  result.q = robot.mid_configuration();
  const auto target = [&] { return robot.fk(random_configuration(robot, random, 0.1)); };
  solver.solve(target(), nullptr, result);
  tracker.step(target());
  int solved = 0;
  for (int k = 0; k < 20; ++k) {
    const Eigen::Isometry3d T = target();
    EXPECT_EQ(allocations([&] { solver.solve(T, nullptr, result); }), 0);
    EXPECT_EQ(allocations([&] { tracker.step(T); }), 0);
    solved += result.success;
  }
  EXPECT_GT(solved, 5);
}

TEST(Allocation, solves_and_steps_in_a_field_of_distances_allocate_nothing) {
  const Robot robot = with_hulls(Robot::builtin("panda"));
  Random random(11);
  const std::array<int, 3> counts{60, 60, 50};
  const double cell = 0.03;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << -0.9, -0.9, -0.3;
  std::vector<Eigen::Vector3d> balls;
  for (int k = 0; k < 8; ++k) balls.push_back(random.point(0.8));
  std::vector<float> values;
  for (int i = 0; i < counts[0]; ++i) {
    for (int j = 0; j < counts[1]; ++j) {
      for (int k = 0; k < counts[2]; ++k) {
        const Eigen::Vector3d p = T * (cell * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5));
        double least = 1.0;
        for (const Eigen::Vector3d& ball : balls) least = std::min(least, (p - ball).norm() - 0.06);
        values.push_back(static_cast<float>(least));
      }
    }
  }
  const Shapes shapes({Shape::distance_field("field", T, DistanceField(values, counts, cell))});
  Options options = timeless();
  options.max_restarts = 60;
  Solver solver(robot, options);
  Tracker tracker(robot, options);
  Eigen::Isometry3d in_hand = Eigen::Isometry3d::Identity();
  in_hand.translation().z() = 0.15;
  const Shape cube = Shape::box("cube", in_hand, {0.05, 0.05, 0.05});
  solver.attach(robot.link_names().back(), {&cube, 1});
  tracker.attach(robot.link_names().back(), {&cube, 1});
  solver.set_shapes(shapes);
  tracker.set_shapes(shapes);
  Result result;
  result.q = robot.mid_configuration();
  const auto target = [&] { return robot.fk(random_configuration(robot, random, 0.1)); };
  solver.solve(target(), nullptr, result);
  tracker.step(target());
  int solved = 0;
  for (int k = 0; k < 20; ++k) {
    const Eigen::Isometry3d goal = target();
    EXPECT_EQ(allocations([&] { solver.solve(goal, nullptr, result); }), 0);
    EXPECT_EQ(allocations([&] { tracker.step(goal); }), 0);
    solved += result.success;
  }
  EXPECT_GT(solved, 5);
}

TEST(Allocation, minimisers_and_kinematics_take_their_memory_at_construction) {
  const Robot robot = Robot::builtin("iiwa14");
  const Eigen::VectorXd q = robot.mid_configuration();
  std::vector<Eigen::Isometry3d> poses(robot.bodies().size());
  EXPECT_EQ(allocations([&] { robot.body_poses(q, poses); }), 0);
  Lbfgs lbfgs(12);
  Eigen::VectorXd x = Eigen::VectorXd::Constant(12, 3.0);
  const auto bowl = [](const Eigen::VectorXd& at, Eigen::VectorXd& g) {
    return g = at, 0.5 * at.squaredNorm();
  };
  EXPECT_EQ(allocations([&] { lbfgs.minimize(bowl, x); }), 0);
  EXPECT_LT(x.norm(), 1e-6);
}

TEST(Allocation, self_collision_takes_its_memory_at_construction) {
  Robot robot = with_hulls(Robot::builtin("panda"));
  Occupancy occupancy = robot.occupancy();
  for (const char* link : {"panda_link0", "panda_link2", "panda_link5", "panda_link7"}) {
    for (const double x : {-0.05, 0.0, 0.05})
      occupancy.capsules.push_back({link, {x, 0.0, 0.0}, {x, 0.05, 0.0}, 0.03});
  }
  robot.set_occupancy(occupancy);
  const detail::HullModel model(robot);
  detail::SelfCollision self(robot, model, 0.01);
  std::vector<detail::Frame> frames(robot.bodies().size(),
                                    detail::to_frame(Eigen::Isometry3d::Identity()));
  std::vector<detail::Vec4> positions(model.points.size());
  Random random(6);
  int near = 0;
  for (int k = 0; k < 20; ++k) {
    for (detail::Vec4& position : positions) position = detail::to_vec4(random.point(0.5));
    EXPECT_EQ(allocations([&] {
                self.place(positions.data(), frames.data());
                self.find_near([](int) { return 10.0; });
                near += self.near_count();
                near += self.least().pair >= 0;
              }),
              0);
  }
  EXPECT_GT(near, 20 * self.pair_count() / 2);
}

#else

TEST(Allocation, a_solve_after_set_up_allocates_nothing) {
  GTEST_SKIP() << "the sanitizers' own malloc is in place";
}

#endif

}  // namespace
}  // namespace pdoik
