#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "goals.hpp"
#include "pdoik/solver.hpp"
#include "result.hpp"
#include "scene.hpp"
#include "units.hpp"
#include "without_gil.hpp"

namespace pdoik::python {
namespace {

/// A solver belongs to one thread at a time: Python's threads wait for their turn.
struct SharedSolver {
  SharedSolver(const Robot& robot, const Options& options) : solver(robot, options) {
    solver.set_interrupt(is_interrupted);
  }
  Solver solver;
  ToldOfUnits told_of_units = false;  ///< with the GIL held

  /// Of a thread, from when it is made. Without the GIL; Ctrl-C is heard while it waits.
  class Turn {
   public:
    explicit Turn(SharedSolver& of) : of_(of) {
      if (of.taken_by_.load() == std::this_thread::get_id()) {
        throw std::runtime_error(
            "the solver is solving in this very thread, which a signal's handler has interrupted: "
            "a handler needs a solver of its own");
      }
      while (!of.mutex_.try_lock_for(std::chrono::milliseconds(100))) raise_if_interrupted();
      of.taken_by_ = std::this_thread::get_id();
    }
    ~Turn() {
      of_.taken_by_ = std::thread::id();
      of_.mutex_.unlock();
    }
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    SharedSolver& of_;
  };

  /// Batches run beside solves and one another, each with a copy: of those of past batches one is
  /// used again, for making its memory takes longer than a short batch.
  /// @param generation  What give_back is to be told.
  std::unique_ptr<Solver> take_copy(int& generation) {
    {
      const std::lock_guard lock(copies_mutex_);
      generation = changes_;
      if (!copies_.empty()) {
        std::unique_ptr<Solver> copy = std::move(copies_.back());
        copies_.pop_back();
        return copy;
      }
    }
    const Turn turn(*this);
    auto copy = std::make_unique<Solver>(solver);
    copy->set_interrupt(is_interrupted);
    const std::lock_guard lock(copies_mutex_);
    generation = changes_;
    return copy;
  }
  /// Change what the solver carries, which copies of past batches know nothing of.
  template <class Change>
  void change(Change&& change) {
    const WithoutGil release;
    const Turn turn(*this);
    change(solver);
    const std::lock_guard lock(copies_mutex_);
    copies_.clear();
    ++changes_;
  }
  void give_back(std::unique_ptr<Solver> copy, int generation) {
    copy->clear_obstacles();  // which may be a cloud that nobody else holds any more
    const std::lock_guard lock(copies_mutex_);
    if (generation == changes_) copies_.push_back(std::move(copy));
  }

 private:
  std::timed_mutex mutex_;  ///< of the solver
  std::atomic<std::thread::id> taken_by_;
  std::mutex copies_mutex_;  ///< never held for long
  std::vector<std::unique_ptr<Solver>> copies_;
  int changes_ = 0;
};

/// A copy of the solver, until the batch ends.
class BatchSolver {
 public:
  explicit BatchSolver(SharedSolver& of) : of_(of), solver_(of.take_copy(generation_)) {}
  ~BatchSolver() {
    try {
      of_.give_back(std::move(solver_), generation_);
    } catch (const std::bad_alloc&) {
      // Another will be made.
    }
  }
  BatchSolver(const BatchSolver&) = delete;
  BatchSolver& operator=(const BatchSolver&) = delete;

  Solver& operator*() { return *solver_; }

