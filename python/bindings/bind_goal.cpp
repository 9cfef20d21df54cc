#include <pybind11/stl.h>

#include <Eigen/SVD>
#include <algorithm>
#include <stdexcept>

#include "bind.hpp"
#include "errors.hpp"
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

/// A rotation that is off by no more than this was printed or computed in single precision: the
/// nearest one is taken, and that is told.
constexpr double kNearlyRigid = 1e-3;

/// Make a target rigid that is so but for rounding. @returns Whether it was not.
bool make_rigid(Eigen::Isometry3d& T) {
  const Eigen::Matrix3d R = T.linear();
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off > 1e-6) || !(off <= kNearlyRigid) || !(R.determinant() > 0.0)) return false;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  T.linear() = svd.matrixU() * svd.matrixV().transpose();
  return true;
}

void tell_of_rounding(const std::string& name) {
  warn_of_goal(name +
               " is off a rotation by rounding, of printed decimals perhaps: the nearest "
               "rotation is taken");
}

Eigen::Isometry3d to_rigid(const ArrayLike& value, const std::string& name) {
  Eigen::Isometry3d T = to_isometry(value, name);
  if (make_rigid(T)) tell_of_rounding(name);
  return T;
}

/// (4, 4), or where only the position counts (3,).
Eigen::Isometry3d to_target(const py::object& value, const std::string& name, bool is_position) {
  if (!is_position) return to_rigid({value}, name);
  const Array array = to_float64({value}, name);
  if (array.ndim() != 1) return to_rigid({value}, name);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = to_vector3({value}, name);
  return T;
}

/// A tip's place by its link's name.
int to_tip(const std::string& link, const Robot& robot, const std::string& what) {
  const std::vector<std::string> links = robot.tip_links();
  const auto found = std::find(links.begin(), links.end(), link);
  if (found != links.end()) return static_cast<int>(found - links.begin());
  std::string all;
  for (const std::string& each : links) all += (all.empty() ? "" : ", ") + each;
  throw std::invalid_argument(what + " '" + link + "', which is no tip link of the robot: " + all);
}

bool is_mapping(const py::handle& value) {
  return py::isinstance(value, py::module_::import("collections.abc").attr("Mapping"));
}
/// A list or tuple, of goals and their like and not of numbers.
bool is_list_of_goals(const py::handle& value) {
  if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value)) return false;
  const auto list = py::reinterpret_borrow<py::sequence>(value);
  if (py::len(list) == 0) return true;
  const py::object first = list[0];
  return py::isinstance<PythonGoal>(first) || is_mapping(first) || is_list_of_goals(first);
}

void require_one_tip(const Robot& robot, const std::string& name) {
  if (robot.tips().size() == 1) return;
  std::string links;
  for (const std::string& link : robot.tip_links()) links += (links.empty() ? "" : ", ") + link;
  throw std::invalid_argument(
      name + " is one target, but the robot has " + std::to_string(robot.tips().size()) +
      " tips, expected a dict of targets by tip, or Goals that name it: " + links);
}

/// @param tip  Whose it is, unless it says so itself; none where it has to.
Goal to_goal(const py::handle& value, const std::string& name, std::optional<int> tip,
             const GoalDefaults& defaults) {
  const Robot& robot = defaults.robot();
  if (!py::isinstance<PythonGoal>(value)) {
    if (!tip) require_one_tip(robot, name);
    Goal goal = defaults.of(tip.value_or(0));
    goal.T_base_tip =
        to_target(py::reinterpret_borrow<py::object>(value), name, goal.type == GoalType::Position);
    return goal;
  }
  const auto& given = value.cast<const PythonGoal&>();
  if (given.tip) {
    const int own = to_tip(*given.tip, robot, name + " is for");
    if (tip && *tip != own)
      throw std::invalid_argument(name + " is for '" + *given.tip + "', but stands under '" +
                                  robot.tip_links()[static_cast<std::size_t>(*tip)] + "'");
    tip = own;
  }
  if (!tip && given.type != GoalType::CenterOfMass) require_one_tip(robot, name);
  const Goal usual = defaults.of(tip.value_or(0));
  Goal goal = given.goal;
  goal.tip = usual.tip;
  goal.type = given.type.value_or(usual.type);
  goal.axis = given.axis.value_or(usual.axis);
  goal.T_tip_tool = given.T_tip_tool.value_or(usual.T_tip_tool);
  const bool turns = goal.type == GoalType::Pose || goal.type == GoalType::Axis;
  goal.priority = given.priority.value_or(turns ? usual.priority : Priority::Both);
  if (given.relative_to)
    goal.relative_to = to_tip(*given.relative_to, robot, name + " is relative to");
  return goal;
}

