#include "pdoik/solver.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include "common/check_input.hpp"
#include "common/thread_pool.hpp"
#include "kinematics/goal_of.hpp"
#include "obstacles/check_obstacles.hpp"
#include "obstacles/describe.hpp"
#include "paths/check_path.hpp"
#include "paths/motion_plan.hpp"
#include "paths/path_search.hpp"
#include "pdoik/cloud.hpp"
#include "pdoik/point_cloud.hpp"
#include "problem/check_request.hpp"
#include "problem/clearances.hpp"
#include "problem/explain.hpp"
#include "search/all_solutions.hpp"
#include "search/derivatives.hpp"
#include "search/multistart.hpp"
#include "search/paper.hpp"

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
    case Status::Blocked:
      return "blocked";
    case Status::Nearest:
      return "nearest";
  }
  return "unknown";
}

namespace {

/// No thread is woken for fewer targets than this.
constexpr std::size_t kFewestEach = 4;

/// Whether a batch is to end early: asked of whoever wants to know by the thread that called, on
/// which alone Ctrl-C is heard, and passed on to the others.
class BatchInterrupt {
 public:
  explicit BatchInterrupt(const std::function<bool()>& wanted) : wanted_(wanted) {}

  /// Asks, if this is the thread that called.
  bool ask() {
    if (wanted_ && std::this_thread::get_id() == caller_ && !stop_ && wanted_()) stop_ = true;
    return stop_;
  }
  /// The same ten times a second.
  bool ask_now_and_then() {
    if (!wanted_ || std::this_thread::get_id() != caller_) return stop_;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return stop_;
    next_ = now + std::chrono::milliseconds(100);
    return ask();
  }

 private:
  const std::function<bool()>& wanted_;
  const std::thread::id caller_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point next_ =
      std::chrono::steady_clock::now() + std::chrono::milliseconds(100);
  std::atomic<bool> stop_{false};
};

/// One request after the other of a list that several threads work on.
class Shared final : public detail::Requests {
 public:
  Shared(std::span<const Request> requests, std::vector<Result>& results,
         std::atomic<std::size_t>& turn, BatchInterrupt& interrupt)
      : requests_(requests), results_(results), turn_(turn), interrupt_(interrupt) {}

  bool next(Request& request, Result*& result) override {
    if (interrupt_.ask_now_and_then()) return false;
    const std::size_t i = turn_++;
    if (i >= requests_.size()) return false;
    request = requests_[i];
    result = &results_[i];
    return true;
  }

 private:
  std::span<const Request> requests_;
  std::vector<Result>& results_;
  std::atomic<std::size_t>& turn_;
  BatchInterrupt& interrupt_;
};

/// What a thread needs to solve.
struct Worker {
  Worker(std::shared_ptr<const detail::Model> model, const detail::Scene& scene)
      : workspace(std::move(model), scene), multistart(workspace) {}

  void solve(detail::Requests& requests) {
    if (workspace.model().options.method == Method::Default) {
      multistart.run(requests);
      return;
    }
    Request request;
    Result* result;
    while (requests.next(request, result))
      detail::solve_as_in_the_paper(workspace, request, *result);
  }

  detail::Workspace workspace;
  detail::Multistart multistart;
};

/// Workers of past batches, kept for the next.
class Workers {
 public:
  std::unique_ptr<Worker> take(const std::shared_ptr<const detail::Model>& model,
                               const detail::Scene& scene) {
    std::unique_ptr<Worker> worker;
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        worker = std::move(idle_.back());
        idle_.pop_back();
      }
    }
    if (worker == nullptr) return std::make_unique<Worker>(model, scene);
    worker->workspace.use(scene);
    return worker;
  }
  void give_back(std::unique_ptr<Worker> worker) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(worker));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Worker>> idle_;
};

}  // namespace

