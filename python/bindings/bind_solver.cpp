#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "arrays.hpp"
#include "bind.hpp"
#include "contacts.hpp"
#include "goals.hpp"
#include "pdoik/solver.hpp"
#include "result.hpp"
#include "scene.hpp"
#include "shared_solver.hpp"
#include "units.hpp"
#include "without_gil.hpp"

namespace pdoik::python {
namespace {

NamedResult solved(Solver& solver, const Request& request, bool derivatives,
                   Clock::time_point began) {
  Result result;
  solver.solve(request, result);
  NamedResult told = named(solver, request, std::move(result));
  if (derivatives)
    told.derivatives = solver.derivatives(request.alternative(told.goal_index), told.q);
  told.time = seconds_since(began);
  return told;
}

NamedResult solve(SharedSolver& self, const GoalsLike& T_base_tip,
                  const std::optional<ArrayLike>& q0, const std::optional<ObstaclesLike>& obstacles,
                  const std::optional<ArrayLike>& posture, const std::optional<ArrayLike>& max_step,
                  const std::optional<py::object>& lock,
                  const std::optional<py::object>& T_tip_tool,
                  const std::optional<std::string>& priority, bool derivatives) {
  const Robot& robot = self.solver.robot();
  const std::vector<Goal> goals =
      to_goals(T_base_tip, {robot, self.solver.options(), T_tip_tool, priority});
  const Asked asked(robot, q0, posture, max_step, lock);
  Request request = asked.request();
  request.goals = goals;
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point began) {
    return solved(solver, request, derivatives, began);
  });
}

NamedResult solve_any(SharedSolver& self, const py::object& goals,
                      const std::optional<ArrayLike>& costs, const std::optional<ArrayLike>& q0,
                      const std::optional<ObstaclesLike>& obstacles,
                      const std::optional<ArrayLike>& posture,
                      const std::optional<ArrayLike>& max_step,
                      const std::optional<py::object>& lock,
                      const std::optional<py::object>& T_tip_tool,
                      const std::optional<std::string>& priority, bool derivatives) {
  const Robot& robot = self.solver.robot();
  const std::vector<std::vector<Goal>> any_of =
      to_alternatives(goals, {robot, self.solver.options(), T_tip_tool, priority});
  if (any_of.empty()) throw std::invalid_argument("goals is empty, expected at least one");
  Eigen::VectorXd each;
  if (costs) each = to_vector(*costs, "costs", static_cast<Eigen::Index>(any_of.size()));
  const Asked asked(robot, q0, posture, max_step, lock);
  Request request = asked.request();
  request.any_of = any_of;
  request.costs = {each.data(), static_cast<std::size_t>(each.size())};
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point began) {
    return solved(solver, request, derivatives, began);
  });
}

NamedSolutions solve_all(SharedSolver& self, const GoalsLike& T_base_tip,
                         const std::optional<int>& limit, const std::optional<ArrayLike>& q0,
                         const std::optional<ObstaclesLike>& obstacles,
                         const std::optional<double>& distinct,
                         const std::optional<ArrayLike>& posture,
                         const std::optional<ArrayLike>& max_step,
                         const std::optional<py::object>& lock,
                         const std::optional<py::object>& T_tip_tool) {
  const Robot& robot = self.solver.robot();
  const std::vector<Goal> goals =
      to_goals(T_base_tip, {robot, self.solver.options(), T_tip_tool, std::nullopt});
  const Asked asked(robot, q0, posture, max_step, lock);
  Request request = asked.request();
  request.goals = goals;
  if (limit && *limit < 1)
    throw std::invalid_argument("limit is " + std::to_string(*limit) + ", expected at least 1");
  const AllOptions wanted{limit.value_or(0), distinct.value_or(0.0)};
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point began) {
    Solutions found = solver.solve_all(request, wanted);
    NamedSolutions all;
    for (Result& result : found.results)
      all.results.push_back(named(solver, request, std::move(result)));
    all.turns = std::move(found.turns);
    all.complete = found.complete;
    all.coverage = found.coverage;
    all.status = found.status;
    all.restarts = found.restarts;
    all.dof = solver.robot().dof();
    all.time = seconds_since(began);
    return all;
  });
}

