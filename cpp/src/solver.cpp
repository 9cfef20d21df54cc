#include "pdoik/solver.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "detail/check_input.hpp"
#include "detail/describe.hpp"
#include "detail/goal_of.hpp"
#include "detail/search.hpp"

namespace pdoik {

const char* to_string(Status status) {
  switch (status) {
    case Status::Solved:
      return "solved";
    case Status::TimeLimit:
      return "time_limit";
    case Status::Exhausted:
      return "exhausted";
    case Status::OutOfReach:
      return "out_of_reach";
    case Status::BaseCollision:
      return "base_collision";
  }
  return "unknown";
}

namespace {

/// Threads that are waited for, whatever happens.
struct Threads {
  std::vector<std::thread> threads;
  ~Threads() {
    for (std::thread& thread : threads) thread.join();
  }
};

}  // namespace

/// The robot and options a search refers to, kept at one address.
struct Solver::Implementation {
  Implementation(const Robot& robot_in, const Options& options_in)
      : robot(robot_in), options(options_in), search(robot, options) {}
  Implementation(const Implementation& other)
      : robot(other.robot), options(other.options), search(robot, options, other.search) {}

  Robot robot;
  Options options;
  detail::Search search;
};

Solver::Solver(const Robot& robot, const Options& options) {
  detail::check_set_up(robot, options);
  impl_ = std::make_unique<Implementation>(robot, options);
}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::Solver(const Solver& other) : impl_(std::make_unique<Implementation>(*other.impl_)) {}
Solver::~Solver() = default;

const Robot& Solver::robot() const { return impl_->robot; }
const Options& Solver::options() const { return impl_->options; }

void Solver::set_obstacles(const Obstacles& points) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point started = Clock::now();
  detail::check_obstacles(points);
  impl_->search.set_obstacles(points);
  impl_->search.set_intake(std::chrono::duration<double>(Clock::now() - started).count());
}

void Solver::set_interrupt(std::function<bool()> wanted) {
  impl_->search.set_interrupt(std::move(wanted));
}

void Solver::clear_obstacles() { impl_->search.set_obstacles(Points(0, 3)); }

Goal Solver::goal(const Eigen::Isometry3d& T_base_tip, int tip) const {
  return detail::goal_of(options(), T_base_tip, tip);
}

void Solver::solve(const Request& request, Result& result) {
  detail::check_request(request, robot(), options());
  impl_->search.run(request, result);
}

void Solver::solve(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd* q0, Result& result) {
  detail::check_one_tip(robot());
  const Goal only = goal(T_base_tip);
  solve({.goals = {&only, 1}, .q0 = q0}, result);
}

Result Solver::solve(const Eigen::Isometry3d& T_base_tip,
                     const std::optional<Eigen::VectorXd>& q0) {
  Result result;
  solve(T_base_tip, q0 ? &*q0 : nullptr, result);
  return result;
}

std::vector<Result> Solver::solve_batch(std::span<const Eigen::Isometry3d> targets,
                                        std::span<const Eigen::VectorXd> q0, int threads) const {
  detail::check_one_tip(robot());
  std::vector<std::vector<Goal>> goals;
  goals.reserve(targets.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    detail::check_target(targets[i], "T_base_tip[" + std::to_string(i) + "]");
    goals.push_back({goal(targets[i])});
  }
  return solve_goals_batch(goals, q0, threads);
}

std::vector<Result> Solver::solve_goals_batch(std::span<const std::vector<Goal>> goals,
                                              std::span<const Eigen::VectorXd> q0,
                                              int threads) const {
  if (threads < 0)
    throw std::invalid_argument("threads is " + std::to_string(threads) + ", expected at least 0");
  if (!q0.empty() && q0.size() != 1 && q0.size() != goals.size()) {
    throw std::invalid_argument("q0 has " + std::to_string(q0.size()) + " rows, expected 1 or " +
                                std::to_string(goals.size()));
  }
  for (const std::vector<Goal>& each : goals) detail::check_goals(each, robot(), options());
  for (std::size_t i = 0; i < q0.size(); ++i) {
    detail::check_configuration(q0[i], robot().dof(),
                                q0.size() == 1 ? "q0" : "q0[" + std::to_string(i) + "]");
  }
  std::vector<Result> results(goals.size());
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    try {
      Solver own(*this);
      for (std::size_t i = next++; i < goals.size(); i = next++) {
        const Eigen::VectorXd* start = q0.empty() ? nullptr : &q0[q0.size() == 1 ? 0 : i];
        own.solve({.goals = goals[i], .q0 = start}, results[i]);
      }
    } catch (...) {
      const std::lock_guard<std::mutex> lock(failure_mutex);
      failure = std::current_exception();
    }
  };
  const std::size_t wanted =
      threads > 0 ? static_cast<std::size_t>(threads) : std::thread::hardware_concurrency();
  const std::size_t count =
      std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(goals.size(), 1));
  {
    Threads pool;
    try {
      for (std::size_t t = 1; t < count; ++t) pool.threads.emplace_back(work);
    } catch (const std::exception&) {
      // The system gives no more threads, or no memory for them: those there are do the work.
    }
    work();
  }
  if (failure) std::rethrow_exception(failure);
  return results;
}

void Solver::judge(const Eigen::Isometry3d& T_base_tip, VectorIn q, Result& result) {
  detail::check_one_tip(robot());
  const Goal only = goal(T_base_tip);
  judge({&only, 1}, q, result);
}

void Solver::judge(std::span<const Goal> goals, VectorIn q, Result& result) {
  detail::check_goals(goals, robot(), options());
  const Eigen::VectorXd configuration = q;
  detail::check_configuration(configuration, robot().dof(), "q");
  impl_->search.judge(goals, configuration, result);
  result.status = result.success ? Status::Solved : Status::Exhausted;
}

std::string Solver::describe(const WorstConstraint& worst) const {
  return detail::describe(worst, robot());
}

}  // namespace pdoik
