#include "kinematics/tree_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "common/check_input.hpp"
#include "common/infinity.hpp"
#include "common/text.hpp"
#include "kinematics/inertia_check.hpp"
#include "pdoik/errors.hpp"

namespace pdoik::detail {
namespace {

/// A rotation that takes z to a unit vector. The shortest one is ill-defined near -z: there it
/// starts from -z.
Eigen::Matrix3d rotation_of_z_to(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d pole(0.0, 0.0, axis.z() < 0.0 ? -1.0 : 1.0);
  Eigen::Matrix3d R =
      Eigen::Quaterniond::FromTwoVectors(pole, axis).normalized().toRotationMatrix();
  if (axis.z() < 0.0) R.rightCols<2>() *= -1.0;  // after half a turn about x
  return R;
}

/// Builds the tree by walking the description's joints away from the base, turning round those it
/// meets from their child's side.
class TreeBuilder {
 public:
  explicit TreeBuilder(const RobotDescription& description) : description_(description) {
    index_links();
    index_joints();
    check_is_tree();
  }

  Tree build(const std::string& base_link) {
    const std::size_t base = base_link.empty() ? root() : link(base_link, "base link");
    tree_.bodies.emplace_back();
    visit(base, kNone, 0, Eigen::Isometry3d::Identity());
    tree_.warnings = description_.warnings;
    assign_dofs();
    for (const LinkDescription& each : tree_.links) {
      const std::string error = inertia_error(each);
      if (!error.empty()) tree_.warnings.push_back(error);
    }
    return std::move(tree_);
  }

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  struct Neighbour {
    std::size_t joint;
    std::size_t link;
  };

  [[noreturn]] void fail(const std::string& what) const {
    throw LoadError("robot '" + description_.name + "': " + what);
  }

  std::size_t link(const std::string& name, const std::string& role) const {
    const auto found = link_index_.find(name);
    if (found == link_index_.end()) {
      std::vector<std::string> names;
      for (const auto& each : link_index_) names.push_back(each.first);
      fail(role + " '" + name + "' is not there (links: " + join(names) + ")");
    }
    return found->second;
  }

  void index_links() {
    if (description_.links.empty()) fail("has no links");
    for (std::size_t i = 0; i < description_.links.size(); ++i) {
      if (!link_index_.emplace(description_.links[i].name, i).second) {
        fail("two links are named '" + description_.links[i].name + "'");
      }
    }
    neighbours_.resize(description_.links.size());
    parent_joint_.assign(description_.links.size(), kNone);
  }

  void index_joints() {
    for (std::size_t j = 0; j < description_.joints.size(); ++j) {
      const JointDescription& joint = description_.joints[j];
      check_joint(joint);
      if (!joint_index_.emplace(joint.name, j).second)
        fail("two joints are named '" + joint.name + "'");
      const std::size_t parent = link(joint.parent_link, "joint '" + joint.name + "': parent link");
      const std::size_t child = link(joint.child_link, "joint '" + joint.name + "': child link");
      if (parent == child)
        fail("joint '" + joint.name + "' joins link '" + joint.child_link + "' to itself");
      if (parent_joint_[child] != kNone) {
        fail("link '" + joint.child_link + "' has two parents, by joints '" +
             description_.joints[parent_joint_[child]].name + "' and '" + joint.name +
             "': loops are not supported");
      }
      parent_joint_[child] = j;
      neighbours_[parent].push_back({j, child});
      neighbours_[child].push_back({j, parent});
    }
    for (auto& list : neighbours_) {
      std::sort(list.begin(), list.end(), [&](const Neighbour& a, const Neighbour& b) {
        return description_.joints[a.joint].name < description_.joints[b.joint].name;
      });
    }
  }