/// One value, or a list of goals.
void add_goals(const py::handle& value, const std::string& name, std::optional<int> tip,
               const GoalDefaults& defaults, std::vector<Goal>& goals) {
  if (!is_list_of_goals(value)) {
    goals.push_back(to_goal(value, name, tip, defaults));
    return;
  }
  const auto list = py::reinterpret_borrow<py::sequence>(value);
  if (py::len(list) == 0) throw std::invalid_argument(name + " is empty, expected goals");
  for (std::size_t k = 0; k < py::len(list); ++k) {
    const py::object each = list[k];
    goals.push_back(to_goal(each, name + "[" + std::to_string(k) + "]", tip, defaults));
  }
}

/// Calls visit(tip, name of the argument, value) for each entry.
template <class Visit>
void for_each_tip(const py::object& mapping, const Robot& robot, const std::string& name,
                  Visit&& visit) {
  for (const auto& item : py::dict(mapping)) {
    if (!py::isinstance<py::str>(item.first))
      throw py::type_error("a key of " + name + " is " + std::string(py::repr(item.first)) +
                           ", expected a tip link's name");
    const auto link = item.first.cast<std::string>();
    visit(to_tip(link, robot, name + " has a goal for"), name + "['" + link + "']", item.second);
  }
}

}  // namespace

GoalDefaults::GoalDefaults(const Robot& robot, const Options& options,
                           const std::optional<py::object>& tool,
                           const std::optional<std::string>& priority)
    : GoalDefaults(robot, options) {
  if (priority) priority_ = from_name<Priority>(*priority, "priority");
  if (!tool) return;
  tools_.resize(robot.tips().size());
  if (!is_mapping(*tool)) {
    require_one_tip(robot, "T_tip_tool");
    tools_.front() = to_rigid({*tool}, "T_tip_tool");
    return;
  }
  for_each_tip(*tool, robot, "T_tip_tool",
               [&](int tip, const std::string& name, const py::handle& value) {
                 tools_[static_cast<std::size_t>(tip)] =
                     to_rigid({py::reinterpret_borrow<py::object>(value)}, name);
               });
}

Goal GoalDefaults::of(int tip) const {
  Goal goal;
  goal.tip = tip;
  goal.type = options_.goal;
  goal.axis = options_.goal_axis;
  goal.T_tip_tool = options_.T_tip_tool;
  if (!tools_.empty())
    goal.T_tip_tool = tools_[static_cast<std::size_t>(tip)].value_or(options_.T_tip_tool);
  goal.priority = priority_.value_or(options_.priority);
  return goal;
}

std::vector<Goal> to_goals(const GoalsLike& values, const GoalDefaults& defaults,
                           const std::string& name) {
  std::vector<Goal> goals;
  if (!is_mapping(values.value)) {
    add_goals(values.value, name, std::nullopt, defaults, goals);
    return goals;
  }
  for_each_tip(values.value, defaults.robot(), name,
               [&](int tip, const std::string& entry, const py::handle& value) {
                 add_goals(value, entry, tip, defaults, goals);
               });
  return goals;
}

