#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "arrays.hpp"
#include "errors.hpp"
#include "goals.hpp"
#include "pdoik/solver.hpp"
#include "scene.hpp"
#include "units.hpp"
#include "without_gil.hpp"

namespace pdoik::python {

namespace py = pybind11;

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

/// What one call asks besides goals, kept while it runs.
class Asked {
 public:
  Asked(const Robot& robot, const std::optional<ArrayLike>& q0,
        const std::optional<ArrayLike>& posture, const std::optional<ArrayLike>& max_step,
        const std::optional<py::object>& lock)
      : locks_(to_locks(lock, robot)) {
    if (q0) q0_ = to_vector(*q0, "q0", robot.dof());
    if (posture) posture_ = to_vector(*posture, "posture", robot.dof());
    if (max_step) max_step_ = to_step(*max_step, robot.dof());
    if (q0_) warn_of_start(*q0_, robot);
  }
  Request request() const {
    const auto address = [](const std::optional<Eigen::VectorXd>& v) { return v ? &*v : nullptr; };
    Request request;
    request.q0 = address(q0_);
    request.posture = address(posture_);
    request.max_step = address(max_step_);
    request.locks = locks_;
    return request;
  }

  /// Infinity is a step of any size.
  static Eigen::VectorXd to_step(const ArrayLike& values, int dof) {
    const Array array = to_float64(values, "max_step");
    if (array.ndim() != 1 || array.shape(0) != dof) return to_vector(values, "max_step", dof);
    const Eigen::Map<const Eigen::VectorXd> step(array.data(), dof);
    if (step.hasNaN()) throw std::invalid_argument("max_step holds NaN or is negative");
    return step;
  }
  static void warn_of_start(const Eigen::VectorXd& q0, const Robot& robot) {
    for (Eigen::Index i = 0; i < q0.size(); ++i) {
      const double beyond = std::max(robot.lower()[i] - q0[i], q0[i] - robot.upper()[i]);
      if (!(beyond > kBeyondLimit)) continue;
      warn_of_goal(py::str("q0 has {:.4g} for {}, {:.2g} beyond its limit: it starts at the limit")
                       .format(q0[i], robot.joint_names()[static_cast<std::size_t>(i)], beyond)
                       .cast<std::string>());
      return;
    }
  }

 private:
  /// A measured start may be beyond a limit by a sensor's error [rad] or [m].
  static constexpr double kBeyondLimit = 1e-2;
  std::optional<Eigen::VectorXd> q0_, posture_, max_step_;
  std::vector<Lock> locks_;
};

using Clock = std::chrono::steady_clock;

/// Have the solver do something for one call: without the GIL, in its turn, Ctrl-C heard.
/// @param does  Of the solver, and of when its turn came: what the obstacles take is after that.
template <class Does>
auto in_turn(SharedSolver& self, const std::optional<ObstaclesLike>& obstacles, Does&& does) {
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, self.solver.robot(), self.told_of_units);
  auto done = [&] {
    const WithoutGil release;
    const SharedSolver::Turn turn(self);
    const Clock::time_point began = Clock::now();
    given.give_to(self.solver);
    return does(self.solver, began);
  }();
  if (PyErr_Occurred() != nullptr) throw py::error_already_set();  // Ctrl-C ended it
  return done;
}

inline double seconds_since(Clock::time_point began) {
  return std::chrono::duration<double>(Clock::now() - began).count();
}

/// The solver's methods for paths and moves.
void bind_paths(py::module_& module, py::class_<SharedSolver>& bound);

}  // namespace pdoik::python
