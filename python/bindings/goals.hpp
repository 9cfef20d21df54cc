#pragma once

#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "pdoik/goal.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::python {

/// A goal as Python gives it: what it leaves out comes from the options.
struct PythonGoal {
  Eigen::Isometry3d T_base_tip;
  std::optional<GoalType> type;
  std::optional<Eigen::Vector3d> axis;
  double weight;
  bool stands;
  Eigen::Vector3d position_slack, rotation_slack;
};

/// A target for the only tip, or a mapping from tip links to targets; a target is an array or a
/// Goal.
struct GoalsLike {
  py::object value;
};
/// The same with a leading dimension: (B, 4, 4), or a mapping to such arrays.
struct GoalsBatchLike {
  py::object value;
};

std::vector<Goal> to_goals(const GoalsLike& values, const Robot& robot, const Options& options);
std::vector<std::vector<Goal>> to_goals_batch(const GoalsBatchLike& values, const Robot& robot,
                                              const Options& options);

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
                    "numpy.typing.ArrayLike | pdoik._core.Goal | collections.abc.Mapping[str, "
                    "numpy.typing.ArrayLike | pdoik._core.Goal]");
PDOIK_OBJECT_CASTER(pdoik::python::GoalsBatchLike,
                    "numpy.typing.ArrayLike | collections.abc.Mapping[str, "
                    "numpy.typing.ArrayLike]");
