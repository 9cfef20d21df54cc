#include <pybind11/stl.h>

#include <stdexcept>

#include "bind.hpp"
#include "goals.hpp"
#include "names.hpp"

namespace pdoik::python {
namespace {

/// A letter or a vector of three.
Eigen::Vector3d to_axis(const py::object& value, const std::string& name) {
  if (!py::isinstance<py::str>(value)) return to_vector3({value}, name);
  const auto letter = value.cast<std::string>();
  if (letter.size() != 1 || letter < "x" || letter > "z")
    throw std::invalid_argument(name + " is '" + letter +
                                "', expected 'x', 'y', 'z' or a 3-vector");
  return Eigen::Vector3d::Unit(letter[0] - 'x');
}

/// (4, 4), or where only the position counts (3,).
Eigen::Isometry3d to_target(const py::object& value, const std::string& name, bool is_position) {
  if (!is_position) return to_isometry({value}, name);
  const Array array = to_float64({value}, name);
  if (array.ndim() != 1) return to_isometry({value}, name);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = to_vector3({value}, name);
  return T;
}

Goal to_goal(const py::handle& value, const std::string& name, int tip, const Options& options) {
  Goal goal;
  goal.tip = tip;
  goal.type = options.goal;
  goal.axis = options.goal_axis;
  if (!py::isinstance<PythonGoal>(value)) {
    goal.T_base_tip =
        to_target(py::reinterpret_borrow<py::object>(value), name, goal.type == GoalType::Position);
    return goal;
  }
  const auto& given = value.cast<const PythonGoal&>();
  goal.T_base_tip = given.T_base_tip;
  goal.type = given.type.value_or(goal.type);
  goal.axis = given.axis.value_or(goal.axis);
  goal.weight = given.weight;
  goal.stands = given.stands;
  goal.position_slack = given.position_slack;
  goal.rotation_slack = given.rotation_slack;
  return goal;
}

bool is_mapping(const py::object& value) {
  return py::isinstance(value, py::module_::import("collections.abc").attr("Mapping"));
}

void require_one_tip(const Robot& robot) {
  if (robot.tips().size() == 1) return;
  std::string links;
  for (const std::string& link : robot.tip_links()) links += (links.empty() ? "" : ", ") + link;
  throw std::invalid_argument("T_base_tip is one target, but the robot has " +
                              std::to_string(robot.tips().size()) +
                              " tips, expected a dict of targets by tip: " + links);
}

/// Calls visit(tip, name of the argument, value) for each entry.
template <class Visit>
void for_each_tip(const py::object& mapping, const Robot& robot, Visit&& visit) {
  for (const auto& item : py::dict(mapping)) {
    if (!py::isinstance<py::str>(item.first))
      throw py::type_error("a key of T_base_tip is " + std::string(py::repr(item.first)) +
                           ", expected a tip link's name");
    const auto link = item.first.cast<std::string>();
    const std::vector<std::string> links = robot.tip_links();
    const auto found = std::find(links.begin(), links.end(), link);
    if (found == links.end()) {
      std::string all;
      for (const std::string& each : links) all += (all.empty() ? "" : ", ") + each;
      throw std::invalid_argument("T_base_tip has a goal for '" + link +
                                  "', which is no tip link of the robot: " + all);
    }
    visit(static_cast<int>(found - links.begin()), "T_base_tip['" + link + "']", item.second);
  }
}

}  // namespace

std::vector<Goal> to_goals(const GoalsLike& values, const Robot& robot, const Options& options) {
  if (!is_mapping(values.value)) {
    require_one_tip(robot);
    return {to_goal(values.value, "T_base_tip", 0, options)};
  }
  std::vector<Goal> goals;
  for_each_tip(values.value, robot, [&](int tip, const std::string& name, const py::handle& value) {
    goals.push_back(to_goal(value, name, tip, options));
  });
  return goals;
}

std::vector<std::vector<Goal>> to_goals_batch(const GoalsBatchLike& values, const Robot& robot,
                                              const Options& options) {
  std::vector<std::vector<Goal>> batch;
  const auto add = [&](int tip, const std::string& name, const py::handle& value, bool first) {
    const std::vector<Eigen::Isometry3d> targets =
        to_isometries({py::reinterpret_borrow<py::object>(value)}, name);
    if (first) batch.resize(targets.size());
    if (targets.size() != batch.size())
      throw std::invalid_argument(name + " has " + std::to_string(targets.size()) +
                                  " targets, expected " + std::to_string(batch.size()) +
                                  " as the others");
    for (std::size_t i = 0; i < targets.size(); ++i) {
      Goal goal;
      goal.tip = tip;
      goal.T_base_tip = targets[i];
      goal.type = options.goal;
      goal.axis = options.goal_axis;
      batch[i].push_back(goal);
    }
  };
  if (!is_mapping(values.value)) {
    require_one_tip(robot);
    add(0, "T_base_tip", values.value, true);
    return batch;
  }
  bool first = true;
  for_each_tip(values.value, robot, [&](int tip, const std::string& name, const py::handle& value) {
    add(tip, name, value, first);
    first = false;
  });
  if (first)
    throw std::invalid_argument("T_base_tip is empty, expected targets for a tip at least");
  return batch;
}

void bind_goal(py::module_& module) {
  py::class_<PythonGoal>(module, "Goal", R"(What one tip has to match of its target.

A target given as a bare array is a goal of the options' type, with no slack and weight 1.)")
      .def(py::init([](const ArrayLike& T_base_tip, const std::optional<std::string>& type,
                       const std::optional<py::object>& axis, double weight,
                       const std::optional<ArrayLike>& position_slack,
                       const std::optional<ArrayLike>& rotation_slack, bool stands) {
             const auto slack = [](const std::optional<ArrayLike>& values, const char* name) {
               return values ? to_vector3(*values, name) : Eigen::Vector3d(0.0, 0.0, 0.0);
             };
             PythonGoal goal;
             if (type) goal.type = from_name<GoalType>(*type, "type");
             if (axis) goal.axis = to_axis(*axis, "axis");
             goal.T_base_tip =
                 to_target(T_base_tip.value, "T_base_tip", goal.type == GoalType::Position);
             goal.weight = weight;
             goal.stands = stands;
             goal.position_slack = slack(position_slack, "position_slack");
             goal.rotation_slack = slack(rotation_slack, "rotation_slack");
             return goal;
           }),
           py::arg("T_base_tip"), py::kw_only(), py::arg("type") = py::none(),
           py::arg("axis") = py::none(), py::arg("weight") = 1.0,
           py::arg("position_slack") = py::none(), py::arg("rotation_slack") = py::none(),
           py::arg("stands") = false,
           R"(A target and what of it counts.

Args:
    T_base_tip: The target, which takes tip points to the base frame, shape (4, 4) [m]; of a "position"
        goal the position will do, shape (3,).
    type: "pose", "axis" or "position"; None for the options' `goal`.
    axis: In the tip frame, for type "axis": a letter or a vector. None for the options' `goal_axis`.
    weight: Of its squared errors against the other goals', where not all can be met.
    position_slack: How far the tip may be off along each axis of the target frame, shape (3,) [m]. None
        for not at all.
    rotation_slack: How far it may be turned about each axis of the target frame, as components of the
        rotation vector from target to tip, shape (3,) [rad]; pi frees an axis. Of an "axis" goal the
        largest is half the angle of a cone.
    stands: Whether a Tracker gives nothing of it up for goals that do not stand: a foot on the ground
        whatever the hands are asked. Where it is met it stays so, to 0.05 mm, else it is left no farther.
        A Solver weighs all goals alike. Not for trackers with `max_acceleration`.

Raises:
    ValueError: A shape is wrong, a str is not one of its choices, or something is NaN.)")
      .def_property_readonly("T_base_tip",
                             [](const PythonGoal& g) -> Matrix4 { return g.T_base_tip.matrix(); })
      .def_property_readonly("type",
                             [](const PythonGoal& g) -> std::optional<std::string> {
                               if (!g.type) return std::nullopt;
                               return to_name(*g.type);
                             })
      .def_property_readonly("axis", [](const PythonGoal& g) { return g.axis; })
      .def_readonly("weight", &PythonGoal::weight)
      .def_readonly("stands", &PythonGoal::stands)
      .def_property_readonly("position_slack", [](const PythonGoal& g) { return g.position_slack; })
      .def_property_readonly("rotation_slack", [](const PythonGoal& g) { return g.rotation_slack; })
      .def("__repr__", [](const PythonGoal& g) {
        return py::str("<Goal {} at {}, weight={}>")
            .format(g.type ? to_name(*g.type) : "of the options' type",
                    py::cast(Eigen::Vector3d(g.T_base_tip.translation())).attr("tolist")(),
                    g.weight);
      });
}

}  // namespace pdoik::python
