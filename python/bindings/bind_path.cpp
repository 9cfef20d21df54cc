#include <pybind11/stl.h>
#include <pybind11/typing.h>

#include <map>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "goals.hpp"
#include "pdoik/path.hpp"
#include "result.hpp"
#include "shared_solver.hpp"

namespace pdoik::python {
namespace {

using PathStatusName =
    py::typing::Literal<"'whole'", "'pieces'", "'impossible'", "'not_found'", "'time_limit'">;
using MotionStatusName =
    py::typing::Literal<"'solved'", "'blocked_start'", "'blocked_goal'", "'time_limit'">;

/// What a path's result says, in Python's words.
struct NamedPath : PathResult {
  std::string message;
  std::vector<std::string> reasons;  ///< of each end
};

struct NamedEnd {
  double at;
  Eigen::VectorXd q;
  std::string reason;
};

struct NamedMotion : MotionResult {
  std::string reason;
};

PathCosts to_costs(const std::optional<std::map<std::string, double>>& values) {
  PathCosts costs;
  if (!values) return costs;
  const std::map<std::string, double PathCosts::*> known = {
      {"motion", &PathCosts::motion},
      {"limits", &PathCosts::limits},
      {"obstacles", &PathCosts::obstacles},
      {"singularities", &PathCosts::singularities},
      {"room", &PathCosts::room}};
  for (const auto& [name, weight] : *values) {
    const auto found = known.find(name);
    if (found == known.end())
      throw std::invalid_argument("costs has '" + name +
                                  "', expected motion, limits, obstacles, singularities or room");
    costs.*(found->second) = weight;
  }
  return costs;
}

NamedPath solve_path(SharedSolver& self, const GoalsBatchLike& stations,
                     const std::optional<ObstaclesLike>& obstacles,
                     const std::optional<ArrayLike>& start, const std::optional<ArrayLike>& end,
                     bool closed, const std::optional<py::object>& lock,
                     const std::optional<py::object>& T_tip_tool, double max_time,
                     double position_tolerance, double rotation_tolerance, double max_joint_step,
                     const std::optional<std::map<std::string, double>>& costs, bool reconfigure) {
  const Robot& robot = self.solver.robot();
  const std::vector<std::vector<Goal>> goals =
      to_goals_batch(stations, {robot, self.solver.options(), T_tip_tool, std::nullopt});
  std::optional<Eigen::VectorXd> first, last;
  if (start) first = to_vector(*start, "start", robot.dof());
  if (end) last = to_vector(*end, "end", robot.dof());
  const std::vector<Lock> locks = to_locks(lock, robot);
  PathRequest request;
  request.stations = goals;
  request.start = first ? &*first : nullptr;
  request.end = last ? &*last : nullptr;
  request.closed = closed;
  request.locks = locks;
  PathOptions options;
  options.max_time = max_time;
  options.position_tolerance = position_tolerance;
  options.rotation_tolerance = rotation_tolerance;
  options.max_joint_step = max_joint_step;
  options.costs = to_costs(costs);
  options.reconfigure = reconfigure;
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point began) {
    NamedPath path{solver.solve_path(request, options), {}, {}};
    path.message = solver.explain(request, path);
    for (const PathEnd& each : path.ends) path.reasons.push_back(solver.explain(each));
    path.time = seconds_since(began);
    return path;
  });
}

/// Whether what is given is a goal or a pose, and no list of them.
bool is_one_goal(const py::object& goals) {
  if (py::isinstance<py::list>(goals) || py::isinstance<py::tuple>(goals)) return false;
  return !py::hasattr(goals, "ndim") || goals.attr("ndim").cast<int>() == 2;
}
py::list listed(const py::object& goal) {
  py::list one;
  one.append(goal);
  return one;
}

NamedMotion plan_motion(SharedSolver& self, const ArrayLike& q_from,
                        const std::optional<py::object>& goals,
                        const std::optional<ArrayLike>& q_to,
                        const std::optional<ObstaclesLike>& obstacles,
                        const std::optional<py::object>& lock,
                        const std::optional<py::object>& T_tip_tool, double max_time,
                        int goal_count, bool shorten) {
  const Robot& robot = self.solver.robot();
  const Eigen::VectorXd from = to_vector(q_from, "q_from", robot.dof());
  std::optional<Eigen::VectorXd> to;
  if (q_to) to = to_vector(*q_to, "q_to", robot.dof());
  std::vector<std::vector<Goal>> any_of;
  if (goals)
    any_of = to_alternatives(is_one_goal(*goals) ? py::object(listed(*goals)) : *goals,
                             {robot, self.solver.options(), T_tip_tool, std::nullopt});
  const std::vector<Lock> locks = to_locks(lock, robot);
  MotionRequest request;
  request.from = &from;
  request.to = to ? &*to : nullptr;
  request.any_of = any_of;
  request.locks = locks;
  MotionOptions options;
  options.max_time = max_time;
  options.goal_count = goal_count;
  options.shorten = shorten;
  return in_turn(self, obstacles, [&](Solver& solver, Clock::time_point began) {
    NamedMotion motion{solver.plan_motion(request, options), {}};
    if (motion.status == MotionStatus::BlockedStart || motion.status == MotionStatus::BlockedGoal)
      motion.reason = solver.describe(motion.at_fault.worst);
    motion.time = seconds_since(began);
    return motion;
  });
}

