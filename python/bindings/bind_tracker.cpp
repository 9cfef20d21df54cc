#include <pybind11/stl.h>

#include <stdexcept>

#include "arrays.hpp"
#include "bind.hpp"
#include "contacts.hpp"
#include "goals.hpp"
#include "names.hpp"
#include "pdoik/tracker.hpp"
#include "result.hpp"
#include "scene.hpp"
#include "units.hpp"

namespace pdoik::python {
namespace {

using TrackingName =
    py::typing::Literal<"'tracking'", "'infeasible'", "'deadline_struck'", "'invalid_input'">;

/// As Python has it.
struct PythonTracker : Tracker {
  using Tracker::Tracker;
  ToldOfUnits told_of_units = false;
};

/// A copy that outlives the next step.
struct NamedStep : NamedResult {
  TrackerStatus tracking;
  std::optional<std::string> step_limited;
  bool stopped_hard = false;
  std::string complaint;
};

NamedStep named(const Tracker& tracker, const TrackerResult& result) {
  NamedStep step;
  static_cast<Result&>(step) = result;
  name_constraints(tracker, step);
  step.tracking = result.tracking;
  if (result.step_limited >= 0) {
    step.step_limited =
        tracker.robot().joint_names()[static_cast<std::size_t>(result.step_limited)];
  }
  step.stopped_hard = result.stopped_hard;
  step.complaint = result.complaint;
  return step;
}

/// A velocity for all obstacles, (3,), or one for each, (N, 3).
Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> to_velocity(const ArrayLike& value) {
  const auto array =
      py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value.value);
  if (!array) {
    PyErr_Clear();
    throw std::invalid_argument("obstacle_velocity: expected numbers, shape (3,) or (N, 3)");
  }
  const bool one = array.ndim() == 1;
  if (array.ndim() < 1 || array.ndim() > 2 || array.shape(one ? 0 : 1) != 3)
    throw std::invalid_argument("obstacle_velocity: expected shape (3,) or (N, 3)");
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
      array.data(), one ? 1 : array.shape(0), 3);
}

/// What stands for an argument that was left out.
bool is_left_out(const std::optional<ObstaclesLike>& obstacles) {
  return obstacles && obstacles->value.is(py::ellipsis());
}

NamedStep step(PythonTracker& self, const GoalsLike& T_base_tip,
               const std::optional<ObstaclesLike>& obstacles,
               const std::optional<ArrayLike>& velocity) {
  try {
    if (!is_left_out(obstacles)) {
      try {
        const ObstaclesIn given(obstacles, "obstacles");
        warn_of_units(given, self.robot(), self.told_of_units);
        if (velocity)
          given.give_to(self, to_velocity(*velocity));
        else
          given.give_to(self);
      } catch (const std::invalid_argument& refused) {
        self.refuse_obstacles(refused.what());
      }
    }
    return named(self, self.step(to_goals(T_base_tip, {self.robot(), self.solver_options()})));
  } catch (const std::invalid_argument& refused) {
    return named(self, self.hold(refused.what()));
  }
}

void bind_latency(py::module_& module) {
  using H = LatencyHistogram;
  py::class_<H>(module, "LatencyHistogram",
                "How long steps took: counts in bins that are a twelfth of an octave wide.")
      .def_property_readonly("count", &H::count, "The number of steps.")
      .def_property_readonly("max", &H::max, "The longest [s].")
      .def("quantile", &H::quantile, py::arg("share"),
           "The time that a share (0 to 1) of all steps took at most, to 6 % [s].")
      .def_property_readonly(
          "upper_edges",
          [](const H&) {
            Eigen::VectorXd edges(static_cast<Eigen::Index>(H::kBins));
            for (std::size_t k = 0; k < H::kBins; ++k)
              edges[static_cast<Eigen::Index>(k)] = H::upper_edge(k);
            return edges;
          },
          "The bins' upper ends, shape (B,) [s].")
      .def_property_readonly(
          "counts",
          [](const H& h) {
            return py::array_t<std::uint64_t>(static_cast<py::ssize_t>(H::kBins), h.bins().data());
          },
          "Steps in each bin, shape (B,).")
      .def("__repr__", [](const H& h) {
        return py::str(
                   "<LatencyHistogram of {} steps: median {:.3g} ms, p99 {:.3g} ms, p99.9 "
                   "{:.3g} ms, max {:.3g} ms>")
            .format(h.count(), 1e3 * h.quantile(0.5), 1e3 * h.quantile(0.99),
                    1e3 * h.quantile(0.999), 1e3 * h.max());
      });
}

void bind_step(py::module_& module) {
  py::class_<NamedStep, NamedResult>(module, "TrackerResult",
                                     "The outcome of one step of a Tracker.")
      .def_property_readonly(
          "tracking",
          [](const NamedStep& s) {
            return py::reinterpret_borrow<TrackingName>(py::str(to_string(s.tracking)));
          },
          R"(What became of the step.

`tracking`: goals, limits and all constraints hold; `infeasible`: they cannot be met within the step, and
`worst_constraint` names what gives; `deadline_struck`: q is the last answer if that still solves, else the
best so far; `invalid_input`: q is the last answer, and `complaint` says why.)")
      .def_readonly("step_limited", &NamedStep::step_limited,
                    "The first joint that its step limit holds back, or None.")
      .def_readonly("stopped_hard", &NamedStep::stopped_hard,
                    "Whether it stops harder than max_acceleration allows: braking only so hard "
                    "would be deeper "
                    "in something or leave the limits of a joint, or the input was refused.")
      .def_readonly("complaint", &NamedStep::complaint, "Why the input was refused, or ''.");
}

}  // namespace

