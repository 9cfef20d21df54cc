#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pdoik/occupancy.hpp"

namespace pdoik {

/// A vector that is read in place: joint positions, shape (n,), most often.
using VectorIn = Eigen::Ref<const Eigen::VectorXd>;

/// How a joint moves.
enum class JointType {
  Fixed,       ///< does not move
  Revolute,    ///< turns about its axis between two limits [rad]
  Continuous,  ///< turns about its axis without limits [rad]
  Prismatic,   ///< slides along its axis between two limits [m]
};

/// "This joint follows another": position = multiplier * position(joint) + offset.
struct Mimic {
  std::string joint;        ///< the one that is followed, by name
  double multiplier = 1.0;  ///< of its position
  double offset = 0.0;      ///< [rad] or [m]
};

/// One joint as a URDF gives it.
struct JointDescription {
  std::string name;                                                  ///< of its own
  JointType type = JointType::Fixed;                                 ///< how it moves
  std::string parent_link;                                           ///< by name
  std::string child_link;                                            ///< by name
  Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();  ///< at position zero
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();                   ///< in the child frame
  double lower = -std::numeric_limits<double>::infinity();           ///< [rad] or [m]
  double upper = std::numeric_limits<double>::infinity();            ///< [rad] or [m]
  double velocity = std::numeric_limits<double>::infinity();         ///< [rad/s] or [m/s]
  double effort = std::numeric_limits<double>::infinity();           ///< [N m] or [N]
  std::optional<Mimic> mimic;  ///< whom it follows; none for a joint of its own
};

/// One link as a URDF gives it. The solver of arms ignores masses; they are kept for balance.
struct LinkDescription {
  std::string name;                                          ///< of its own
  double mass = 0.0;                                         ///< [kg]
  Eigen::Vector3d center_of_mass = Eigen::Vector3d::Zero();  ///< in the link frame [m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();         ///< about the centre of mass [kg m^2]
};

/// A robot before it has a base: links and joints in any order.
struct RobotDescription {
  std::string name;                      ///< of the whole
  std::vector<LinkDescription> links;    ///< one of which is no joint's child, the root
  std::vector<JointDescription> joints;  ///< each joins two of the links
  std::vector<std::string> warnings;  ///< of what was assumed; the Robot made of it has them, too
};

/// Read a URDF with urdfdom, as links and joints that may be added to before they become a Robot
/// (see floating_base.hpp). In pdoik::io.
/// @param path_or_xml  A file's path, or the XML text itself (recognised by its leading '<').
/// @throws LoadError  unreadable file, malformed XML, a type of joint that is not supported.
RobotDescription load_urdf(const std::string& path_or_xml);

/// Links and joints of a robot shipped with the library, to be placed in the world or set afloat.
/// In pdoik::io.
/// @throws std::invalid_argument listing the names there are.
RobotDescription builtin_description(const std::string& name);

/// Two links by name, in any order.
using LinkPair = std::pair<std::string, std::string>;

/// A row of a proximal Denavit-Hartenberg table (Craig; Eq. DH_matrix with entry (2,4) = -d
/// sin(alpha)): T = Rx(alpha) Tx(a) Rz(theta) Tz(d). For a prismatic row the variable adds to d.
struct DhRow {
  double alpha = 0.0;                                       ///< [rad]
  double a = 0.0;                                           ///< [m]
  double d = 0.0;                                           ///< [m]
  double theta_offset = 0.0;                                ///< added to the joint angle [rad]
  double lower = -std::numeric_limits<double>::infinity();  ///< [rad] or [m]
  double upper = std::numeric_limits<double>::infinity();   ///< [rad] or [m]
  bool prismatic = false;                                   ///< slides along z, else turns about it
};

/// A moving frame: its z axis is the axis of the joint that moves it, so that every joint turns
/// about or slides along its own z, as the proximal DH frames of the paper do. Body 0 is the base
/// and never moves.
struct Body {
  int parent = -1;  ///< a smaller index; -1 for the base
  Eigen::Isometry3d T_parent_joint = Eigen::Isometry3d::Identity();  ///< at position zero
  bool prismatic = false;  ///< slides along z, else turns about it
  int dof = -1;            ///< the entry of q that moves it
  double multiplier =
      1.0;  ///< position = multiplier * q[dof] + offset: other than 1, 0 for mimic joints
  double offset = 0.0;  ///< [rad] or [m], see multiplier
};

/// A robot as the solver sees it: a tree of bodies from a chosen base, with links attached to them.
///
/// `joint_names` are ordered depth first from the base, siblings by joint name (Pinocchio's order);
/// fixed and mimic joints have no entry in q. A robot is a handle: copies share all there is, and
/// any number of threads may use them at once. set_occupancy and set_ignored_pairs change the one
/// they are called on, and none of its copies.
class Robot {
 public:
  /// @name Making one
  /// @{