  void check_joint(const JointDescription& joint) const {
    const std::string what = "joint '" + joint.name + "': ";
    if (!joint.T_parent_child.matrix().allFinite()) fail(what + "origin is not finite");
    if (joint.T_parent_child.translation().cwiseAbs().maxCoeff() > kLargestNumber)
      fail(what + "origin has a number beyond 1e6 m");
    if (!is_rigid(joint.T_parent_child)) fail(what + "origin is not a rigid transform");
    if (joint.type == JointType::Fixed) return;
    const double length = joint.axis.norm();
    if (!(length > 1e-9) || !std::isfinite(length)) {
      fail(what + "axis has length " + std::to_string(length) + ", expected a direction");
    }
    for (const auto& [name, limit] :
         {std::pair{"velocity", joint.velocity}, std::pair{"effort", joint.effort}}) {
      if (!(limit >= 0.0))  // infinity is fine
        fail(what + name + " limit is " + std::to_string(limit) + ", expected at least 0");
    }
    if (joint.type == JointType::Continuous) return;
    if (std::isnan(joint.lower) || std::isnan(joint.upper)) fail(what + "limits are not numbers");
    if (leaves_no_range(joint)) return;  // which follows all the same: assign_dofs says so
    if (joint.lower > joint.upper) {
      fail(what + "lower limit " + std::to_string(joint.lower) + " is above its upper limit " +
           std::to_string(joint.upper));
    }
    if (std::isinf(joint.lower) != std::isinf(joint.upper)) {
      fail(what + "one limit is finite and the other is not");
    }
    if (std::isinf(joint.lower) && joint.lower == joint.upper) {
      fail(what + "both limits are " + std::to_string(joint.lower));
    }
    if (joint.type == JointType::Revolute && (std::isinf(joint.lower) || std::isinf(joint.upper))) {
      fail(what + "is revolute with an infinite limit: expected finite limits or type continuous");
    }
  }

  /// Whether the limits are none that a joint which follows another could move between: files fill
  /// them in because URDF wants some, as [0, 0] or the wrong way round. A joint of its own that has
  /// a single position is locked on purpose.
  static bool leaves_no_range(const JointDescription& joint) {
    return joint.mimic && joint.type != JointType::Continuous && !(joint.lower < joint.upper);
  }

  /// With one parent each at most, a graph is a tree exactly when one link has none and all are
  /// reached.
  void check_is_tree() const {
    std::vector<std::string> roots;
    for (std::size_t i = 0; i < parent_joint_.size(); ++i) {
      if (parent_joint_[i] == kNone) roots.push_back(description_.links[i].name);
    }
    if (roots.empty()) fail("every link has a parent: the joints form a loop");
    if (roots.size() > 1) fail("links " + join(roots) + " all lack a parent: expected one tree");
    std::vector<std::size_t> stack{link_index_.at(roots.front())};
    std::vector<bool> seen(parent_joint_.size(), false);
    std::size_t count = 0;
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      if (seen[at]) continue;
      seen[at] = true;
      ++count;
      for (const Neighbour& next : neighbours_[at]) stack.push_back(next.link);
    }
    if (count == seen.size()) return;
    std::vector<std::string> lost;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (!seen[i]) lost.push_back(description_.links[i].name);
    }
    fail("links " + join(lost) + " form a loop that is not joined to the rest");
  }

  std::size_t root() const {
    for (std::size_t i = 0; i < parent_joint_.size(); ++i) {
      if (parent_joint_[i] == kNone) return i;
    }
    return 0;
  }

  void visit(std::size_t at, std::size_t came_by, int body, const Eigen::Isometry3d& T_body_link) {
    const int own = static_cast<int>(tree_.links.size());
    tree_.links.push_back(description_.links[at]);
    tree_.link_body.push_back(body);
    tree_.T_body_link.push_back(T_body_link);
    bool leaf = true;
    for (const Neighbour& next : neighbours_[at]) {
      if (next.joint == came_by) continue;
      leaf = false;
      const JointDescription& joint = description_.joints[next.joint];
      const bool reversed = link_index_.at(joint.child_link) == at;
      cross(joint, next, reversed, body, T_body_link);
    }
    if (leaf) tree_.leaves.push_back(own);
  }