using Pieces = std::vector<std::pair<int, int>>;

void bind_path_end(py::module_& module) {
  py::class_<NamedEnd>(module, "PathEnd", "Where a motion along a path ends, and against what.")
      .def_readonly(
          "at", &NamedEnd::at,
          "Where on the path, in stations; or the first of some stations without a solution.")
      .def_property_readonly(
          "q", [](const NamedEnd& e) { return e.q; },
          "The last configuration on it, or what comes nearest to that station, shape (n,).")
      .def_readonly("reason", &NamedEnd::reason, "What a step further runs into.")
      .def("__repr__", [](const NamedEnd& e) {
        return py::str("<PathEnd at {:.2f}: {}>").format(e.at, e.reason);
      });
}

void bind_result_of_path(py::module_& module) {
  using P = NamedPath;
  py::class_<P>(module, "PathResult", "The outcome of a whole path: see Solver.solve_path.")
      .def_property_readonly(
          "success", [](const P& p) { return p.status == PathStatus::Whole; },
          "Whether one motion meets all of the path.")
      .def_property_readonly(
          "status",
          [](const P& p) {
            return py::reinterpret_borrow<PathStatusName>(py::str(to_string(p.status)));
          },
          R"(What became of it.

`whole`: one motion; `pieces`: several, with moves between them where these were found; `impossible`: none, since all
solutions of the stations are known and none goes on; `not_found`; `time_limit`.)")
      .def_readonly("message", &P::message, "How it went, for people.")
      .def_property_readonly(
          "q", [](const P& p) -> RowMatrix { return p.q; },
          "Configurations one after the other, joined by straight lines, shape (m, n) [rad] or "
          "[m]. Of several pieces all.")
      .def_property_readonly(
          "at", [](const P& p) { return p.at; },
          "Where on the path each row is: 2.5 is half way from station 2 to 3, shape (m,).")
      .def_property_readonly(
          "pieces",
          [](const P& p) {
            Pieces pieces;
            for (const PathPiece& each : p.pieces) pieces.emplace_back(each.first, each.last + 1);
            return pieces;
          },
          "The rows of each piece, [first, end): one, if the path is whole.")
      .def_property_readonly(
          "moves",
          [](const P& p) {
            std::vector<RowMatrix> moves;
            for (std::size_t k = 0; k + 1 < p.pieces.size(); ++k)
              moves.emplace_back(p.moves.middleRows(
                  p.pieces[k].first_move, p.pieces[k].last_move - p.pieces[k].first_move + 1));
            return moves;
          },
          "Clear moves from each piece to the next, corners joined by straight lines, shape (k, n) "
          "each; without rows where none was found.")
      .def_property_readonly(
          "ends",
          [](const P& p) {
            std::vector<NamedEnd> ends;
            for (std::size_t k = 0; k < p.ends.size(); ++k)
              ends.push_back({p.ends[k].at, p.ends[k].q, p.reasons[k]});
            return ends;
          },
          "Where it breaks: how far motions get at the place that fewest get beyond, and what ends "
          "them, one for each reason.")
      .def_readonly("unsolved", &P::unsolved, "Stations for which no solution was found.")
      .def_readonly("complete", &P::complete,
                    "Of a path that is not whole: whether all solutions where it breaks are known.")
      .def_readonly(
          "length", &P::length,
          "How far joints go: the sum of the norms of the steps from row to row [rad] or [m].")
      .def_readonly("clearance", &P::clearance,
                    "Least of all rows; beyond 0.6 m it is told as that much [m].")
      .def_readonly("self_distance", &P::self_distance, "The same of links among themselves [m].")
      .def_readonly("largest_step", &P::largest_step,
                    "Of a joint, from one station to the next [rad] or [m].")
      .def_readonly("position_error", &P::position_error, "Largest at stations [m].")
      .def_readonly("rotation_error", &P::rotation_error, "Largest at stations [rad].")
      .def_readonly("time", &P::time, "Taking in the obstacles included [s].")
      .def("__repr__", [](const P& p) {
        return py::str("<PathResult {}: {}, {:.3g} ms>")
            .format(to_string(p.status), p.message, 1e3 * p.time);
      });
}