 private:
  SharedSolver& of_;
  int generation_ = 0;
  std::unique_ptr<Solver> solver_;
};

NamedResult solve(SharedSolver& self, const GoalsLike& T_base_tip,
                  const std::optional<ArrayLike>& q0, const std::optional<ObstaclesLike>& obstacles,
                  const std::optional<ArrayLike>& posture,
                  const std::optional<ArrayLike>& max_step) {
  const Robot& robot = self.solver.robot();
  const std::vector<Goal> goals = to_goals(T_base_tip, robot, self.solver.options());
  const auto vector = [&](const std::optional<ArrayLike>& values, const char* name) {
    std::optional<Eigen::VectorXd> result;
    if (values) result = to_vector(*values, name, robot.dof());
    return result;
  };
  const std::optional<Eigen::VectorXd> start = vector(q0, "q0"), near = vector(posture, "posture"),
                                       step = vector(max_step, "max_step");
  const auto address = [](const std::optional<Eigen::VectorXd>& v) { return v ? &*v : nullptr; };
  const Request request{goals, address(start), address(near), address(step)};
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, self.solver.robot(), self.told_of_units);
  NamedResult result;
  {
    const WithoutGil release;
    const SharedSolver::Turn turn(self);
    using Clock = std::chrono::steady_clock;
    const Clock::time_point started = Clock::now();
    given.give_to(self.solver);
    Result solved;
    self.solver.solve(request, solved);
    solved.time = std::chrono::duration<double>(Clock::now() - started).count();  // with the cloud
    result = named(self.solver, std::move(solved));
  }
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();  // Ctrl-C ended it
  return result;
}

NamedResult judge(SharedSolver& self, const GoalsLike& T_base_tip, const ArrayLike& q,
                  const std::optional<ObstaclesLike>& obstacles) {
  const std::vector<Goal> goals = to_goals(T_base_tip, self.solver.robot(), self.solver.options());
  const Eigen::VectorXd configuration = to_vector(q, "q", self.solver.robot().dof());
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, self.solver.robot(), self.told_of_units);
  const WithoutGil release;
  const SharedSolver::Turn turn(self);
  given.give_to(self.solver);
  Result result;
  self.solver.judge(goals, configuration, result);
  return named(self.solver, std::move(result));
}

/// How near the robot is to one obstacle, by names.
struct NamedClearance {
  std::string obstacle, part;
  double distance;
  std::optional<int> point;
};

std::vector<NamedClearance> clearances(SharedSolver& self, const ArrayLike& q,
                                       const std::optional<ObstaclesLike>& obstacles) {
  const Eigen::VectorXd configuration = to_vector(q, "q", self.solver.robot().dof());
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, self.solver.robot(), self.told_of_units);
  const WithoutGil release;
  const SharedSolver::Turn turn(self);
  given.give_to(self.solver);
  std::vector<NamedClearance> result;
  for (const ObstacleClearance& each : self.solver.clearances(configuration)) {
    NamedClearance& named = result.emplace_back();
    named.obstacle = each.shape < 0 ? "points" : self.solver.shape_name(each.shape);
    named.part = self.solver.part_name(each);
    named.distance = each.distance;
    if (each.point >= 0) named.point = each.point;
  }
  return result;
}

void bind_clearance(py::module_& module) {
  py::class_<NamedClearance>(
      module, "ObstacleClearance",
      "How near the robot, and what it carries, is to one obstacle: see Solver.clearances.")
      .def_readonly("obstacle", &NamedClearance::obstacle, "The shape's name, or 'points'.")
      .def_readonly("part", &NamedClearance::part,
                    "The nearest hull, or what is carried; '' where nothing is to keep off it.")
      .def_readonly("distance", &NamedClearance::distance,
                    "Negative by how deep it is; infinite where nothing is to keep off it [m].")
      .def_readonly("point", &NamedClearance::point, "The nearest point's row, of points.")
      .def("__repr__", [](const NamedClearance& c) {
        return py::str("<ObstacleClearance of {} to {}: {:.6g} m>")
            .format(c.part, c.obstacle, c.distance);
      });
}