struct Solver::Implementation {
  Implementation(const Robot& robot, const Options& options)
      : model(std::make_shared<detail::Model>(robot, options)),
        scene(model->robot, model->hulls, model->options),
        own(model, scene) {}
  /// Shares robot, options and obstacles.
  Implementation(const Implementation& other)
      : model(other.model), scene(other.scene), own(model, scene) {}

  /// Kept while the obstacles are read.
  detail::CloudState::Reading read() {
    auto reading = scene.read();
    if (scene.has_changed()) own.workspace.use(scene);
    return reading;
  }

  std::shared_ptr<const detail::Model> model;
  detail::Scene scene;
  Worker own;
  Workers workers;
};

Solver::Solver(const Robot& robot, const Options& options) {
  detail::check_set_up(robot, options);
  impl_ = std::make_unique<Implementation>(robot, options);
}
Solver::Solver(Solver&&) noexcept = default;
Solver& Solver::operator=(Solver&&) noexcept = default;
Solver::Solver(const Solver& other) : impl_(std::make_unique<Implementation>(*other.impl_)) {}
Solver::~Solver() = default;

const Robot& Solver::robot() const { return impl_->model->robot; }
const Options& Solver::options() const { return impl_->model->options; }

void Solver::set_obstacles(const Obstacles& points) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point started = Clock::now();
  detail::check_count(points.rows(), "obstacles");
  const Obstacles own = impl_->scene.copied(points);
  detail::check_obstacles(own);
  impl_->scene.assign(own);
  impl_->scene.intake = std::chrono::duration<double>(Clock::now() - started).count();
}

void Solver::set_obstacles(const Cloud& cloud) { impl_->scene.use(cloud.state_); }

void Solver::set_shapes(const Shapes& shapes) { impl_->scene.use(shapes.set_); }

void Solver::attach(std::span<const Attachment> things) { impl_->scene.attach(things); }
void Solver::attach(const std::string& link, std::span<const Shape> shapes,
                    std::span<const std::string> may_touch) {
  impl_->scene.attach(link, shapes, may_touch);
}
void Solver::detach(const std::string& name) { impl_->scene.detach(name); }
void Solver::detach() { impl_->scene.detach(); }
std::vector<Attachment> Solver::attached() const { return impl_->scene.attached(); }

void Solver::set_interrupt(std::function<bool()> wanted) {
  impl_->own.workspace.interrupt = std::move(wanted);
}

void Solver::clear_obstacles() {
  impl_->scene.assign(Points(0, 3));
  impl_->scene.intake = 0.0;
  set_shapes(Shapes());
}

Goal Solver::goal(const Eigen::Isometry3d& T_base_tip, int tip) const {
  return detail::goal_of(options(), T_base_tip, tip);
}

void Solver::solve(const Request& request, Result& result) {
  detail::check_request(request, robot(), options());
  const auto reading = impl_->read();
  detail::OneRequest requests(request, result);
  impl_->own.solve(requests);
}

Solutions Solver::solve_all(const Request& request, const AllOptions& wanted) {
  detail::check_request(request, robot(), options());
  detail::check_all(request, wanted, options());
  const auto reading = impl_->read();
  Result best;
  return detail::all_solutions(impl_->own.workspace, impl_->own.multistart, request, wanted, best);
}

PathResult Solver::solve_path(const PathRequest& request, const PathOptions& wanted) {
  detail::check_path(request, wanted, robot(), options());
  const auto reading = impl_->read();
  const detail::Bounds bounds(robot(), request.locks);
  return detail::PathSearch(impl_->own.workspace, impl_->own.multistart, request, wanted,
                            bounds.lower, bounds.upper)
      .run();
}

MotionResult Solver::plan_motion(const MotionRequest& request, const MotionOptions& wanted) {
  detail::check_motion(request, wanted, robot(), options());
  const auto reading = impl_->read();
  const detail::Bounds bounds(robot(), request.locks);
  return detail::plan_motion(impl_->own.workspace, impl_->own.multistart, request, wanted, bounds);
}