void bind_result_of_motion(py::module_& module) {
  using M = NamedMotion;
  py::class_<M>(module, "MotionResult", "The outcome of a move: see Solver.plan_motion.")
      .def_property_readonly(
          "success", [](const M& m) { return m.status == MotionStatus::Solved; },
          "Whether it is there.")
      .def_property_readonly(
          "status",
          [](const M& m) {
            return py::reinterpret_borrow<MotionStatusName>(py::str(to_string(m.status)));
          },
          R"(What became of it.

`solved`; `blocked_start`: it would begin in something or outside limits; `blocked_goal`: no configuration that meets a
goal is clear; `time_limit`: none was found.)")
      .def_property_readonly(
          "q", [](const M& m) -> RowMatrix { return m.q; },
          "Corners of the way, joined by straight lines, shape (m, n) [rad] or [m].")
      .def_property_readonly(
          "goal_index",
          [](const M& m) -> std::optional<int> {
            return m.goal_index < 0 ? std::nullopt : std::optional(m.goal_index);
          },
          "Which of the goals it ends at, or None.")
      .def_readonly("length", &M::length,
                    "How far joints go: the sum of the norms of its steps [rad] or [m].")
      .def_readonly("reason", &M::reason, "What blocks its start or its goals, or ''.")
      .def_readonly("checks", &M::checks, "Looks at a configuration.")
      .def_readonly("time", &M::time, "Taking in the obstacles included [s].")
      .def("__repr__", [](const M& m) {
        return py::str("<MotionResult {}: {} corners, {:.3g} rad, {:.3g} ms>")
            .format(to_string(m.status), m.q.rows(), m.length, 1e3 * m.time);
      });
}

}  // namespace

void bind_paths(py::module_& module, py::class_<SharedSolver>& bound) {
  bind_path_end(module);
  bind_result_of_path(module);
  bind_result_of_motion(module);
  const PathOptions path;
  const MotionOptions motion;
  bound
      .def("solve_path", &solve_path, py::arg("stations"), py::arg("obstacles") = py::none(),
           py::kw_only(), py::arg("start") = py::none(), py::arg("end") = py::none(),
           py::arg("closed") = false, py::arg("lock") = py::none(),
           py::arg("T_tip_tool") = py::none(), py::arg("max_time") = path.max_time,
           py::arg("position_tolerance") = path.position_tolerance,
           py::arg("rotation_tolerance") = path.rotation_tolerance,
           py::arg("max_joint_step") = path.max_joint_step, py::arg("costs") = py::none(),
           py::arg("reconfigure") = path.reconfigure,
           R"(Follow a whole path: a seam, a spray path, a scan.

One motion meets all stations one after the other and the straight way between them, turning evenly, clear of
everything all along; the shortest that is found. Where there is none, `ends` says where it breaks and why, and the
answer is as few pieces as can be found, with clear moves between them.

Args:
    stations: Shape (N, 4, 4) [m], or a list of whatever `solve` takes, all of the same kind: poses, regions with a
        free axis, a hand in the frame of the other. At least two, none soft, no two alike in a row.
    obstacles: As in `solve`.
    start: Joints at the first station, shape (n,) [rad] or [m]. None: any.
    end: Joints at the last station, shape (n,). None: any.
    closed: Whether it goes on from the last station to the first, and ends where it began.
    lock: As in `solve`.
    T_tip_tool: As in `solve`.
    max_time: For all of it [s].
    position_tolerance: How far the tool may be off between stations [m]. At stations the goals' own hold.
    rotation_tolerance: The same of how it is turned [rad].
    max_joint_step: Largest step of a joint from one row of the answer to the next [rad] or [m].
    costs: What is least of all whole paths that are found: weights of `motion` (1), `limits`, `obstacles`,
        `singularities` (0), and `room`, from which on contact and singularities are far [m].
    reconfigure: Whether what cannot be one motion may be several.

Raises:
    ValueError: As in `solve`, naming the station; fewer than two stations, two alike in a row or of different kinds;
        a start or end outside limits or that does not meet its station; an option is out of range.)")
      .def(
          "plan_motion", &plan_motion, py::arg("q_from"), py::arg("goals") = py::none(),
          py::arg("q_to") = py::none(), py::arg("obstacles") = py::none(), py::kw_only(),
          py::arg("lock") = py::none(), py::arg("T_tip_tool") = py::none(),
          py::arg("max_time") = motion.max_time, py::arg("goal_count") = motion.goal_count,
          py::arg("shorten") = motion.shorten,
          R"(Move from a configuration to another, or to any of some goals, clear of everything all along.

Two trees grow towards each other (RRT-Connect, Kuffner and LaValle) on ways that are swept by intervals, then detours
are taken out.

Args:
    q_from: Where joints are, shape (n,) [rad] or [m].
    goals: One as in `solve`, or many as in `solve_any`: whichever can be had.
    q_to: Instead of goals: where joints are to be, shape (n,).
    obstacles: As in `solve`.
    lock: As in `solve`.
    T_tip_tool: As in `solve`.
    max_time: [s].
    goal_count: So many configurations that meet goals are led to, at most.
    shorten: Whether detours are taken out.

Raises:
    ValueError: As in `solve_any`; neither or both of goals and q_to; an option is out of range.)");
}

}  // namespace pdoik::python