Derivatives derivatives(SharedSolver& self, const GoalsLike& T_base_tip, const ArrayLike& q,
                        const std::optional<ObstaclesLike>& obstacles,
                        const std::optional<py::object>& T_tip_tool) {
  const std::vector<Goal> goals =
      to_goals(T_base_tip, {self.solver.robot(), self.solver.options(), T_tip_tool, std::nullopt});
  const Eigen::VectorXd configuration = to_vector(q, "q", self.solver.robot().dof());
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point) {
    return solver.derivatives(goals, configuration);
  });
}

NamedResult judge(SharedSolver& self, const GoalsLike& T_base_tip, const ArrayLike& q,
                  const std::optional<ObstaclesLike>& obstacles,
                  const std::optional<py::object>& T_tip_tool) {
  const std::vector<Goal> goals =
      to_goals(T_base_tip, {self.solver.robot(), self.solver.options(), T_tip_tool, std::nullopt});
  const Eigen::VectorXd configuration = to_vector(q, "q", self.solver.robot().dof());
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point) {
    Result result;
    solver.judge(goals, configuration, result);
    return named(solver, std::move(result));
  });
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

/// One row for all of a batch, or one for each.
class Rows {
 public:
  Rows(const std::optional<ArrayLike>& values, const std::string& name, int dof, std::size_t count,
       bool may_be_infinite = false) {
    if (!values) return;
    if (may_be_infinite) {
      const Array array = to_float64(*values, name);
      if (array.ndim() == 1) {
        rows_ = {Asked::to_step(*values, dof)};
      } else {
        for (py::ssize_t i = 0; i < array.shape(0); ++i)
          rows_.push_back(Asked::to_step({array[py::int_(i)]}, dof));
      }
    } else {
      rows_ = to_vectors(*values, name, dof);
    }
    if (rows_.size() != 1 && rows_.size() != count)
      throw std::invalid_argument(name + " has " + std::to_string(rows_.size()) +
                                  " rows, expected 1 or " + std::to_string(count));
  }
  const Eigen::VectorXd* of(std::size_t i) const {
    return rows_.empty() ? nullptr : &rows_[rows_.size() == 1 ? 0 : i];
  }

 private:
  std::vector<Eigen::VectorXd> rows_;
};

/// The locks of each of a batch: one mapping for all, or a list of them.
std::vector<std::vector<Lock>> to_locks_batch(const std::optional<py::object>& values,
                                              const Robot& robot, std::size_t count) {
  if (!values || (!py::isinstance<py::list>(*values) && !py::isinstance<py::tuple>(*values)))
    return {to_locks(values, robot)};
  std::vector<std::vector<Lock>> all;
  for (const auto& each : py::reinterpret_borrow<py::sequence>(*values))
    all.push_back(to_locks(py::reinterpret_borrow<py::object>(each), robot));
  if (all.size() != count)
    throw std::invalid_argument("lock has " + std::to_string(all.size()) +
                                " entries, expected one dict or " + std::to_string(count));
  return all;
}