BatchResult solve_batch(SharedSolver& self, const GoalsBatchLike& T_base_tip,
                        const std::optional<ArrayLike>& q0,
                        const std::optional<ObstaclesLike>& obstacles, int threads) {
  using Clock = std::chrono::steady_clock;
  const std::vector<std::vector<Goal>> goals =
      to_goals_batch(T_base_tip, self.solver.robot(), self.solver.options());
  std::vector<Eigen::VectorXd> starts;
  if (q0) starts = to_vectors(*q0, "q0", self.solver.robot().dof());
  if (q0 && starts.size() != 1 && starts.size() != goals.size()) {
    throw std::invalid_argument("q0 has " + std::to_string(starts.size()) +
                                " rows, expected 1 or " + std::to_string(goals.size()));
  }
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, self.solver.robot(), self.told_of_units);
  BatchResult batch;
  batch.dof = self.solver.robot().dof();

  const WithoutGil release;
  BatchSolver batch_solver(self);
  Solver& solver = *batch_solver;
  given.give_to(solver);
  std::size_t done = 0, slice = 128;
  do {
    const Clock::time_point started = Clock::now();
    const std::size_t count = std::min(slice, goals.size() - done);
    const auto own_starts =
        starts.size() > 1 ? std::span(starts).subspan(done, count) : std::span(starts);
    for (Result& result :
         solver.solve_goals_batch(std::span(goals).subspan(done, count), own_starts, threads)) {
      batch.results.push_back(named(solver, std::move(result)));
    }
    raise_if_interrupted();
    done += count;
    if (Clock::now() - started < std::chrono::milliseconds(100)) slice *= 2;
  } while (done < goals.size());
  return batch;
}

/// What is left of a batch where only whether and how a pose is reached counts.
py::typing::Tuple<py::array_t<std::uint8_t>, py::array_t<float>> reach_poses(
    SharedSolver& self, const ArrayLike& T_base_tip, const std::optional<ObstaclesLike>& obstacles,
    int threads) {
  const std::vector<Eigen::Isometry3d> targets = to_isometries(T_base_tip, "T_base_tip");
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, self.solver.robot(), self.told_of_units);
  const auto count = static_cast<py::ssize_t>(targets.size());
  py::array_t<std::uint8_t> statuses(count);
  py::array_t<float> q({count, static_cast<py::ssize_t>(self.solver.robot().dof())});
  auto* const status_at = statuses.mutable_data();
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> rows(
      q.mutable_data(), count, self.solver.robot().dof());
  const WithoutGil release;
  BatchSolver batch_solver(self);
  Solver& solver = *batch_solver;
  given.give_to(solver);
  constexpr std::size_t kSlice = 4096;  // results take memory until they are written down
  for (std::size_t done = 0; done < targets.size(); done += kSlice) {
    const auto slice = std::span(targets).subspan(done, std::min(kSlice, targets.size() - done));
    const std::vector<Result> results = solver.solve_batch(slice, {}, threads);
    for (std::size_t k = 0; k < results.size(); ++k) {
      status_at[done + k] = static_cast<std::uint8_t>(results[k].status);
      auto row = rows.row(static_cast<Eigen::Index>(done + k));
      if (results[k].success)
        row = results[k].q.cast<float>().transpose();
      else
        row.setConstant(std::numeric_limits<float>::quiet_NaN());
    }
    raise_if_interrupted();
  }
  const py::gil_scoped_acquire acquire;
  return py::make_tuple(statuses, q);
}

}  // namespace