  /// A robot from links and joints in any order.
  /// @param base_link  Any link of the tree; empty takes the description's root.
  /// @param tip_links  Links that goals may be given for; empty takes every leaf.
  /// @throws LoadError naming a missing link, a tip named twice, a second parent, a loop, limits
  /// out of order, a negative speed limit, a zero axis, an origin that is no rigid transform to
  /// 1e-6, a number beyond 1e6.
  explicit Robot(const RobotDescription& description, const std::string& base_link = {},
                 const std::vector<std::string>& tip_links = {});

  /// Robot(load_urdf(path_or_xml), base_link, tip_links). In pdoik::io.
  /// @throws LoadError  the constructor's and load_urdf's.
  static Robot from_urdf(const std::string& path_or_xml, const std::string& base_link = {},
                         const std::vector<std::string>& tip_links = {});

  /// A serial arm from DH rows: links link0 ... linkM and `tool` (offset T_last_tool), joints
  /// joint1 ... jointM.
  static Robot from_dh(const std::vector<DhRow>& rows,
                       const Eigen::Isometry3d& T_last_tool = Eigen::Isometry3d::Identity());

  /// A robot shipped with the library: "panda", "ur10", "iiwa14" or "h1", with its occupancy and
  /// ignored pairs. In pdoik::io.
  /// @throws std::invalid_argument listing the names there are.
  /// @throws LoadError as the constructor.
  static Robot builtin(const std::string& name, const std::string& base_link = {},
                       const std::vector<std::string>& tip_links = {});
  /// Names of the shipped robots, sorted. In pdoik::io.
  static std::vector<std::string> builtin_names();
  /// @}

  /// @name Joints, links and limits
  /// @{

  /// The description's.
  const std::string& name() const { return parts_->name; }
  /// n, the number of joints that q has entries for.
  int dof() const { return static_cast<int>(parts_->joint_names.size()); }
  /// Of the n joints, in q's order.
  const std::vector<std::string>& joint_names() const { return parts_->joint_names; }
  /// All links, depth first from the base.
  const std::vector<std::string>& link_names() const { return parts_->link_names; }
  /// The link whose frame is the base frame.
  const std::string& base_link() const { return parts_->link_names.front(); }
  /// Indices of the links that goals may be given for, into link_names.
  const std::vector<int>& tips() const { return parts_->tips; }
  /// Their names.
  std::vector<std::string> tip_links() const;

  /// Lower joint limits, shape (n,), [rad] or [m]; minus infinity for continuous joints.
  const Eigen::VectorXd& lower() const { return parts_->lower; }
  /// Upper joint limits, shape (n,), [rad] or [m]; infinity for continuous joints.
  const Eigen::VectorXd& upper() const { return parts_->upper; }
  /// Speed limits of the joints, shape (n,), [rad/s] or [m/s]; infinite where the description gives
  /// none.
  const Eigen::VectorXd& velocity() const { return parts_->velocity; }
  /// Effort limits of the joints, shape (n,), [N m] or [N]; infinite where the description gives
  /// none.
  const Eigen::VectorXd& effort() const { return parts_->effort; }
  /// How each of the n joints moves.
  const std::vector<JointType>& joint_types() const { return parts_->joint_types; }
  /// The middle of each joint's range, 0 for joints without limits, shape (n,).
  Eigen::VectorXd mid_configuration() const;
  /// @}

  /// @name Kinematics
  /// @{

