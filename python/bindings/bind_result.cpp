#include <pybind11/stl.h>

#include <optional>

#include "arrays.hpp"
#include "bind.hpp"
#include "errors.hpp"
#include "names.hpp"
#include "result.hpp"

namespace pdoik::python {
namespace {

using AnyTuple = py::typing::Tuple<py::object, py::ellipsis>;

StatusName status_name(const NamedResult& result) {
  return py::reinterpret_borrow<StatusName>(py::str(to_string(result.status)));
}

/// One number of each result, shape (B,).
template <class Value, class Read>
py::array_t<Value> column(const BatchResult& batch, Read read) {
  py::array_t<Value> values(static_cast<py::ssize_t>(batch.results.size()));
  Value* next = values.mutable_data();
  for (const NamedResult& result : batch.results) *next++ = read(result);
  return values;
}

template <class Read>
StrArray str_column(const BatchResult& batch, Read read) {
  py::list values;
  for (const NamedResult& result : batch.results) values.append(to_str(read(result)));
  return py::reinterpret_borrow<StrArray>(
      py::module_::import("numpy").attr("array")(values, "str"));
}

RowMatrix configurations(const BatchResult& batch) {
  RowMatrix q(static_cast<Eigen::Index>(batch.results.size()), batch.dof);
  for (Eigen::Index i = 0; i < q.rows(); ++i)
    q.row(i) = batch.results[static_cast<std::size_t>(i)].q.transpose();
  return q;
}

std::string repr(const NamedResult& r) {
  return py::str(
             "<Result {}: position_error={:.3g} m, rotation_error={:.3g} rad, clearance={:.3g} m, "
             "worst={}, iterations={}, restarts={}, time={:.3g} ms>")
      .format(to_string(r.status), r.position_error, r.rotation_error, r.clearance,
              r.worst_constraint, r.iterations, r.restarts, 1e3 * r.time);
}

std::string batch_repr(const BatchResult& batch) {
  std::size_t solved = 0;
  for (const NamedResult& result : batch.results) solved += result.success ? 1 : 0;
  return py::str("<BatchResult: {} of {} solved>").format(solved, batch.results.size());
}

AnyTuple result_state(const NamedResult& r) {
  return py::make_tuple(r.q, r.success, static_cast<int>(r.status), r.position_error,
                        r.rotation_error, r.clearance, r.limit_violation, r.worst.violation,
                        r.worst_constraint, r.iterations, r.evaluations, r.restarts, r.time,
                        r.center_of_mass, r.balance_violation, r.self_distance, r.intake,
                        r.late_evaluations, r.goal_index, r.holds, r.message, r.room, r.self_room);
}

NamedResult from_state(const AnyTuple& t) {
  if (t.size() != 23) throw py::value_error("a Result that another version of pdoik pickled");
  NamedResult r;
  r.q = t[0].cast<Eigen::VectorXd>();
  r.success = t[1].cast<bool>();
  r.status = static_cast<Status>(t[2].cast<int>());
  r.position_error = t[3].cast<double>();
  r.rotation_error = t[4].cast<double>();
  r.clearance = t[5].cast<double>();
  r.limit_violation = t[6].cast<double>();
  r.worst.violation = t[7].cast<double>();
  r.worst_constraint = t[8].cast<std::string>();
  r.iterations = t[9].cast<int>();
  r.evaluations = t[10].cast<int>();
  r.restarts = t[11].cast<int>();
  r.time = t[12].cast<double>();
  r.center_of_mass = t[13].cast<Eigen::Vector3d>();
  r.balance_violation = t[14].cast<double>();
  r.self_distance = t[15].cast<double>();
  r.intake = t[16].cast<double>();
  r.late_evaluations = t[17].cast<int>();
  r.goal_index = t[18].cast<int>();
  r.holds = t[19].cast<bool>();
  r.message = t[20].cast<std::string>();
  r.room = t[21].cast<double>();
  r.self_room = t[22].cast<double>();
  return r;
}

void bind_one(py::module_& module) {
  using R = NamedResult;
  py::class_<R>(module, "Result", R"(The outcome of one solve.

Every error is recomputed from q alone, so that a success can be judged without trusting the solver.)")
      .def_property_readonly(
          "q", [](const R& r) { return r.q; }, "Joint positions, shape (n,) [rad] or [m].")
      .def_readonly("success", &R::success, "Goal, limits and clearance hold to their tolerances.")
      .def_property_readonly("status", &status_name, R"(Why the solve ended.

`solved`; `time_limit`: max_time struck first; `exhausted`: every start ended in a local minimum;
`out_of_reach`: the target lies farther from the arm's root than its links stretch, or no joint moves its
tip; `base_collision`: an obstacle lies in a hull that no joint moves, and no answer exists; `blocked`: what is
rigid to the tip is in an obstacle at the target, and no answer exists, or some fifty starts that reached the
target all ended with the same hull in the same obstacle, and none is likely; `nearest`: position and all
constraints hold, and of a goal whose position comes first the orientation is as near as was found. In all but
the first, q is the best found.)")
      .def_readonly("message", &R::message,
                    "How it went, in words: what gave, by how much, and what its tolerance is; '' "
                    "of `judge` and steps.")
      .def_readonly("goal_index", &R::goal_index,
                    "Which of the goals of `solve_any` it meets, or comes nearest to.")
      .def_property_readonly(
          "dq_dT",
          [](const R& r) -> std::optional<Eigen::MatrixXd> {
            if (!r.derivatives) return std::nullopt;
            return r.derivatives->dq_dT;
          },
          "How q follows its targets, shape (n, 6) a goal: see Derivatives. None unless "
          "`derivatives=True`.")
      .def_property_readonly(
          "manipulability",
          [](const R& r) -> std::optional<double> {
            if (!r.derivatives) return std::nullopt;
            return r.derivatives->manipulability;
          },
          "See Derivatives. None unless `derivatives=True`.")
      .def_property_readonly(
          "singular_distance",
          [](const R& r) -> std::optional<double> {
            if (!r.derivatives) return std::nullopt;
            return r.derivatives->singular_distance;
          },
          "See Derivatives [m]. None unless `derivatives=True`.")
      .def_readonly("position_error", &R::position_error, "Largest over the goals [m].")
      .def_readonly(
          "rotation_error", &R::rotation_error,
          "Largest over the goals [rad]; of the axis for axis goals, 0 for position goals.")
      .def_readonly("clearance", &R::clearance,
                    "Least distance from an obstacle (a point less its radius, a shape) to a hull "
                    "or what is carried, but for contact that does not count: negative inside, "
                    "infinite without obstacles or hulls [m].")
      .def_readonly("room", &R::room,
                    "Least of what distances from obstacles are beyond what is wanted of each "
                    "pair, negative where one is nearer: without rules of contact clearance less "
                    "Options.clearance [m].")
      .def_readonly("self_room", &R::self_room, "The same of what self_distance is of [m].")
      .def_readonly("limit_violation", &R::limit_violation, "Largest over the joints [rad] or [m].")
      .def_property_readonly(
          "center_of_mass", [](const R& r) { return r.center_of_mass; },
          "In the base frame, shape (3,) [m]; zero where balance is not asked for.")
      .def_readonly("balance_violation", &R::balance_violation,
                    "How far the centre of mass is outside its region, 0 inside [m].")
      .def_readonly("self_distance", &R::self_distance,
                    "Least distance between hulls of links that are not adjacent, where "
                    "self_collision is asked for: of the capsules that hold them, never more than "
                    "that of the hulls [m].")
      .def_readonly("worst_constraint", &R::worst_constraint,
                    "What is missed by most, or comes nearest to that.")
      .def_property_readonly(
          "worst_violation", [](const R& r) { return r.worst.violation; },
          "By how much the worst constraint is missed beyond its tolerance, at most 0 if it holds "
          "[m] or [rad].")
      .def_readonly("iterations", &R::iterations, "Of the inner minimisers, in all.")
      .def_readonly("evaluations", &R::evaluations, "Forward kinematics computed, in all.")
      .def_readonly("restarts", &R::restarts, "Starts beyond the first.")
      .def_readonly("time", &R::time, "Of the solve, taking in the obstacles included [s].")
      .def_readonly("intake", &R::intake,
                    "Of that, what taking the obstacles in took: it is not in max_time [s].")
      .def_readonly("late_evaluations", &R::late_evaluations,
                    "Evaluations and looks at all obstacles begun after max_time had struck: the "
                    "verdict takes one.")
      .def("__repr__", &repr)
      .def(py::pickle(&result_state, &from_state));
}

void bind_batch(py::module_& module) {
  using B = BatchResult;
  using R = NamedResult;
  py::class_<B>(module, "BatchResult",
                R"(The outcomes of a batch: a sequence of Result whose fields are columns too.

A column is a new array each time it is asked for.)")
      .def_property_readonly("q", &configurations, "Joint positions, shape (B, n) [rad] or [m].")
      .def_property_readonly(
          "success",
          [](const B& b) { return column<bool>(b, [](const R& r) { return r.success; }); },
          "Shape (B,).")
      .def_property_readonly(
          "status",
          [](const B& b) {
            return str_column(b, [](const R& r) { return std::string(to_string(r.status)); });
          },
          "Shape (B,).")
      .def_property_readonly(
          "position_error",
          [](const B& b) { return column<double>(b, [](const R& r) { return r.position_error; }); },
          "Shape (B,) [m].")
      .def_property_readonly(
          "rotation_error",
          [](const B& b) { return column<double>(b, [](const R& r) { return r.rotation_error; }); },
          "Shape (B,) [rad].")
      .def_property_readonly(
          "clearance",
          [](const B& b) { return column<double>(b, [](const R& r) { return r.clearance; }); },
          "Shape (B,) [m].")
      .def_property_readonly(
          "limit_violation",
          [](const B& b) {
            return column<double>(b, [](const R& r) { return r.limit_violation; });
          },
          "Shape (B,) [rad] or [m].")
      .def_property_readonly(
          "balance_violation",
          [](const B& b) {
            return column<double>(b, [](const R& r) { return r.balance_violation; });
          },
          "Shape (B,) [m].")
      .def_property_readonly(
          "self_distance",
          [](const B& b) { return column<double>(b, [](const R& r) { return r.self_distance; }); },
          "Shape (B,) [m].")
      .def_property_readonly(
          "message", [](const B& b) { return str_column(b, [](const R& r) { return r.message; }); },
          "Shape (B,).")
      .def_property_readonly(
          "worst_constraint",
          [](const B& b) { return str_column(b, [](const R& r) { return r.worst_constraint; }); },
          "Shape (B,).")
      .def_property_readonly(
          "worst_violation",
          [](const B& b) {
            return column<double>(b, [](const R& r) { return r.worst.violation; });
          },
          "Shape (B,) [rad] or [m].")
      .def_property_readonly(
          "iterations",
          [](const B& b) { return column<int>(b, [](const R& r) { return r.iterations; }); },
          "Shape (B,).")
      .def_property_readonly(
          "evaluations",
          [](const B& b) { return column<int>(b, [](const R& r) { return r.evaluations; }); },
          "Shape (B,).")
      .def_property_readonly(
          "restarts",
          [](const B& b) { return column<int>(b, [](const R& r) { return r.restarts; }); },
          "Shape (B,).")
      .def_property_readonly(
          "time", [](const B& b) { return column<double>(b, [](const R& r) { return r.time; }); },
          "Shape (B,) [s].")
      .def_property_readonly(
          "late_evaluations",
          [](const B& b) { return column<int>(b, [](const R& r) { return r.late_evaluations; }); },
          "Shape (B,).")
      .def("__len__", [](const B& b) { return b.results.size(); })
      .def(
          "__getitem__",
          [](const B& b, py::ssize_t i) {
            const auto size = static_cast<py::ssize_t>(b.results.size());
            if (i < -size || i >= size)
              throw py::index_error("result " + std::to_string(i) + " of " + std::to_string(size));
            return b.results[static_cast<std::size_t>(i < 0 ? i + size : i)];
          },
          py::arg("index"))
      .def(
          "__iter__",
          [](const B& b) { return py::make_iterator(b.results.begin(), b.results.end()); },
          py::keep_alive<0, 1>())
      .def("__repr__", &batch_repr);
}

void bind_solutions(py::module_& module) {
  using S = NamedSolutions;
  py::class_<S>(
      module, "Solutions",
      R"(The distinct solutions of one request: a sequence of Result, the nearest first.)")
      .def_property_readonly(
          "q",
          [](const S& s) {
            RowMatrix q(static_cast<Eigen::Index>(s.results.size()), s.dof);
            for (Eigen::Index i = 0; i < q.rows(); ++i)
              q.row(i) = s.results[static_cast<std::size_t>(i)].q.transpose();
            return q;
          },
          "Joint positions, shape (K, n) [rad] or [m].")
      .def_readonly("turns", &S::turns,
                    "In how many ways whole turns of joints leave each inside limits, 1 if in none "
                    "but itself, K ints.")
      .def_readonly("complete", &S::complete,
                    "Whether it is known that there are no others: of six joints whose geometry is "
                    "solved in closed form, away from singularities.")
      .def_readonly("coverage", &S::coverage,
                    "How likely it is that one more start that meets the goals comes to what was "
                    "found already, clear or not; 1 where it is complete.")
      .def_property_readonly(
          "status",
          [](const S& s) {
            return py::reinterpret_borrow<StatusName>(py::str(to_string(s.status)));
          },
          "'solved' if there are any, else why not.")
      .def_readonly("restarts", &S::restarts, "Starts beyond the first.")
      .def_readonly("time", &S::time, "[s].")
      .def("__len__", [](const S& s) { return s.results.size(); })
      .def(
          "__getitem__",
          [](const S& s, py::ssize_t i) {
            const auto size = static_cast<py::ssize_t>(s.results.size());
            if (i < -size || i >= size)
              throw py::index_error("solution " + std::to_string(i) + " of " +
                                    std::to_string(size));
            return s.results[static_cast<std::size_t>(i < 0 ? i + size : i)];
          },
          py::arg("index"))
      .def(
          "__iter__",
          [](const S& s) { return py::make_iterator(s.results.begin(), s.results.end()); },
          py::keep_alive<0, 1>())
      .def("__repr__", [](const S& s) {
        return py::str("<Solutions: {}{}, coverage={:.3g}>")
            .format(s.results.size(), s.complete ? ", all there are" : "", s.coverage);
      });
  py::class_<Derivatives>(module, "Derivatives",
                          "How a configuration follows its targets, and how near it is to a "
                          "singularity.")
      .def_property_readonly(
          "dq_dT", [](const Derivatives& d) { return d.dq_dT; },
          "Of q by each hard goal's target: its shift [m] and turn [rad] along the base frame's "
          "axes, shape (n, 6 a goal). Joints at limits and contact stay as they are; of all that "
          "remains the least motion.")
      .def_readonly("manipulability", &Derivatives::manipulability,
                    "Product of the singular values of the goals' Jacobian.")
      .def_readonly("singular_distance", &Derivatives::singular_distance,
                    "The least of them, turns in metres by Options.rotation_weight [m].");
}

}  // namespace

void bind_result(py::module_& module) {
  bind_one(module);
  bind_solutions(module);
  bind_batch(module);
}

}  // namespace pdoik::python