std::vector<std::vector<Goal>> to_goals_batch(const GoalsBatchLike& values,
                                              const GoalDefaults& defaults) {
  const std::string argument = "T_base_tip";
  std::vector<std::vector<Goal>> batch;
  if (is_list_of_goals(values.value)) {
    const auto list = py::reinterpret_borrow<py::sequence>(values.value);
    for (std::size_t k = 0; k < py::len(list); ++k) {
      const py::object each = list[k];
      batch.push_back(to_goals({each}, defaults, argument + "[" + std::to_string(k) + "]"));
    }
    return batch;
  }
  const auto add = [&](int tip, const std::string& name, const py::handle& value, bool first) {
    std::vector<Eigen::Isometry3d> targets =
        to_isometries({py::reinterpret_borrow<py::object>(value)}, name);
    if (first) batch.resize(targets.size());
    if (targets.size() != batch.size())
      throw std::invalid_argument(name + " has " + std::to_string(targets.size()) +
                                  " targets, expected " + std::to_string(batch.size()) +
                                  " as the others");
    bool told = false;
    for (std::size_t i = 0; i < targets.size(); ++i) {
      Goal goal = defaults.of(tip);
      goal.T_base_tip = targets[i];
      if (make_rigid(goal.T_base_tip) && !told) {
        tell_of_rounding(name + "[" + std::to_string(i) + "]");
        told = true;
      }
      batch[i].push_back(goal);
    }
  };
  if (!is_mapping(values.value)) {
    require_one_tip(defaults.robot(), argument);
    add(0, argument, values.value, true);
    return batch;
  }
  bool first = true;
  for_each_tip(values.value, defaults.robot(), argument,
               [&](int tip, const std::string& name, const py::handle& value) {
                 add(tip, name, value, first);
                 first = false;
               });
  if (first)
    throw std::invalid_argument("T_base_tip is empty, expected targets for a tip at least");
  return batch;
}

std::vector<std::vector<Goal>> to_alternatives(const py::object& values,
                                               const GoalDefaults& defaults) {
  if (py::isinstance<PythonGoal>(values) || is_mapping(values))
    throw py::type_error("goals is one goal, expected a list of those any one of which will do");
  std::vector<std::vector<Goal>> all;
  const auto add = [&](const py::object& each) {
    all.push_back(to_goals({each}, defaults, "goals[" + std::to_string(all.size()) + "]"));
  };
  if (!py::isinstance<py::list>(values) && !py::isinstance<py::tuple>(values)) {
    const Array array = to_float64({values}, "goals");
    if (array.ndim() != 3)
      throw std::invalid_argument("goals has shape " + std::string(py::str(array.attr("shape"))) +
                                  ", expected (N, 4, 4) or a list");
    for (py::ssize_t i = 0; i < array.shape(0); ++i) add(array[py::int_(i)]);
    return all;
  }
  for (const auto& each : py::reinterpret_borrow<py::sequence>(values))
    add(py::reinterpret_borrow<py::object>(each));
  return all;
}

std::vector<Lock> to_locks(const std::optional<py::object>& values, const Robot& robot) {
  std::vector<Lock> locks;
  if (!values) return locks;
  if (!is_mapping(*values))
    throw py::type_error("lock is " + std::string(py::repr(*values)) +
                         ", expected a dict of positions by joint");
  for (const auto& item : py::dict(*values)) {
    const auto joint = item.first.cast<std::string>();
    const std::vector<std::string>& names = robot.joint_names();
    const auto found = std::find(names.begin(), names.end(), joint);
    if (found == names.end()) {
      std::string all;
      for (const std::string& each : names) all += (all.empty() ? "" : ", ") + each;
      throw std::invalid_argument("lock has '" + joint +
                                  "', which is no joint of the robot: " + all);
    }
    locks.push_back({static_cast<int>(found - names.begin()), item.second.cast<double>()});
  }
  return locks;
}