void bind_solver(py::module_& module) {
  bind_clearance(module);
  py::class_<SharedSolver>(module, "Solver")
      .def(py::init<const Robot&, const Options&>(), py::arg("robot"), py::arg("options"))
      .def_property_readonly(
          "robot", [](const SharedSolver& self) { return self.solver.robot(); },
          "A copy of the robot this solver was made for, as it was then.")
      .def("solve", &solve, py::arg("T_base_tip"), py::arg("q0") = py::none(),
           py::arg("obstacles") = py::none(), py::arg("posture") = py::none(),
           py::arg("max_step") = py::none(),
           R"(Find q so that the tips meet their goals, inside joint limits, clear of obstacles.

Balance and distance from itself are kept where the options ask for them.

Args:
    T_base_tip: The target, which takes tip points to the base frame: shape (4, 4), rigid to 1e-6 [m]; or a
        Goal; or for several tips a dict of such by tip link. Tips without a goal are free.
    q0: Where to start, shape (n,) [rad] or [m], moved inside the limits; answers near it are preferred.
        None for the middle of the ranges (method "paper": omega = 0), and any answer. Continuous joints'
        answers are within pi of it.
    obstacles: A Cloud; a list of Shapes; a Scene of both; or points x y z, or x y z radius, in the base frame,
        shape (N, 3) or (N, 4) [m], taken in by each call anew. Float64 in C order is read without a
        conversion. None or empty: there are none, whatever the call before had.
    posture: A configuration that the answer comes as near to as goals and constraints let it, downhill from
        the first solution found, shape (n,) [rad] or [m].
    max_step: Hard bounds on |q - q0| of each joint, shape (n,) [rad] or [m]: speed times period.

Returns:
    The result; not being able to is a status, not an exception.

Raises:
    ValueError: A shape is wrong, a target is not rigid, a link is no tip, a radius or step is negative,
        something is NaN or infinite, or there are more than 33,554,432 points. There are obstacles, or the robot
        carries something, and it has no hulls: see Options.ignore_obstacles_without_hulls.
    RuntimeError: A signal's handler asks the very solver that it has interrupted.

Warns:
    ObstacleWarning: Points are so far away, once for each solver, that they are in millimetres most likely.)")
      .def("solve_batch", &solve_batch, py::arg("T_base_tip"), py::arg("q0") = py::none(),
           py::arg("obstacles") = py::none(), py::arg("threads") = 0,
           R"(Solve many targets among the same obstacles, on several threads, each as `solve` does.

The answers are the same on any number of threads, but for those that max_time strikes. Ctrl-C ends it
between targets.

Args:
    T_base_tip: The targets, shape (B, 4, 4) [m], or a dict of such by tip link.
    q0: One start for all, shape (n,), or one each, shape (B, n). None as in `solve`.
    obstacles: As in `solve`.
    threads: 0 for one per processor.

Raises:
    ValueError: As in `solve`.)")
      .def("_reach_poses", &reach_poses, py::arg("T_base_tip"), py::arg("obstacles") = py::none(),
           py::arg("threads") = 0,
           "Statuses, shape (B,), and q, shape (B, n), NaN where there is none: for reachability.")
      .def(
          "attach",
          [](SharedSolver& self, const std::string& link, const std::vector<Shape>& shapes,
             const std::vector<std::string>& may_touch) {
            self.change([&](Solver& solver) { solver.attach(link, shapes, may_touch); });
          },
          py::arg("link"), py::arg("shapes"), py::arg("may_touch") = py::tuple(),
          R"(Let a link carry solids from now on: they keep off points, shapes and the robot's other links.

They count beside what links carry already, in all calls that follow. Parts of the same body, and fingers
after it, may touch them.

Args:
    link: By name; a joint must move it.
    shapes: Their poses are in the link's frame. No half-spaces.
    may_touch: Links of the robot and shapes of scenes, by name, that they may touch.

Raises:
    ValueError: There is no such link or no joint moves it, a shape is a half-space, or its name is that of
        something carried already.)")
      .def(
          "detach",
          [](SharedSolver& self, const std::optional<std::string>& link) {
            self.change([&](Solver& solver) { link ? solver.detach(*link) : solver.detach(); });
          },
          py::arg("link") = py::none(),
          "Let a link, or without a name all of them, carry nothing any more.")
      .def("clearances", &clearances, py::arg("q"), py::arg("obstacles") = py::none(),
           R"(How near each shape, and the points if there are any, is at a configuration.

The least of them is the clearance that `judge` gives, but for what Options.touch lets touch: that depends on the
target, which is not asked for here.

Args:
    q: Joint positions, shape (n,) [rad] or [m].
    obstacles: As in `solve`.

Raises:
    ValueError: As in `solve`.)")
      .def("judge", &judge, py::arg("T_base_tip"), py::arg("q"), py::arg("obstacles") = py::none(),
           R"(Errors, clearance, limits and verdict of a configuration, by plain forward kinematics.

Args:
    T_base_tip: As in `solve`.
    q: Joint positions, shape (n,) [rad] or [m].
    obstacles: As in `solve`.

Raises:
    ValueError: As in `solve`.)");
}

}  // namespace pdoik::python
