#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <variant>

#include "arrays.hpp"
#include "bind.hpp"
#include "cloud.hpp"
#include "errors.hpp"
#include "names.hpp"
#include "paths.hpp"
#include "pdoik/collision_pairs.hpp"
#include "pdoik/floating_base.hpp"
#include "pdoik/robot.hpp"
#include "robot_state.hpp"
#include "without_gil.hpp"

namespace pdoik::python {
namespace {

using TipLinks = std::optional<std::variant<std::string, std::vector<std::string>>>;

std::vector<std::string> to_list(const TipLinks& tips) {
  if (!tips) return {};
  if (const auto* one = std::get_if<std::string>(&*tips)) return {*one};
  return std::get<std::vector<std::string>>(*tips);
}

Robot with_warnings(Robot robot) {
  for (const std::string& message : robot.warnings()) warn(message);
  return robot;
}

using Bounds = std::tuple<ArrayLike, ArrayLike>;

/// A robot from its description: from one of its links, or standing or going about in the world.
Robot placed(const RobotDescription& description, const std::optional<std::string>& base_link,
             const TipLinks& tip_link, const std::optional<Eigen::Isometry3d>& T_world_base,
             const std::optional<FloatingBaseBounds>& floating_base) {
  const auto base = [&] { return base_link ? *base_link : Robot(description).base_link(); };
  if (T_world_base && floating_base)
    throw std::invalid_argument("T_world_base and floating_base are both given, expected one");
  if (T_world_base)
    return Robot(mounted(description, base(), *T_world_base), "world", to_list(tip_link));
  if (floating_base)
    return Robot(with_floating_base(description, base(), *floating_base), "world",
                 to_list(tip_link));
  return Robot(description, base_link.value_or(""), to_list(tip_link));
}

std::optional<Eigen::Isometry3d> to_placement(const std::optional<ArrayLike>& T_world_base) {
  if (!T_world_base) return std::nullopt;
  return to_isometry(*T_world_base, "T_world_base");
}

std::optional<FloatingBaseBounds> to_bounds(const std::optional<Bounds>& floating_base) {
  if (!floating_base) return std::nullopt;
  return FloatingBaseBounds{to_vector(std::get<0>(*floating_base), "floating_base: lower", 6),
                            to_vector(std::get<1>(*floating_base), "floating_base: upper", 6)};
}

Robot from_urdf(const PathOrText& path_or_xml, const std::optional<std::string>& base_link,
                const TipLinks& tip_link, const std::optional<ArrayLike>& T_world_base,
                const std::optional<Bounds>& floating_base, const std::optional<PathOrText>& srdf) {
  const auto T = to_placement(T_world_base);
  const auto bounds = to_bounds(floating_base);
  const auto load = [&] {
    const WithoutGil release;
    Robot robot = placed(load_urdf(path_or_xml.value), base_link, tip_link, T, bounds);
    if (srdf) robot.set_ignored_pairs(load_srdf_pairs(srdf->value, robot));
    return robot;
  };
  return with_warnings(load());
}

Robot builtin(const std::string& name, const std::optional<std::string>& base_link,
              const TipLinks& tip_link, const std::optional<ArrayLike>& T_world_base,
              const std::optional<Bounds>& floating_base) {
  Robot robot = placed(builtin_description(name), base_link, tip_link, to_placement(T_world_base),
                       to_bounds(floating_base));
  const Robot known = Robot::builtin(name);
  robot.set_occupancy(known.occupancy());
  robot.set_ignored_pairs(known.ignored_pairs());
  return with_warnings(std::move(robot));
}

Robot from_dh(const std::vector<DhRow>& rows, const std::optional<ArrayLike>& T_last_tool) {
  return Robot::from_dh(
      rows, T_last_tool ? to_isometry(*T_last_tool, "T_last_tool") : Eigen::Isometry3d::Identity());
}

int link_or_tip(const Robot& robot, const std::optional<std::string>& link) {
  return link ? robot.link_index(*link) : -1;
}

std::vector<JointTypeName> joint_types(const Robot& robot) {
  std::vector<JointTypeName> result;
  for (const JointType type : robot.joint_types()) {
    result.push_back(py::reinterpret_borrow<JointTypeName>(py::str(to_name(type))));
  }
  return result;
}

Eigen::VectorXd link_masses(const Robot& robot) {
  Eigen::VectorXd result(static_cast<Eigen::Index>(robot.links().size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result[i] = robot.links()[static_cast<std::size_t>(i)].mass;
  return result;
}

RowMatrix link_centers_of_mass(const Robot& robot) {
  RowMatrix result(static_cast<Eigen::Index>(robot.links().size()), 3);
  for (Eigen::Index i = 0; i < result.rows(); ++i) {
    result.row(i) = robot.links()[static_cast<std::size_t>(i)].center_of_mass.transpose();
  }
  return result;
}

void bind_dh_row(py::module_& module) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  py::class_<DhRow>(module, "DhRow",
                    R"(A row of a proximal Denavit-Hartenberg table (Craig; Eq. DH_matrix).

T = Rx(alpha) Tx(a) Rz(theta + theta_offset) Tz(d); for a prismatic row the variable adds to d.)")
      .def(py::init([](double alpha, double a, double d, double theta_offset, double lower,
                       double upper, bool prismatic) {
             return DhRow{alpha, a, d, theta_offset, lower, upper, prismatic};
           }),
           py::kw_only(), py::arg("alpha") = 0.0, py::arg("a") = 0.0, py::arg("d") = 0.0,
           py::arg("theta_offset") = 0.0, py::arg("lower") = -kInfinity,
           py::arg("upper") = kInfinity, py::arg("prismatic") = false,
           "Metres and radians; without limits a revolute row is continuous.")
      .def_readonly("alpha", &DhRow::alpha, "[rad]")
      .def_readonly("a", &DhRow::a, "[m]")
      .def_readonly("d", &DhRow::d, "[m]")
      .def_readonly("theta_offset", &DhRow::theta_offset, "[rad]")
      .def_readonly("lower", &DhRow::lower, "[rad] or [m]")
      .def_readonly("upper", &DhRow::upper, "[rad] or [m]")
      .def_readonly("prismatic", &DhRow::prismatic)
      .def("__repr__", [](const DhRow& r) {
        return py::str(
                   "DhRow(alpha={}, a={}, d={}, theta_offset={}, lower={}, upper={}, prismatic={})")
            .format(r.alpha, r.a, r.d, r.theta_offset, r.lower, r.upper, r.prismatic);
      });
}

void def_constructors(py::class_<Robot>& robot) {
  robot
      .def_static("from_urdf", &from_urdf, py::arg("path_or_xml"),
                  py::arg("base_link") = py::none(), py::arg("tip_link") = py::none(),
                  py::kw_only(), py::arg("T_world_base") = py::none(),
                  py::arg("floating_base") = py::none(), py::arg("srdf") = py::none(),
                  "Read a URDF; pdoik.descriptions.ways puts xacro, packages and hulls before it.")
      .def_static(
          "from_dh", &from_dh, py::arg("rows"), py::arg("T_last_tool") = py::none(),
          R"(A serial arm from DH rows: links link0 ... linkM and `tool`, joints joint1 ... jointM.

Args:
    rows: One per joint.
    T_last_tool: Pose of `tool` in the last link's frame, shape (4, 4). None for the identity.)")
      .def_static("builtin", &builtin, py::arg("name"), py::arg("base_link") = py::none(),
                  py::arg("tip_link") = py::none(), py::kw_only(),
                  py::arg("T_world_base") = py::none(), py::arg("floating_base") = py::none(),
                  R"(A robot shipped with the library, with its occupancy and ignored pairs.

Args:
    name: panda, ur10, iiwa14 or h1 (see `builtin_names`).
    base_link: As for `from_urdf`, like the others.
    tip_link: By default the arms' tool flange, and H1's ankles and elbows.
    T_world_base: Where the base link stands.
    floating_base: Bounds on where it may go.

Raises:
    ValueError: There is no such robot.
    LoadError: There is no such link.)")
      .def_static("builtin_names", &Robot::builtin_names, "The robots that `builtin` knows.")
      .def("__copy__", [](const Robot& self) { return Robot(self); })
      .def(
          "__deepcopy__", [](const Robot& self, const py::object&) { return Robot(self); },
          py::arg("memo"));
}

void def_properties(py::class_<Robot>& robot) {
  robot.def_property_readonly("name", &Robot::name)
      .def_property_readonly("dof", &Robot::dof,
                             "n, the number of joints that a configuration has entries for.")
      .def_property_readonly("joint_names", &Robot::joint_names,
                             "The n joints, depth first from the base, siblings by name; without "
                             "fixed and mimic ones.")
      .def_property_readonly("joint_types", &joint_types, "Of the n joints.")
      .def_property_readonly("link_names", &Robot::link_names,
                             "All links, depth first from the base.")
      .def_property_readonly("base_link", &Robot::base_link,
                             "The link whose frame is the base frame.")
      .def_property_readonly("tip_links", &Robot::tip_links,
                             "The links that goals may be given for.")
      .def_property_readonly("lower", &Robot::lower,
                             "Shape (n,) [rad] or [m]; -inf for continuous joints.")
      .def_property_readonly("upper", &Robot::upper,
                             "Shape (n,) [rad] or [m]; inf for continuous joints.")
      .def_property_readonly(
          "velocity", &Robot::velocity,
          "Speed limits, shape (n,) [rad/s] or [m/s]; inf where the description gives none.")
      .def_property_readonly(
          "effort", &Robot::effort,
          "Effort limits, shape (n,) [N m] or [N]; inf where the description gives none.")
      .def_property_readonly("total_mass", &Robot::total_mass,
                             "Of all links, the base's included [kg].")
      .def_property_readonly("link_masses", &link_masses, "Shape (L,), ordered as link_names [kg].")
      .def_property_readonly("link_centers_of_mass", &link_centers_of_mass,
                             "In the links' frames, shape (L, 3), ordered as link_names [m].")
      .def_property_readonly("warnings", &Robot::warnings, "What RobotWarning was issued for.")
      .def_property("ignored_pairs", &Robot::ignored_pairs, &Robot::set_ignored_pairs,
                    R"(Pairs of links whose hulls may touch, besides links that are joined.

Solvers made afterwards keep to it. See `load_srdf_pairs`, `pairs_always_touching` and `pairs_touching_at`.

Raises:
    ValueError: On setting: a link is unknown.)")
      .def_property("occupancy", &Robot::occupancy, &Robot::set_occupancy,
                    py::return_value_policy::copy,
                    R"(What the robot fills. Solvers made afterwards keep to it.

Raises:
    ValueError: On setting: a link is unknown, a radius is not positive and finite, or a semi-major axis is
        not longer than half the distance between its foci on one link.)");
}

void def_kinematics(py::class_<Robot>& robot) {
  robot
      .def(
          "fk",
          [](const Robot& self, const ArrayLike& q,
             const std::optional<std::string>& link) -> Matrix4 {
            return self.fk(to_vector(q, "q", self.dof()), link_or_tip(self, link)).matrix();
          },
          py::arg("q"), py::arg("link") = py::none(), R"(Pose of a link in the base frame.

Args:
    q: Joint positions, shape (n,) [rad] or [m]; limits are not enforced.
    link: A link's name. None for the tip, if there is one only.

Returns:
    T_base_link, shape (4, 4) [m].

Raises:
    ValueError: q has another shape or holds NaN or infinity, or there is no such link.)")
      .def(
          "self_filter",
          [](const Robot& self, ThinnedCloud& cloud, const ArrayLike& q, double padding) {
            const Eigen::VectorXd at = to_vector(q, "q", self.dof());
            const WithoutGil release;
            return cloud.cloud.remove_robot(self, at, padding);
          },
          py::arg("cloud"), py::arg("q"), py::kw_only(), py::arg("padding") = 0.0,
          R"(Take the robot's own surface out of a cloud: points in its hulls, or within a distance of them.

Args:
    cloud: Changed in place.
    q: Where the robot was when the camera saw it, shape (n,) [rad] or [m].
    padding: For what noise and calibration hide [m].

Returns:
    How many points were taken out.

Raises:
    ValueError: q has another shape or holds NaN or infinity, padding is negative, or the robot has no
        occupancy.)")
      .def(
          "self_filter",
          [](const Robot& self, const ArrayLike& points, const ArrayLike& q, double padding) {
            const Eigen::VectorXd at = to_vector(q, "q", self.dof());
            const PointsView view = PointsView::float64(points, "points");
            Cloud cloud(view.in_double());
            cloud.remove_robot(self, at, padding);
            std::vector<int> left = cloud.ids();
            std::sort(left.begin(), left.end());
            return RowMatrix(view.in_double()(left, Eigen::all));
          },
          py::arg("points"), py::arg("q"), py::kw_only(), py::arg("padding") = 0.0,
          R"(The same for an array of points, shape (N, 3) or (N, 4) [m]; gives those that are left, in order.)")
      .def(
          "jacobian",
          [](const Robot& self, const ArrayLike& q,
             const std::optional<std::string>& link) -> Matrix6X {
            return self.jacobian(to_vector(q, "q", self.dof()), link_or_tip(self, link));
          },
          py::arg("q"), py::arg("link") = py::none(), R"(Geometric Jacobian of a link's origin.

Args:
    q: Joint positions, shape (n,) [rad] or [m].
    link: A link's name. None for the tip, if there is one only.

Returns:
    Shape (6, n): three linear rows, then three angular ones, both in the base frame's axes (Pinocchio's
    LOCAL_WORLD_ALIGNED).

Raises:
    ValueError: q has another shape or holds NaN or infinity, or there is no such link.)")
      .def(
          "center_of_mass",
          [](const Robot& self, const ArrayLike& q) {
            return self.center_of_mass(to_vector(q, "q", self.dof()));
          },
          py::arg("q"), R"(Of all links by their masses, the base's included, in the base frame.

Args:
    q: Joint positions, shape (n,) [rad] or [m].

Returns:
    Shape (3,) [m].

Raises:
    ValueError: q has another shape or holds NaN or infinity, or the links have no mass.)")
      .def(
          "center_of_mass_jacobian",
          [](const Robot& self, const ArrayLike& q) -> Matrix3X {
            return self.center_of_mass_jacobian(to_vector(q, "q", self.dof()));
          },
          py::arg("q"), R"(Derivative of the centre of mass by q.

Args:
    q: Joint positions, shape (n,) [rad] or [m].

Returns:
    Shape (3, n), in the base frame's axes.

Raises:
    ValueError: As `center_of_mass`.)")
      .def("mid_configuration", &Robot::mid_configuration,
           "The middle of each joint's range, 0 for joints without limits, shape (n,).")
      .def("__repr__", [](const Robot& self) {
        return py::str("<Robot {}: {} joints, {} to {}>")
            .format(self.name(), self.dof(), self.base_link(),
                    py::str(", ").attr("join")(self.tip_links()));
      });
}

}  // namespace

namespace {

void bind_pairs(py::module_& module) {
  module.def(
      "load_srdf_pairs",
      [](const PathOrText& path_or_xml, const std::optional<Robot>& robot) {
        return robot ? load_srdf_pairs(path_or_xml.value, *robot)
                     : load_srdf_pairs(path_or_xml.value);
      },
      py::arg("path_or_xml"), py::arg("robot") = py::none(),
      R"(The pairs of links that an SRDF file, MoveIt's companion of a URDF, disables collisions for.

Args:
    path_or_xml: A file's path, or the XML text itself (recognised by its leading "<").
    robot: Leave out pairs of links that this robot has not; None for all pairs. A file with
        `<disable_default_collisions>`, which means pairs with all links, needs it.

Raises:
    LoadError: The file cannot be read, or says what pairs cannot.)");
  module.def(
      "load_srdf_contacts",
      [](const PathOrText& path_or_xml) { return load_srdf_contacts(path_or_xml.value); },
      py::arg("path_or_xml"),
      R"(What an SRDF says of collisions as rules of contact, for a Scene: `load_srdf_pairs` for more than links.

A link whose collisions it disables by default may then touch shapes, points and what is carried as well. All rules
are optional: an SRDF may be of a description with more links.

Args:
    path_or_xml: A file's path, or the XML text itself (recognised by its leading "<").

Raises:
    LoadError: The file cannot be read.)");
  module.def("pairs_always_touching", &pairs_always_touching, py::arg("robot"),
             py::arg("samples") = 2000, py::arg("seed") = 0, py::arg("share") = 0.95,
             R"(Pairs of links that touch in at least a share of random configurations.

As MoveIt's Setup Assistant finds them: links that are close but not joined, whose overlap says nothing.

Args:
    robot: Its occupancy counts.
    samples: Configurations, uniform within limits.
    seed: The same seed gives the same answer.
    share: In (0, 1].

Raises:
    ValueError: A number is out of range.)");
  module.def(
      "pairs_touching_at",
      [](const Robot& robot, const ArrayLike& q) {
        return pairs_touching_at(robot, to_vector(q, "q", robot.dof()));
      },
      py::arg("robot"), py::arg("q"),
      R"(Pairs of links that touch at a configuration which is known to be free.

Args:
    robot: Its occupancy counts.
    q: Joint positions, shape (n,) [rad] or [m].

Raises:
    ValueError: q has another shape or holds NaN or infinity.)");
}

}  // namespace

void bind_robot(py::module_& module) {
  bind_dh_row(module);
  py::class_<Robot> robot(module, "Robot",
                          R"(A tree of links and joints seen from a chosen base link.

Nothing but its occupancy and ignored pairs can be changed.)");
  robot.def(py::pickle(&state_of, &robot_from));
  def_constructors(robot);
  def_properties(robot);
  def_kinematics(robot);
  bind_pairs(module);
}

}  // namespace pdoik::python