Derivatives Solver::derivatives(std::span<const Goal> goals, VectorIn q) {
  detail::check_goals(goals, robot(), options());
  const Eigen::VectorXd configuration = q;
  detail::check_configuration(configuration, robot().dof(), "q");
  const auto reading = impl_->read();
  return detail::derivatives(impl_->own.workspace, goals, configuration);
}

std::string Solver::explain(const Request& request, const Result& result) const {
  return detail::explain(*impl_->model, impl_->scene, request, result);
}

std::string Solver::explain(const PathRequest& request, const PathResult& result) const {
  return detail::explain(*impl_->model, impl_->scene, request, result);
}

std::string Solver::explain(const PathEnd& end) const {
  return detail::explain(*impl_->model, impl_->scene, end);
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
  if (!q0.empty() && q0.size() != 1 && q0.size() != goals.size()) {
    throw std::invalid_argument("q0 has " + std::to_string(q0.size()) + " rows, expected 1 or " +
                                std::to_string(goals.size()));
  }
  std::vector<Request> requests;
  for (std::size_t i = 0; i < goals.size(); ++i)
    requests.push_back(
        {.goals = goals[i], .q0 = q0.empty() ? nullptr : &q0[q0.size() == 1 ? 0 : i]});
  return solve_requests(requests, threads);
}

std::vector<Result> Solver::solve_requests(std::span<const Request> asked, int threads) const {
  if (threads < 0)
    throw std::invalid_argument("threads is " + std::to_string(threads) + ", expected at least 0");
  for (std::size_t i = 0; i < asked.size(); ++i)
    detail::check_request(asked[i], robot(), options(), static_cast<int>(i));
  // Batches of one solver may run at once, so each has a view of the obstacles of its own.
  detail::Scene scene(impl_->scene);
  const auto reading = scene.read();
  Result not_begun;
  not_begun.q = robot().mid_configuration();
  not_begun.status = Status::TimeLimit;
  std::vector<Result> results(asked.size(), not_begun);
  BatchInterrupt interrupt(impl_->own.workspace.interrupt);
  std::atomic<std::size_t> turn{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    try {
      auto worker = impl_->workers.take(impl_->model, scene);
      worker->workspace.interrupt = [&interrupt] { return interrupt.ask(); };
      Shared requests(asked, results, turn, interrupt);
      worker->solve(requests);
      worker->workspace.interrupt = nullptr;
      impl_->workers.give_back(std::move(worker));
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      failure = std::current_exception();
    }
  };
  const auto wanted = static_cast<std::size_t>(threads > 0 ? threads : detail::processor_count());
  const std::size_t count = std::clamp<std::size_t>(asked.size() / kFewestEach, 1, wanted);
  detail::run_together(static_cast<int>(count) - 1, work, [&interrupt] { interrupt.ask(); });
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
  const auto reading = impl_->read();
  impl_->own.workspace.judge_unwatched(goals, configuration, result);
  result.status = result.success ? Status::Solved
                  : result.holds ? Status::Nearest
                                 : Status::Exhausted;
}

std::vector<ObstacleClearance> Solver::clearances(VectorIn q) {
  const Eigen::VectorXd configuration = q;
  detail::check_configuration(configuration, robot().dof(), "q");
  const auto reading = impl_->read();
  return detail::clearances(*impl_->model, impl_->scene, configuration);
}

std::string Solver::part_name(const ObstacleClearance& of) const {
  if (of.held >= 0) return impl_->scene.attachments()[of.held].shape.name;
  return of.hull < 0 ? "" : detail::hull_name(robot().occupancy(), of.hull);
}

std::string Solver::shape_name(int shape) const { return impl_->scene.shapes().shape(shape).name; }

std::string Solver::describe(const WorstConstraint& worst) const {
  return detail::describe(worst, robot(), impl_->scene);
}

}  // namespace pdoik