  void cross(const JointDescription& joint, const Neighbour& next, bool reversed, int body,
             const Eigen::Isometry3d& T_body_link) {
    const Eigen::Isometry3d& X = joint.T_parent_child;
    if (joint.type == JointType::Fixed) {
      visit(next.link, next.joint, body, T_body_link * (reversed ? X.inverse() : X));
      return;
    }
    // X Rot(axis, q) seen from the child's side is Rot(-axis, q) X^-1.
    const Eigen::Vector3d axis = joint.axis.normalized() * (reversed ? -1.0 : 1.0);
    Eigen::Isometry3d A = Eigen::Isometry3d::Identity();
    A.linear() = rotation_of_z_to(axis);
    Body moved;
    moved.parent = body;
    moved.prismatic = joint.type == JointType::Prismatic;
    moved.T_parent_joint = T_body_link * (reversed ? A : X * A);
    tree_.bodies.push_back(moved);
    body_joint_.push_back(joint_index_.at(joint.name));
    const int child_body = static_cast<int>(tree_.bodies.size()) - 1;
    visit(next.link, next.joint, child_body, reversed ? A.inverse() * X.inverse() : A.inverse());
  }

  /// position(joint) = multiplier * position(source) + offset, through any number of mimic joints.
  struct Source {
    std::size_t joint;
    double multiplier;
    double offset;
  };

