#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::python {

/// A goal as Python gives it: what it leaves out comes from the call or the options.
struct PythonGoal {
  Goal goal;  ///< its tip and what it is relative to are told by name
  std::optional<GoalType> type;
  std::optional<Eigen::Vector3d> axis;
  std::optional<Eigen::Isometry3d> T_tip_tool;
  std::optional<Priority> priority;
  std::optional<std::string> tip, relative_to;
};

/// What goals leave out, for one call.
class GoalDefaults {
 public:
  GoalDefaults(const Robot& robot, const Options& options) : robot_(robot), options_(options) {}
  /// @param tool  None, a matrix, or a mapping from tip links to matrices.
  GoalDefaults(const Robot& robot, const Options& options, const std::optional<py::object>& tool,
               const std::optional<std::string>& priority);

  /// A goal for a tip, as the options have it.
  Goal of(int tip) const;
  const Robot& robot() const { return robot_; }

 private:
  const Robot& robot_;
  const Options& options_;
  std::vector<std::optional<Eigen::Isometry3d>> tools_;  ///< of each tip; empty for the options'
  std::optional<Priority> priority_;
};

/// A target for the only tip, a list of goals, or a mapping from tip links to targets or lists of
/// goals; a target is an array or a Goal.
struct GoalsLike {
  py::object value;
};
/// The same with a leading dimension: (B, 4, 4), a mapping to such arrays, or a list of GoalsLike.
struct GoalsBatchLike {
  py::object value;
};

std::vector<Goal> to_goals(const GoalsLike& values, const GoalDefaults& defaults,
                           const std::string& name = "T_base_tip");
std::vector<std::vector<Goal>> to_goals_batch(const GoalsBatchLike& values,
                                              const GoalDefaults& defaults);
/// Goals any one of which will do: (N, 4, 4), or a list of GoalsLike.
std::vector<std::vector<Goal>> to_alternatives(const py::object& values,
                                               const GoalDefaults& defaults);
/// A mapping from joint names to positions.
std::vector<Lock> to_locks(const std::optional<py::object>& values, const Robot& robot);

}  // namespace pdoik::python

#define PDOIK_OBJECT_CASTER(Type, text)                 \
  template <>                                           \
  struct pybind11::detail::type_caster<Type> {          \
    PYBIND11_TYPE_CASTER(Type, const_name(text));       \
    bool load(handle source, bool) {                    \
      if (!source || source.is_none()) return false;    \
      value.value = reinterpret_borrow<object>(source); \
      return true;                                      \
    }                                                   \
  }

PDOIK_OBJECT_CASTER(pdoik::python::GoalsLike,
                    "numpy.typing.ArrayLike | pdoik._core.Goal | "
                    "collections.abc.Sequence[pdoik._core.Goal] | collections.abc.Mapping[str, "
                    "numpy.typing.ArrayLike | pdoik._core.Goal | "
                    "collections.abc.Sequence[pdoik._core.Goal]]");
PDOIK_OBJECT_CASTER(pdoik::python::GoalsBatchLike,
                    "numpy.typing.ArrayLike | collections.abc.Mapping[str, "
                    "numpy.typing.ArrayLike] | collections.abc.Sequence[typing.Any]");
