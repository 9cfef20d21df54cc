#include "robot_state.hpp"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace pdoik::python {

namespace py = pybind11;

namespace {

py::tuple state_of(const LinkDescription& link) {
  return py::make_tuple(link.name, link.mass, link.center_of_mass, link.inertia);
}

LinkDescription link_from(const py::tuple& state) {
  return {state[0].cast<std::string>(), state[1].cast<double>(), state[2].cast<Eigen::Vector3d>(),
          state[3].cast<Eigen::Matrix3d>()};
}

py::tuple state_of(const JointDescription& joint) {
  py::object mimic = py::none();
  if (joint.mimic)
    mimic = py::make_tuple(joint.mimic->joint, joint.mimic->multiplier, joint.mimic->offset);
  return py::make_tuple(joint.name, static_cast<int>(joint.type), joint.parent_link,
                        joint.child_link, joint.T_parent_child.matrix(), joint.axis, joint.lower,
                        joint.upper, joint.velocity, joint.effort, mimic);
}

JointDescription joint_from(const py::tuple& state) {
  JointDescription joint;
  joint.name = state[0].cast<std::string>();
  joint.type = static_cast<JointType>(state[1].cast<int>());
  joint.parent_link = state[2].cast<std::string>();
  joint.child_link = state[3].cast<std::string>();
  joint.T_parent_child.matrix() = state[4].cast<Eigen::Matrix4d>();
  joint.axis = state[5].cast<Eigen::Vector3d>();
  joint.lower = state[6].cast<double>();
  joint.upper = state[7].cast<double>();
  joint.velocity = state[8].cast<double>();
  joint.effort = state[9].cast<double>();
  if (!state[10].is_none()) {
    const auto mimic = state[10].cast<py::tuple>();
    joint.mimic =
        Mimic{mimic[0].cast<std::string>(), mimic[1].cast<double>(), mimic[2].cast<double>()};
  }
  return joint;
}

}  // namespace

RobotState state_of(const Robot& robot) {
  const RobotDescription& description = robot.description();
  py::list links, joints;
  for (const LinkDescription& link : description.links) links.append(state_of(link));
  for (const JointDescription& joint : description.joints) joints.append(state_of(joint));
  return py::make_tuple(description.name, links, joints, robot.base_link(), robot.tip_links(),
                        robot.occupancy(), robot.ignored_pairs());
}

Robot robot_from(const RobotState& state) {
  RobotDescription description;
  description.name = state[0].cast<std::string>();
  for (const py::handle link : state[1].cast<py::list>())
    description.links.push_back(link_from(link.cast<py::tuple>()));
  for (const py::handle joint : state[2].cast<py::list>())
    description.joints.push_back(joint_from(joint.cast<py::tuple>()));
  Robot robot(description, state[3].cast<std::string>(), state[4].cast<std::vector<std::string>>());
  robot.set_occupancy(state[5].cast<Occupancy>());
  robot.set_ignored_pairs(state[6].cast<std::vector<LinkPair>>());
  return robot;
}

}  // namespace pdoik::python