void bind_tracker(py::module_& module) {
  bind_latency(module);
  bind_step(module);
  py::class_<PythonTracker>(module, "Tracker")
      .def(py::init([](const Robot& robot, const Options& options, double period, double max_time,
                       double speed_share, const std::optional<ArrayLike>& max_speed,
                       const std::optional<ArrayLike>& max_acceleration, double posture_weight,
                       double smoothness) {
             TrackerOptions t{.period = period,
                              .max_time = max_time,
                              .speed_share = speed_share,
                              .posture_weight = posture_weight,
                              .smoothness = smoothness};
             if (max_speed) t.max_speed = to_vector(*max_speed, "max_speed", robot.dof());
             if (max_acceleration) {
               t.max_acceleration = to_vector(*max_acceleration, "max_acceleration", robot.dof());
             }
             return PythonTracker(robot, options, t);
           }),
           py::arg("robot"), py::arg("options"), py::kw_only(), py::arg("period"),
           py::arg("max_time"), py::arg("speed_share"), py::arg("max_speed"),
           py::arg("max_acceleration"), py::arg("posture_weight"), py::arg("smoothness"))
      .def_property_readonly("robot", [](const PythonTracker& self) { return self.robot(); })
      .def_property_readonly(
          "q", [](const PythonTracker& self) { return self.q(); }, "The last answer, shape (n,).")
      .def_property_readonly(
          "velocity", [](const PythonTracker& self) { return self.velocity(); },
          "Its speed in the last step where acceleration is limited, shape (n,); 0 else.")
      .def(
          "reset",
          [](PythonTracker& self, const ArrayLike& q, const std::optional<ArrayLike>& velocity) {
            const int n = self.robot().dof();
            self.reset(to_vector(q, "q", n),
                       velocity ? to_vector(*velocity, "velocity", n) : Eigen::VectorXd());
          },
          py::arg("q"), py::arg("velocity") = py::none(),
          R"(Where the next step starts from: the measured configuration, most often.

Args:
    q: Joint positions, shape (n,) [rad] or [m]; moved inside the limits.
    velocity: How fast it moves, which counts where acceleration is limited, shape (n,) [rad/s] or [m/s]; None for
        at rest.

Raises:
    ValueError: Either has another shape or holds NaN or infinity.)")
      .def(
          "set_posture",
          [](PythonTracker& self, const std::optional<ArrayLike>& posture) {
            self.set_posture(posture ? to_vector(*posture, "posture", self.robot().dof())
                                     : Eigen::VectorXd());
          },
          py::arg("posture"),
          R"(A posture to stay near from now on, shape (n,); None for none.

Raises:
    ValueError: It has another shape or holds NaN or infinity.)")
      .def(
          "attach",
          [](PythonTracker& self, const Holders& link, const std::vector<Shape>& shapes,
             const std::vector<std::string>& may_touch, const std::vector<ContactRule>& contacts) {
            const Attachment thing = to_attachment(link, shapes, may_touch, contacts);
            self.attach({&thing, 1});
          },
          py::arg("link"), py::arg("shapes"), py::arg("may_touch") = py::tuple(),
          py::arg("contacts") = py::tuple(), "As Solver.attach, for the steps that follow.")
      .def(
          "attach_all",
          [](PythonTracker& self, const std::vector<Attachment>& things) { self.attach(things); },
          py::arg("things"), "As Solver.attach_all.")
      .def(
          "detach",
          [](PythonTracker& self, const std::optional<std::string>& name) {
            name ? self.detach(*name) : self.detach();
          },
          py::arg("name") = py::none(), "As Solver.detach.")
      .def_property_readonly(
          "carried", [](const PythonTracker& self) { return self.attached(); },
          "What links carry, as it was attached.")
      .def("step", &step, py::arg("T_base_tip"), py::arg("obstacles") = py::ellipsis(),
           py::arg("obstacle_velocity") = py::none(),
           R"(One step towards the goals, by the deadline. Raises nothing for bad numbers.

Args:
    T_base_tip: Goals as in Solver.solve.
    obstacles: As in Solver.solve, an array with at most Options.max_obstacles rows. None or empty: there are
        none. Left out: those of the step before stay; of a Cloud its updates are seen. A cloud that makes no
        sense is refused: steps then hold the last answer until a good one comes. So do steps of a robot without
        hulls among obstacles, see Options.ignore_obstacles_without_hulls.
    obstacle_velocity: How fast these move, if they are an array of points or a list of shapes: shape (3,) for all
        or (N, 3), one for each [m/s]. They are then kept off where they are and where they will be when the step
        ends; those that move count twice in Options.max_obstacles. None: they stand still.

Returns:
    Whatever the status: never farther from the last answer than the step limits, and by the scene as it is no deeper in
    anything than standing still would be, nor than contact.

Raises:
    TypeError: Something is no array of numbers.

Warns:
    ObstacleWarning: As in Solver.solve.)")
      .def_property_readonly(
          "latency", [](const PythonTracker& self) { return self.latency(); },
          "Of all steps so far, in C++.")
      .def("clear_latency", [](PythonTracker& self) { self.clear_latency(); });
}

}  // namespace pdoik::python