  Source source_of(std::size_t joint) const {
    Source source{joint, 1.0, 0.0};
    for (std::size_t hops = 0; description_.joints[source.joint].mimic; ++hops) {
      const JointDescription& follower = description_.joints[source.joint];
      const Mimic& mimic = *follower.mimic;
      const auto found = joint_index_.find(mimic.joint);
      if (found == joint_index_.end()) {
        fail("joint '" + follower.name + "' mimics '" + mimic.joint + "', which is not there");
      }
      if (description_.joints[found->second].type == JointType::Fixed) {
        fail("joint '" + follower.name + "' mimics '" + mimic.joint + "', which is fixed");
      }
      if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset)) {
        fail("joint '" + follower.name + "': mimic multiplier or offset is not finite");
      }
      if (hops > description_.joints.size())
        fail("joint '" + follower.name + "' mimics itself in a circle");
      source.offset += source.multiplier * mimic.offset;
      source.multiplier *= mimic.multiplier;
      source.joint = found->second;
    }
    return source;
  }

  void warn_of(const std::string& what, const std::vector<std::string>& joints) {
    if (!joints.empty()) tree_.warnings.push_back(what + join(joints));
  }

  void assign_dofs() {
    std::map<std::size_t, int> dof_of_joint;
    std::vector<double> lower, upper, velocity, effort;
    for (const std::size_t j : body_joint_) {
      const JointDescription& joint = description_.joints[j];
      if (joint.mimic) continue;
      dof_of_joint[j] = static_cast<int>(tree_.joint_names.size());
      tree_.joint_names.push_back(joint.name);
      tree_.joint_types.push_back(joint.type);
      const bool limited = joint.type != JointType::Continuous;
      lower.push_back(limited ? joint.lower : -std::numeric_limits<double>::infinity());
      upper.push_back(limited ? joint.upper : std::numeric_limits<double>::infinity());
      constexpr double kNoLimit = 1e9;  // what files write, too, where there is none
      const auto as_meant = [](double limit) {
        return limit < kNoLimit ? limit : std::numeric_limits<double>::infinity();
      };
      velocity.push_back(as_meant(joint.velocity));
      effort.push_back(as_meant(joint.effort));
    }
    const std::vector<double> own_lower = lower, own_upper = upper;
    std::vector<std::string> without_range;
    for (std::size_t b = 0; b < body_joint_.size(); ++b) {
      const Source source = source_of(body_joint_[b]);
      Body& body = tree_.bodies[b + 1];
      body.dof = dof_of_joint.at(source.joint);
      body.multiplier = source.multiplier;
      body.offset = source.offset;
      if (!(std::abs(body.multiplier) <= kLargestNumber &&
            std::abs(body.offset) <= kLargestNumber)) {
        fail("joint '" + description_.joints[body_joint_[b]].name + "' mimics '" +
             description_.joints[source.joint].name +
             "' by a multiplier or offset that is not finite or beyond 1e6, all followers between "
             "them counted");
      }
      const JointDescription& joint = description_.joints[body_joint_[b]];
      if (leaves_no_range(joint))
        without_range.push_back(joint.name);
      else if (joint.mimic)
        narrow_limits(joint, body, lower, upper);
    }
    std::vector<std::string> locked;
    for (std::size_t d = 0; d < lower.size(); ++d) {
      if (lower[d] == upper[d] && own_lower[d] < own_upper[d])
        locked.push_back(tree_.joint_names[d]);
    }
    warn_of(
        "a mimic joint's lower limit is not below its upper one: left out, so that only the joint "
        "it follows has limits, at ",
        without_range);
    warn_of("the limits of what mimics it leave a single position: locked, at ", locked);
    for (std::size_t d = 0; d < lower.size(); ++d) bound_limits(d, lower[d], upper[d]);
    const auto size = static_cast<Eigen::Index>(lower.size());
    tree_.lower = Eigen::Map<Eigen::VectorXd>(lower.data(), size);
    tree_.upper = Eigen::Map<Eigen::VectorXd>(upper.data(), size);
    tree_.velocity = Eigen::Map<Eigen::VectorXd>(velocity.data(), size);
    tree_.effort = Eigen::Map<Eigen::VectorXd>(effort.data(), size);
  }

  /// Simulators write 1e16 or the largest number there is where they mean no limit.
  void bound_limits(std::size_t dof, double& lower, double& upper) {
    if (lower < -kLargestNumber && upper > kLargestNumber) {
      lower = -std::numeric_limits<double>::infinity();
      upper = -lower;
      JointType& type = tree_.joint_types[dof];
      if (type == JointType::Revolute) type = JointType::Continuous;
    } else {
      lower = std::clamp(lower, -kLargestNumber, kLargestNumber);
      upper = std::clamp(upper, -kLargestNumber, kLargestNumber);
    }
  }

  /// A follower's limits hold too: they narrow those of the joint it follows.
  void narrow_limits(const JointDescription& follower, const Body& body, std::vector<double>& lower,
                     std::vector<double>& upper) const {
    if (follower.type == JointType::Continuous || body.multiplier == 0.0) return;
    double low = (follower.lower - body.offset) / body.multiplier;
    double high = (follower.upper - body.offset) / body.multiplier;
    if (low > high) std::swap(low, high);
    const auto d = static_cast<std::size_t>(body.dof);
    const double new_lower = std::max(lower[d], low), new_upper = std::min(upper[d], high);
    // Also where dividing by the multiplier overflowed: no number is above infinity.
    if (!(new_lower <= new_upper) || new_lower == kInfinity || new_upper == -kInfinity) {
      fail("joint '" + follower.name + "' mimics '" + tree_.joint_names[d] +
           "', but no position satisfies the limits of both");
    }
    lower[d] = new_lower;
    upper[d] = new_upper;
  }

  const RobotDescription& description_;
  std::map<std::string, std::size_t> link_index_, joint_index_;
  std::vector<std::vector<Neighbour>> neighbours_;
  std::vector<std::size_t> parent_joint_;
  std::vector<std::size_t> body_joint_;  // the joint that moves body b + 1
  Tree tree_;
};

}  // namespace

Tree build_tree(const RobotDescription& description, const std::string& base_link) {
  return TreeBuilder(description).build(base_link);
}

}  // namespace pdoik::detail