BatchResult solve_batch(SharedSolver& self, const GoalsBatchLike& T_base_tip,
                        const std::optional<ArrayLike>& q0,
                        const std::optional<ObstaclesLike>& obstacles, int threads,
                        const std::optional<ArrayLike>& posture,
                        const std::optional<ArrayLike>& max_step,
                        const std::optional<py::object>& lock,
                        const std::optional<py::object>& T_tip_tool,
                        const std::optional<std::string>& priority) {
  const Robot& robot = self.solver.robot();
  const std::vector<std::vector<Goal>> goals =
      to_goals_batch(T_base_tip, {robot, self.solver.options(), T_tip_tool, priority});
  const Rows starts(q0, "q0", robot.dof(), goals.size()),
      postures(posture, "posture", robot.dof(), goals.size()),
      steps(max_step, "max_step", robot.dof(), goals.size(), true);
  const std::vector<std::vector<Lock>> locks = to_locks_batch(lock, robot, goals.size());
  std::vector<Request> requests(goals.size());
  for (std::size_t i = 0; i < goals.size(); ++i) {
    requests[i].goals = goals[i];
    requests[i].q0 = starts.of(i);
    requests[i].posture = postures.of(i);
    requests[i].max_step = steps.of(i);
    requests[i].locks = locks[locks.size() == 1 ? 0 : i];
  }
  const ObstaclesIn given(obstacles, "obstacles");
  warn_of_units(given, robot, self.told_of_units);
  BatchResult batch;
  batch.dof = robot.dof();

  const WithoutGil release;
  BatchSolver batch_solver(self);
  Solver& solver = *batch_solver;
  given.give_to(solver);
  std::size_t done = 0, slice = 128;
  do {
    const Clock::time_point started = Clock::now();
    const std::size_t count = std::min(slice, goals.size() - done);
    const auto part = std::span<const Request>(requests).subspan(done, count);
    std::vector<Result> results = solver.solve_requests(part, threads);
    for (std::size_t i = 0; i < count; ++i)
      batch.results.push_back(named(solver, part[i], std::move(results[i])));
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
  py::class_<SharedSolver> bound(module, "Solver");
  bound.def(py::init<const Robot&, const Options&>(), py::arg("robot"), py::arg("options"))
      .def_property_readonly(
          "robot", [](const SharedSolver& self) { return self.solver.robot(); },
          "A copy of the robot this solver was made for, as it was then.")
      .def("solve", &solve, py::arg("T_base_tip"), py::arg("q0") = py::none(),
           py::arg("obstacles") = py::none(), py::arg("posture") = py::none(),
           py::arg("max_step") = py::none(), py::kw_only(), py::arg("lock") = py::none(),
           py::arg("T_tip_tool") = py::none(), py::arg("priority") = py::none(),
           py::arg("derivatives") = false,
           R"(Find q so that the tips meet their goals, inside joint limits, clear of obstacles.

Balance and distance from itself are kept where the options ask for them.

Args:
    T_base_tip: The target, which takes tip points to the base frame: shape (4, 4), rigid to 1e-6 [m]; or a
        Goal, or a list of them that say whose they are; or for several tips a dict of such by tip link. Tips
        without a goal are free.
    q0: Where to start, shape (n,) [rad] or [m], moved inside the limits; answers near it are preferred.
        None for the middle of the ranges (method "paper": omega = 0), and any answer. Continuous joints'
        answers are within pi of it.
    obstacles: A Cloud; a list of Shapes; a Scene of both; or points x y z, or x y z radius, in the base frame,
        shape (N, 3) or (N, 4) [m], taken in by each call anew. Float64 in C order is read without a
        conversion. None or empty: there are none, whatever the call before had.
    posture: A configuration that the answer comes as near to as goals and constraints let it, downhill from
        the first solution found, shape (n,) [rad] or [m].
    max_step: Hard bounds on |q - q0| of each joint, shape (n,) [rad] or [m]: speed times period. Infinity
        for none.
    lock: Joints that keep a position, by name [rad] or [m].
    T_tip_tool: What of the tip has to be at the target, in the tip link's frame, shape (4, 4) [m], or by tip
        link: a tool on the flange. Of goals that do not say it themselves; None for the options'.
    priority: "position": the position first, then the orientation as near as can be, with the status
        "nearest". Of goals that do not say it themselves; None for the options'.
    derivatives: Whether the result tells how q follows the target, as `dq_dT`.

Returns:
    The result; not being able to is a status, not an exception.

Raises:
    ValueError: A shape is wrong, a target is not rigid, a link is no tip, a radius or step is negative,
        something is NaN or infinite, or there are more than 33,554,432 points. There are obstacles, or the robot
        carries something, and it has no hulls: see Options.ignore_obstacles_without_hulls.
    RuntimeError: A signal's handler asks the very solver that it has interrupted.

Warns:
    ObstacleWarning: Points are so far away, once for each solver, that they are in millimetres most likely.
    GoalWarning: q0 is outside limits; a rotation is off by rounding.)")
      .def("solve_any", &solve_any, py::arg("goals"), py::arg("costs") = py::none(),
           py::arg("q0") = py::none(), py::arg("obstacles") = py::none(), py::kw_only(),
           py::arg("posture") = py::none(), py::arg("max_step") = py::none(),
           py::arg("lock") = py::none(), py::arg("T_tip_tool") = py::none(),
           py::arg("priority") = py::none(), py::arg("derivatives") = false,
           R"(Find q for any one of many goals, a grasp set: `result.goal_index` says which.

Starts are shared among the goals. It is the first that is found; with Options.prefer "nearest" the nearest of
all to the posture or q0; with costs the cheapest that can be met.

Args:
    goals: Targets, shape (N, 4, 4) [m], or a list of whatever `solve` takes, as many as you like.
    costs: What each costs, shape (N,). None for all alike.
    q0: As all that follows, as in `solve`.

Raises:
    ValueError: As in `solve`, naming which; there is no goal.)")
      .def("solve_all", &solve_all, py::arg("T_base_tip"), py::arg("limit") = py::none(),
           py::arg("q0") = py::none(), py::arg("obstacles") = py::none(), py::kw_only(),
           py::arg("distinct") = py::none(), py::arg("posture") = py::none(),
           py::arg("max_step") = py::none(), py::arg("lock") = py::none(),
           py::arg("T_tip_tool") = py::none(),
           R"(Find all distinct solutions, the nearest first.

Of arms of six joints with a wrist whose axes meet behind two parallel axes, or with three parallel axes
(most industrial arms, UR), all that there are, by closed form and confirmed, and `complete` says so. Of others
those that starts find until there are `limit`, max_time strikes or nothing new comes.

Args:
    T_base_tip: As in `solve`.
    limit: No more than this many. None for no limit: for redundant arms max_time is one.
    q0: What they are sorted by the distance to, as in `solve`.
    obstacles: As in `solve`; solutions are clear of them.
    distinct: Two differ if a joint does by more than this [rad] or [m]. None for 0.001 where they are known in
        closed form and 0.1 else.
    posture: What they are sorted by instead of q0, as all that follows as in `solve`.

Raises:
    ValueError: As in `solve`; limit or distinct is out of range.)")
      .def("derivatives", &derivatives, py::arg("T_base_tip"), py::arg("q"),
           py::arg("obstacles") = py::none(), py::kw_only(), py::arg("T_tip_tool") = py::none(),
           R"(How a configuration follows its targets, and how near it is to a singularity.

Args:
    T_base_tip: As in `solve`.
    q: Joint positions that meet it, shape (n,) [rad] or [m].
    obstacles: As in `solve`: what touches stays as far.

Raises:
    ValueError: As in `solve`.)")
      .def("solve_batch", &solve_batch, py::arg("T_base_tip"), py::arg("q0") = py::none(),
           py::arg("obstacles") = py::none(), py::arg("threads") = 0, py::kw_only(),
           py::arg("posture") = py::none(), py::arg("max_step") = py::none(),
           py::arg("lock") = py::none(), py::arg("T_tip_tool") = py::none(),
           py::arg("priority") = py::none(),
           R"(Solve many targets among the same obstacles, on several threads, each as `solve` does.

The answers are the same on any number of threads, but for those that max_time strikes. Ctrl-C ends it
between targets.

Args:
    T_base_tip: The targets, shape (B, 4, 4) [m], or a dict of such by tip link; or a list of B of whatever
        `solve` takes, of any kinds.
    q0: One start for all, shape (n,), or one each, shape (B, n). None as in `solve`.
    obstacles: As in `solve`.
    threads: 0 for one per processor.
    posture: As in `solve`, one for all or one each, shape (B, n).
    max_step: As in `solve`, one for all or one each, shape (B, n).
    lock: As in `solve`, one dict for all or a list of B.
    T_tip_tool: As in `solve`, for all.
    priority: As in `solve`, for all.

Raises:
    ValueError: As in `solve`.)")
      .def("_reach_poses", &reach_poses, py::arg("T_base_tip"), py::arg("obstacles") = py::none(),
           py::arg("threads") = 0,
           "Statuses, shape (B,), and q, shape (B, n), NaN where there is none: for reachability.")
      .def(
          "attach",
          [](SharedSolver& self, const Holders& link, const std::vector<Shape>& shapes,
             const std::vector<std::string>& may_touch, const std::vector<ContactRule>& contacts) {
            const Attachment thing = to_attachment(link, shapes, may_touch, contacts);
            self.change([&](Solver& solver) { solver.attach({&thing, 1}); });
          },
          py::arg("link"), py::arg("shapes"), py::arg("may_touch") = py::tuple(),
          py::arg("contacts") = py::tuple(),
          R"(Let a link carry solids from now on: they keep off points, shapes and the robot's other links.

They count beside what links carry already, in all calls that follow. Parts of the same body, and fingers
after it, may touch them.

Args:
    link: By name; a joint must move it. Or several that hold them: they move with the first, and all of them, with
        what is rigid to them and their fingers, may touch them. That the others stay where they hold them is for
        goals to say (Goal.relative_to).
    shapes: Their poses are in the (first) link's frame. No half-spaces; meshes as convex pieces.
    may_touch: Links of the robot, shapes of scenes, what else is carried, and "points", by name or pattern, that
        they may touch. They need not be there.
    contacts: Rules of contact that count while they are carried, after a scene's. Their names need not be there.

Raises:
    ValueError: There is no such link or no joint moves it, a shape is a half-space, or its name is that of
        something carried already.)")
      .def(
          "attach_all",
          [](SharedSolver& self, const std::vector<Attachment>& things) {
            self.change([&](Solver& solver) { solver.attach(things); });
          },
          py::arg("things"),
          R"(`attach` for several at once: all of them, or none if any cannot be carried.

Args:
    things: What each call would get; `carried` of another solver, say.

Raises:
    ValueError: As `attach`.)")
      .def(
          "detach",
          [](SharedSolver& self, const std::optional<std::string>& name) {
            self.change([&](Solver& solver) { name ? solver.detach(*name) : solver.detach(); });
          },
          py::arg("name") = py::none(),
          R"(Let a link carry nothing any more, or nobody carry an object any more, or nobody anything.

Args:
    name: Of a link: what moves with another link that holds it too stays with that. Or of what is carried, of
        an object with all its pieces. None for everything.

Raises:
    ValueError: Nothing has this name.)")
      .def_property_readonly(
          "carried",
          [](SharedSolver& self) {
            const WithoutGil release;
            const SharedSolver::Turn turn(self);
            return self.solver.attached();
          },
          "What links carry, as it was attached.")
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
           py::kw_only(), py::arg("T_tip_tool") = py::none(),
           R"(Errors, clearance, limits and verdict of a configuration, by plain forward kinematics.

Args:
    T_base_tip: As in `solve`.
    q: Joint positions, shape (n,) [rad] or [m].
    obstacles: As in `solve`.

Raises:
    ValueError: As in `solve`.)");
  bind_paths(module, bound);
}

}  // namespace pdoik::python