namespace {

/// Lower and upper corner of a box.
std::pair<Eigen::Vector3d, Eigen::Vector3d> to_box(const py::object& value,
                                                   const std::string& name) {
  const Array array = to_float64({value}, name);
  if (array.ndim() != 2 || array.shape(0) != 2 || array.shape(1) != 3)
    throw std::invalid_argument(name + " has shape " + std::string(py::str(array.attr("shape"))) +
                                ", expected (2, 3): a lower and an upper corner");
  const Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> rows(array.data());
  return {rows.row(0), rows.row(1)};
}

/// NaN is refused; infinity frees an axis.
Eigen::Vector3d to_slack(const std::optional<ArrayLike>& values, const std::string& name,
                         bool is_angle) {
  if (!values) return Eigen::Vector3d::Zero();
  const Array array = to_float64(*values, name);
  if (is_angle || array.ndim() != 1 || array.shape(0) != 3) {
    const Eigen::Vector3d slack = to_vector3(*values, name);
    if (is_angle && slack.maxCoeff() > M_PI + 1e-9)
      warn_of_goal(name +
                   " has an angle beyond pi, which is no more than pi is: degrees, perhaps? "
                   "It is taken as radians");
    return slack;
  }
  const Eigen::Map<const Eigen::Vector3d> slack(array.data());
  if (slack.hasNaN()) throw std::invalid_argument(name + " holds NaN");
  return slack;
}

PythonGoal make_goal(const py::object& T_base_tip, const std::optional<std::string>& type,
                     const std::optional<py::object>& axis, double weight,
                     const std::optional<ArrayLike>& position_slack,
                     const std::optional<ArrayLike>& rotation_slack, bool stands,
                     const std::optional<std::string>& relative_to,
                     const std::optional<std::string>& tip,
                     const std::optional<ArrayLike>& T_tip_tool, bool soft,
                     const std::optional<std::string>& priority, double position_tolerance,
                     double rotation_tolerance) {
  PythonGoal made;
  if (type) made.type = from_name<GoalType>(*type, "type");
  if (axis) made.axis = to_axis(*axis, "axis");
  const bool is_place = made.type == GoalType::Position || made.type == GoalType::LookAt ||
                        made.type == GoalType::CenterOfMass;
  made.goal.T_base_tip = to_target(T_base_tip, "T_base_tip", is_place);
  made.goal.weight = weight;
  made.goal.stands = stands;
  made.relative_to = relative_to;
  made.tip = tip;
  if (T_tip_tool) made.T_tip_tool = to_rigid(*T_tip_tool, "T_tip_tool");
  made.goal.soft = soft;
  if (priority) made.priority = from_name<Priority>(*priority, "priority");
  made.goal.position_tolerance = position_tolerance;
  made.goal.rotation_tolerance = rotation_tolerance;
  made.goal.position_slack = to_slack(position_slack, "position_slack", false);
  made.goal.rotation_slack = to_slack(rotation_slack, "rotation_slack", true);
  return made;
}

py::str repr(const PythonGoal& g) {
  std::string text = g.type ? to_name(*g.type) : "of the options' type";
  if (g.tip) text += " for " + *g.tip;
  if (g.relative_to) text += " relative to " + *g.relative_to;
  if (g.goal.soft) text += ", soft";
  return py::str("<Goal {} at {}, weight={}>")
      .format(text, py::cast(Eigen::Vector3d(g.goal.T_base_tip.translation())).attr("tolist")(),
              g.goal.weight);
}

}  // namespace