  /// Pose of a link in the base frame.
  /// @param q  shape (n,), [rad] or [m].
  /// @param link  An index from `link_index`, or -1 for the (first) tip.
  /// @throws std::invalid_argument on a wrong length.
  Eigen::Isometry3d fk(VectorIn q, int link = -1) const;
  /// The same of a link by name.
  Eigen::Isometry3d fk(VectorIn q, const std::string& link) const {
    return fk(q, link_index(link));
  }

  /// Geometric Jacobian of a link's origin, shape (6, n): three linear rows, then three angular
  /// ones, both in the base frame's axes (Pinocchio's LOCAL_WORLD_ALIGNED).
  Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian(VectorIn q, int link = -1) const;

  /// The sum of all links' masses, the base's included [kg].
  double total_mass() const;
  /// Mean of the links' centres of mass weighted by their masses, the base's included, in the base
  /// frame [m].
  /// @throws std::invalid_argument if the masses do not sum up to a positive number.
  Eigen::Vector3d center_of_mass(VectorIn q) const;
  /// Derivative of the centre of mass with respect to q, shape (3, n).
  Eigen::Matrix3Xd center_of_mass_jacobian(VectorIn q) const;

  /// Poses of all bodies in the base frame, into a vector sized beforehand. Allocates nothing.
  void body_poses(VectorIn q, std::vector<Eigen::Isometry3d>& T_base_body) const;
  /// @}

  /// @name Links and bodies
  /// @{

  /// A link's place in link_names.
  /// @throws std::invalid_argument that names the link and the robot's links.
  int link_index(std::string_view name) const;
  /// The same; none where there is no such link.
  std::optional<int> find_link(std::string_view name) const;
  /// Mass, centre of mass and inertia of each link, ordered as link_names.
  const std::vector<LinkDescription>& links() const { return parts_->links; }

  /// The frames that move, each after its parent; the base first.
  const std::vector<Body>& bodies() const { return parts_->bodies; }
  /// The body a link is attached to: T_base_link = T_base_body * T_body_link.
  int body_of_link(int link) const { return parts_->link_body[static_cast<std::size_t>(link)]; }
  /// How a link is attached to its body.
  const Eigen::Isometry3d& T_body_link(int link) const {
    return parts_->T_body_link[static_cast<std::size_t>(link)];
  }
  /// @}

  /// @name What it fills
  /// @{

  /// What the robot fills, as seen by the solver. Empty until set, except for built-in robots.
  const Occupancy& occupancy() const { return parts_->occupancy; }
  /// Say what the robot fills, for solvers that are made afterwards.
  /// @throws std::invalid_argument naming an unknown link, a radius that is not positive or is
  /// beyond 1e6 m, or a semi-major axis that is not longer than half the distance between foci on
  /// one link.
  void set_occupancy(Occupancy occupancy);

  /// Links whose hulls may touch each other, besides those that are joined (see
  /// collision_pairs.hpp). Empty until set.
  const std::vector<LinkPair>& ignored_pairs() const { return parts_->ignored_pairs; }
  /// Say what may touch, for solvers that are made afterwards.
  /// @throws std::invalid_argument naming an unknown link.
  void set_ignored_pairs(std::vector<LinkPair> pairs);
  /// @}

  /// @name Its description
  /// @{

  /// What the robot was made of: Robot(description(), base_link(), tip_links()) is another like it,
  /// but for occupancy and ignored pairs.
  const RobotDescription& description() const { return parts_->description; }

  /// Oddities of the description that do not stop kinematics (inertias that are not physical, ...).
  const std::vector<std::string>& warnings() const { return parts_->warnings; }
  /// @}

 private:
  struct Parts {
    RobotDescription description;
    std::string name;
    std::vector<std::string> joint_names;
    std::vector<JointType> joint_types;
    Eigen::VectorXd lower, upper, velocity, effort;
    std::vector<std::string> link_names;
    std::vector<LinkDescription> links;
    std::vector<int> link_body;
    std::vector<Eigen::Isometry3d> T_body_link;
    std::vector<Body> bodies;
    std::vector<int> tips;
    Occupancy occupancy;
    std::vector<LinkPair> ignored_pairs;
    std::vector<std::string> warnings;
  };
  std::shared_ptr<const Parts> parts_;
};

}  // namespace pdoik
