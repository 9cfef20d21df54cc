// Times calls that have a deadline, for bench/ik/deadlines/__main__.py:
//
//     pdoik_deadlines ROBOT CALL CLOUD BUDGET REPEATS SECONDS SEED
//
// CALL is LM, lbfgs, paper (Solver::solve) or tracker (Tracker::step); CLOUD a file of doubles, x y
// z row by row, or `none`; BUDGET the deadline [s]. Each kind of goal gets REPEATS calls, or as
// many as SECONDS hold, three at least. One CSV line a call, times in nanoseconds: of the cloud's
// intake (set_obstacles) and of the call, by the wall's clock and by the thread's, which stands
// still while another program has the processor.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <stdexcept>

#include "cases.hpp"

namespace pdoik::bench {
namespace {

constexpr int kWarmUp = 3;         // calls of each kind that are not counted
constexpr int kLeast = 3;          // calls that are, however long they take
constexpr int kGoals = 8;          // of each kind
constexpr int kStepsPerGoal = 50;  // of a tracker, which then gets another one

struct Instant {
  long long wall, cpu;  // [ns]

  static Instant now() {
    const auto read = [](clockid_t clock) {
      timespec time{};
      clock_gettime(clock, &time);
      return 1'000'000'000LL * time.tv_sec + time.tv_nsec;
    };
    return {read(CLOCK_MONOTONIC), read(CLOCK_THREAD_CPUTIME_ID)};
  }
};

struct Arguments {
  std::string robot, call, cloud;
  double budget, seconds;
  int repeats;
  std::uint32_t seed;
};

Cloud read_cloud(const std::string& path, const Eigen::RowVector3d& last) {
  std::ifstream file;
  std::streamsize bytes = 0;
  if (path != "none") {
    file.open(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error("cannot read " + path);
    bytes = file.tellg();
    file.seekg(0);
  }
  Cloud cloud(bytes / static_cast<std::streamsize>(3 * sizeof(double)) + 1, 3);
  file.read(reinterpret_cast<char*>(cloud.data()), bytes);
  cloud.bottomRows<1>() = last;
  return cloud;
}

Options options_for(const Arguments& arguments, Eigen::Index points) {
  Options options;
  options.max_time = arguments.budget;
  options.max_obstacles = static_cast<int>(points);
  if (arguments.call == "paper") options.method = Method::Paper;
  if (arguments.call == "lbfgs") options.inner = InnerMethod::Lbfgs;
  return options;
}

/// What a result says of its own intake [s] and of work begun after the deadline, where it does.
template <typename R>
double stated_intake(const R& result) {
  if constexpr (requires { result.intake; }) return result.intake;
  return -1.0;
}
template <typename R>
int late_evaluations(const R& result) {
  if constexpr (requires { result.late_evaluations; }) return result.late_evaluations;
  return -1;
}

/// One kind of goal: `take_in` gets the cloud, `call` a goal, and gives the result and whether it
/// was the deadline that ended it.
template <typename TakeIn, typename Call>
void time_case(const Case& kind, const Arguments& arguments, int turns_per_goal, TakeIn take_in,
               Call call) {
  const Instant started = Instant::now();
  for (int turn = -kWarmUp; turn < arguments.repeats; ++turn) {
    const std::size_t at = static_cast<std::size_t>(std::max(turn, 0) / turns_per_goal);
    const std::vector<Goal>& goals = kind.goals[at % kind.goals.size()];
    const Instant before = Instant::now();
    take_in();
    const Instant between = Instant::now();
    const auto [result, struck] = call(goals);
    const Instant after = Instant::now();
    if (turn >= 0)
      std::printf("%s,%lld,%lld,%lld,%lld,%.0f,%d,%d,%d\n", kind.name.c_str(),
                  between.wall - before.wall, between.cpu - before.cpu, after.wall - between.wall,
                  after.cpu - between.cpu, 1e9 * stated_intake(*result), late_evaluations(*result),
                  result->evaluations, struck ? 1 : 0);
    if (turn + 1 >= kLeast &&
        1e-9 * static_cast<double>(after.wall - started.wall) > arguments.seconds)
      break;
  }
}

void time_solves(const Robot& robot, const Case& kind, const Cloud& cloud, Options options,
                 const Arguments& arguments) {
  options.base_collision = kind.in_base_hull;
  Solver solver(robot, options);
  Result result;
  const Eigen::Index count = cloud.rows() - (kind.in_base_hull ? 0 : 1);
  time_case(
      kind, arguments, 1, [&] { solver.set_obstacles(cloud.topRows(count)); },
      [&](const std::vector<Goal>& goals) {
        solver.solve({.goals = goals}, result);
        return std::pair{&result, result.status == Status::TimeLimit};
      });
}

void time_steps(const Robot& robot, const Case& kind, const Cloud& cloud, Options options,
                const Arguments& arguments) {
  options.base_collision = kind.in_base_hull;
  Tracker tracker(robot, options, {.period = 0.001, .max_time = arguments.budget});
  tracker.reset(robot.mid_configuration());
  const Eigen::Index count = cloud.rows() - (kind.in_base_hull ? 0 : 1);
  time_case(
      kind, arguments, kStepsPerGoal,
      [&] {
        if (!tracker.set_obstacles(cloud.topRows(count)))
          throw std::runtime_error("the tracker refuses the cloud");
      },
      [&](const std::vector<Goal>& goals) {
        const TrackerResult& result = tracker.step(goals);
        return std::pair{&result, result.tracking == TrackerStatus::DeadlineStruck};
      });
}

void run(const Arguments& arguments) {
  const Robot robot = robot_with_base_tip(arguments.robot);
  // The last point is for the goals that want one in a base hull.
  const Cloud cloud =
      read_cloud(arguments.cloud, point_in_base_hull(robot).value_or(Eigen::RowVector3d::Zero()));
  const Options options = options_for(arguments, cloud.rows());
  std::puts("case,intake_wall,intake_cpu,wall,cpu,stated_intake,late,evaluations,struck");
  const Cloud without_last = cloud.topRows(cloud.rows() - 1);
  for (const Case& kind : cases_among(robot, without_last, kGoals, arguments.seed))
    (arguments.call == "tracker" ? time_steps : time_solves)(robot, kind, cloud, options,
                                                             arguments);
}

}  // namespace
}  // namespace pdoik::bench

int main(int count, char** words) {
  if (count != 8) {
    std::fputs("pdoik_deadlines ROBOT CALL CLOUD BUDGET REPEATS SECONDS SEED\n", stderr);
    return 2;
  }
  try {
    pdoik::bench::run({.robot = words[1],
                       .call = words[2],
                       .cloud = words[3],
                       .budget = std::atof(words[4]),
                       .seconds = std::atof(words[6]),
                       .repeats = std::atoi(words[5]),
                       .seed = static_cast<std::uint32_t>(std::atoi(words[7]))});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