void bind_goal(py::module_& module) {
  py::class_<PythonGoal> goal(module, "Goal",
                              R"(One requirement: of a tip, or of the centre of mass.

A solve takes one, a list of them, or a dict of them by tip. A target given as a bare array is a goal of the
options' type, with no slack and weight 1.

>>> import numpy as np
>>> import pdoik
>>> robot = pdoik.Robot.builtin("panda")
>>> T = robot.fk(robot.mid_configuration())
>>> tilted = pdoik.Goal(T, type="axis", axis="z", rotation_slack=[0.1] * 3)  # free about z, 0.1 rad of tilt
>>> seam = pdoik.Goal.region(T, position=([-0.2, 0, 0], [0.2, 0, 0]))  # anywhere on a line of 0.4 m
>>> look = pdoik.Goal.look_at([0.6, 0.0, 0.2], soft=True)  # and, as far as that lets it, facing this
>>> pdoik.Solver(robot).solve([seam, look]).success
True)");
  goal.def(py::init(&make_goal), py::arg("T_base_tip"), py::kw_only(), py::arg("type") = py::none(),
           py::arg("axis") = py::none(), py::arg("weight") = 1.0,
           py::arg("position_slack") = py::none(), py::arg("rotation_slack") = py::none(),
           py::arg("stands") = false, py::arg("relative_to") = py::none(),
           py::arg("tip") = py::none(), py::arg("T_tip_tool") = py::none(), py::arg("soft") = false,
           py::arg("priority") = py::none(), py::arg("position_tolerance") = 0.0,
           py::arg("rotation_tolerance") = 0.0,
           R"(A target and what of it counts.

Args:
    T_base_tip: The target, which takes tip points to the base frame, shape (4, 4) [m]; of "position" and
        "look_at" goals the position will do, shape (3,).
    type: "pose", "axis" (position, and the direction of one axis), "position", "look_at" (that one axis
        points at the target's origin from wherever the tip is) or "center_of_mass"; None for the options'
        `goal`.
    axis: In the tool's frame, for "axis" and "look_at": a letter or a vector. None for the options'
        `goal_axis`.
    weight: Of its squared errors against the other goals', where not all can be met.
    position_slack: How far the tip may be off along each axis of the target frame, shape (3,) [m];
        infinity frees it. None for not at all.
    rotation_slack: How far it may be turned about each axis of the target frame, as components of the
        rotation vector from target to tip, shape (3,) [rad]; pi frees an axis. Of "axis" and "look_at" goals
        the largest is half the angle of a cone.
    stands: Whether a Tracker gives nothing of it up for goals that do not stand: a foot on the ground
        whatever the hands are asked. Where it is met it stays so, to 0.05 mm, else it is left no farther.
        A Solver weighs all goals alike. Not for trackers with `max_acceleration`.
    relative_to: Another tip's link, in whose frame the target then is instead of the base's: two hands
        on one box, wherever the box is. It is the link's frame, whatever tool it has. That tip may have a
        goal of its own, with slack.
    tip: Whose it is, where it stands in a list; None for the only tip.
    T_tip_tool: What of the tip has to be at the target, in the tip link's frame, shape (4, 4) [m]: a tool on
        the flange. None for that of the call, or the options'.
    soft: Whether it is a wish: what is hard is met first, and then this as nearly as that lets it be, going
        downhill from the first solution; with `prefer="nearest"` from all. Success does not look at it.
    priority: "position": the position is met and the orientation as near as can be, with the status
        "nearest" where that is not all of it. None for that of the call, or the options'.
    position_tolerance: Largest error of a success [m]; 0 for the options'.
    rotation_tolerance: Largest error of a success [rad]; 0 for the options'.

Raises:
    ValueError: A shape is wrong, a str is not one of its choices, or something is NaN.

Warns:
    GoalWarning: A rotation is off by rounding, and the nearest one is taken; an angle is beyond pi.)");
  goal.def_static(
      "region",
      [](const py::object& T_base_tip, const std::optional<py::object>& position,
         const std::optional<py::object>& rotation, const std::optional<std::string>& type,
         const std::optional<py::object>& axis, double weight, bool stands,
         const std::optional<std::string>& relative_to, const std::optional<std::string>& tip,
         const std::optional<ArrayLike>& T_tip_tool, bool soft,
         const std::optional<std::string>& priority, double position_tolerance,
         double rotation_tolerance) {
        PythonGoal made =
            make_goal(T_base_tip, type, axis, weight, {}, {}, stands, relative_to, tip, T_tip_tool,
                      soft, priority, position_tolerance, rotation_tolerance);
        if (position) {
          const auto [lower, upper] = to_box(*position, "position");
          made.goal.between(lower, upper);
        }
        if (rotation) {
          const auto [lower, upper] = to_box(*rotation, "rotation");
          made.goal.turned_between(lower, upper);
        }
        return made;
      },
      py::arg("T_base_tip"), py::kw_only(), py::arg("position") = py::none(),
      py::arg("rotation") = py::none(), py::arg("type") = py::none(), py::arg("axis") = py::none(),
      py::arg("weight") = 1.0, py::arg("stands") = false, py::arg("relative_to") = py::none(),
      py::arg("tip") = py::none(), py::arg("T_tip_tool") = py::none(), py::arg("soft") = false,
      py::arg("priority") = py::none(), py::arg("position_tolerance") = 0.0,
      py::arg("rotation_tolerance") = 0.0,
      R"(A goal that is met anywhere in a box about a target: a task-space region.

Args:
    T_base_tip: The frame of the box, as of a Goal.
    position: Its lower and upper corner, shape (2, 3), along the frame's axes [m]; infinity frees an axis on
        one side or both. None for the frame's origin alone.
    rotation: How far the tip may be turned about the frame's axes, from and to, shape (2, 3) [rad], counted
        as components of the rotation vector from the middle of the two; -pi and pi free an axis. None for not
        at all.
    **rest: As of a Goal.

Raises:
    ValueError: A lower bound is above its upper one; as for a Goal.)");
  goal.def_static(
      "look_at",
      [](const py::object& point, const py::object& axis, double cone, double weight, bool stands,
         const std::optional<std::string>& relative_to, const std::optional<std::string>& tip,
         const std::optional<ArrayLike>& T_tip_tool, bool soft, double rotation_tolerance) {
        const py::list slack(py::make_tuple(cone, cone, cone));
        return make_goal(point, "look_at", axis, weight, {}, ArrayLike{slack}, stands, relative_to,
                         tip, T_tip_tool, soft, {}, 0.0, rotation_tolerance);
      },
      py::arg("point"), py::kw_only(), py::arg("axis") = "z", py::arg("cone") = 0.0,
      py::arg("weight") = 1.0, py::arg("stands") = false, py::arg("relative_to") = py::none(),
      py::arg("tip") = py::none(), py::arg("T_tip_tool") = py::none(), py::arg("soft") = false,
      py::arg("rotation_tolerance") = 0.0,
      R"(A goal that an axis of the tip points at a point from wherever it is.

Args:
    point: In the base frame, or in that of `relative_to`, shape (3,) [m].
    axis: Of the tool: a letter or a vector.
    cone: How far off it may point [rad].
    weight: As all that follows, as of a Goal.)");
  goal.def_static(
      "center_of_mass",
      [](const ArrayLike& lower, const ArrayLike& upper) {
        py::list box;
        box.append(lower.value);
        box.append(upper.value);
        const auto [low, high] = to_box(box, "the box of the centre of mass");
        PythonGoal made;
        made.type = GoalType::CenterOfMass;
        made.goal.between(low, high);
        return made;
      },
      py::arg("lower"), py::arg("upper"),
      R"(A goal that the centre of mass of all that has mass is in a box along the base's axes.

Args:
    lower: Its lower corner, shape (3,) [m]; minus infinity for none.
    upper: Its upper corner.)");
  goal.def_property_readonly(
          "T_base_tip", [](const PythonGoal& g) -> Matrix4 { return g.goal.T_base_tip.matrix(); },
          "Of a region the middle.")
      .def_property_readonly("type",
                             [](const PythonGoal& g) -> std::optional<std::string> {
                               if (!g.type) return std::nullopt;
                               return to_name(*g.type);
                             })
      .def_property_readonly("axis", [](const PythonGoal& g) { return g.axis; })
      .def_property_readonly("weight", [](const PythonGoal& g) { return g.goal.weight; })
      .def_property_readonly("stands", [](const PythonGoal& g) { return g.goal.stands; })
      .def_property_readonly("soft", [](const PythonGoal& g) { return g.goal.soft; })
      .def_property_readonly("priority",
                             [](const PythonGoal& g) -> std::optional<std::string> {
                               if (!g.priority) return std::nullopt;
                               return to_name(*g.priority);
                             })
      .def_readonly("tip", &PythonGoal::tip)
      .def_readonly("relative_to", &PythonGoal::relative_to)
      .def_property_readonly("T_tip_tool",
                             [](const PythonGoal& g) -> std::optional<Matrix4> {
                               if (!g.T_tip_tool) return std::nullopt;
                               return Matrix4(g.T_tip_tool->matrix());
                             })
      .def_property_readonly("position_tolerance",
                             [](const PythonGoal& g) { return g.goal.position_tolerance; })
      .def_property_readonly("rotation_tolerance",
                             [](const PythonGoal& g) { return g.goal.rotation_tolerance; })
      .def_property_readonly("position_slack",
                             [](const PythonGoal& g) { return g.goal.position_slack; })
      .def_property_readonly("rotation_slack",
                             [](const PythonGoal& g) { return g.goal.rotation_slack; })
      .def("__repr__", &repr);
}

}  // namespace pdoik::python
