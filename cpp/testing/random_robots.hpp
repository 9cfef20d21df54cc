#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pdoik/robot.hpp"

/// Everything random in tests and benchmarks comes from here. The distributions are written out
/// because the standard library's differ between implementations, and a printed seed must give the
/// same numbers everywhere.
namespace pdoik::testing {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1.0p-53;
  }
  int integer(int low, int high) {  // both included
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  Eigen::Vector3d point(double extent) {
    const double x = uniform(-extent, extent), y = uniform(-extent, extent);
    return {x, y, uniform(-extent, extent)};
  }
  Eigen::Vector3d direction() {
    while (true) {
      const Eigen::Vector3d p = point(1.0);
      if (p.norm() > 0.1 && p.norm() < 1.0) return p.normalized();
    }
  }
  Eigen::Matrix3d rotation() {
    const Eigen::Vector3d axis = direction();
    return Eigen::AngleAxisd(uniform(-M_PI, M_PI), axis).toRotationMatrix();
  }
  Eigen::Isometry3d pose(double extent) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = rotation();
    T.translation() = point(extent);
    return T;
  }
  Eigen::VectorXd vector(Eigen::Index size, double low, double high) {
    Eigen::VectorXd v(size);
    for (Eigen::Index i = 0; i < size; ++i) v[i] = uniform(low, high);
    return v;
  }

 private:
  std::mt19937_64 engine_;
};

inline JointDescription joint_between(const std::string& parent, const std::string& child,
                                      const std::string& name, JointType type = JointType::Fixed,
                                      double lower = -1.0, double upper = 1.0) {
  JointDescription joint;
  joint.name = name;
  joint.type = type;
  joint.parent_link = parent;
  joint.child_link = child;
  joint.lower = type == JointType::Continuous ? -std::numeric_limits<double>::infinity() : lower;
  joint.upper = type == JointType::Continuous ? std::numeric_limits<double>::infinity() : upper;
  return joint;
}

/// What a random robot is made of.
struct RobotKind {
  int joints = 7;
  bool branches = false;
  double fixed = 0.0;  ///< chance that a joint is fixed
  double prismatic = 0.0;
  double continuous = 0.0;
  double mimic = 0.0;  ///< chance that a joint follows an earlier one
};

inline constexpr RobotKind kSerial{.joints = 6};
inline constexpr RobotKind kMixedTree{.joints = 9,
                                      .branches = true,
                                      .fixed = 0.2,
                                      .prismatic = 0.25,
                                      .continuous = 0.2,
                                      .mimic = 0.25};

/// A tree of links l0, l1, ... whose joints' names are in no order. Followers have limits that
/// never bind.
inline RobotDescription random_description(Random& random, const RobotKind& kind) {
  RobotDescription description;
  description.name = "random";
  description.links.push_back({.name = "l0"});
  std::vector<std::string> leaders;
  for (int i = 1; i <= kind.joints; ++i) {
    JointDescription joint;
    const char letter = static_cast<char>('a' + random.integer(0, 25));
    joint.name = letter + std::to_string(i);
    const auto link = [](int k) { return std::string(1, 'l').append(std::to_string(k)); };
    joint.parent_link = link(kind.branches ? random.integer(0, i - 1) : i - 1);
    joint.child_link = link(i);
    joint.T_parent_child = random.pose(0.3);
    joint.axis = random.direction();
    joint.axis *= random.uniform(0.5, 2.0);
    const double type = random.uniform(0.0, 1.0);
    const bool prismatic = type >= kind.fixed && type < kind.fixed + kind.prismatic;
    joint.type = prismatic ? JointType::Prismatic : JointType::Revolute;
    if (type < kind.fixed && i > 1) joint.type = JointType::Fixed;
    joint.lower = prismatic ? random.uniform(-0.3, 0.0) : random.uniform(-6.0, 1.0);
    joint.upper = joint.lower;
    joint.upper += prismatic ? random.uniform(0.1, 0.4) : random.uniform(0.2, 8.0);
    if (joint.type == JointType::Revolute && random.chance(kind.continuous)) {
      joint.type = JointType::Continuous;
      joint.lower = -std::numeric_limits<double>::infinity();
      joint.upper = std::numeric_limits<double>::infinity();
    }
    if (joint.type != JointType::Fixed) {
      if (!leaders.empty() && random.chance(kind.mimic)) {
        const int leader = random.integer(0, static_cast<int>(leaders.size()) - 1);
        const double rate = prismatic ? random.uniform(-0.1, 0.1) : random.uniform(-2.0, 2.0);
        const double offset = random.uniform(-0.2, 0.2);
        joint.mimic = Mimic{leaders[static_cast<std::size_t>(leader)], rate, offset};
        if (!prismatic) joint.type = JointType::Continuous;
        joint.lower = -std::numeric_limits<double>::infinity();
        joint.upper = std::numeric_limits<double>::infinity();
      }
      leaders.push_back(joint.name);
    }
    description.links.push_back({.name = joint.child_link});
    description.joints.push_back(joint);
  }
  return description;
}

inline RobotDescription random_description(std::uint64_t seed, const RobotKind& kind) {
  Random random(seed);
  return random_description(random, kind);
}

/// A random robot with one tip, its last link.
inline Robot random_robot(Random& random, const RobotKind& kind) {
  const RobotDescription description = random_description(random, kind);
  return Robot(description, {}, {description.links.back().name});
}

/// A configuration inside the limits, `inset` of each range away from them; continuous joints in
/// +-pi.
inline Eigen::VectorXd random_configuration(const Robot& robot, Random& random,
                                            double inset = 0.0) {
  Eigen::VectorXd q(robot.dof());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool bounded = std::isfinite(robot.lower()[i]);
    const double low = bounded ? robot.lower()[i] : -M_PI, high = bounded ? robot.upper()[i] : M_PI;
    q[i] = low + (high - low) * random.uniform(inset, 1.0 - inset);
  }
  return q;
}

/// Spheres and spheroids on random links, near their origins; the foci of about half of the
/// spheroids sit on two links.
inline Occupancy random_occupancy(const Robot& robot, Random& random, int spheres, int spheroids) {
  const int last = static_cast<int>(robot.link_names().size()) - 1;
  const auto any_link = [&] {
    return robot.link_names()[static_cast<std::size_t>(random.integer(0, last))];
  };
  Occupancy occupancy;
  for (int i = 0; i < spheres; ++i) {
    const std::string link = any_link();
    const Eigen::Vector3d center = random.point(0.1);
    occupancy.spheres.push_back({link, center, random.uniform(0.03, 0.15)});
  }
  for (int i = 0; i < spheroids; ++i) {
    Spheroid s;
    s.link_a = any_link();
    s.focus_a = random.point(0.1);
    s.link_b = random.chance(0.5) ? any_link() : s.link_a;
    s.focus_b = random.point(0.1);
    // Longer than the foci are apart at the middle of the ranges; if they sit on two links, not
    // always.
    const Eigen::VectorXd q = robot.mid_configuration();
    const double half =
        0.5 * (robot.fk(q, s.link_a) * s.focus_a - robot.fk(q, s.link_b) * s.focus_b).norm();
    s.semi_major = half + random.uniform(0.02, 0.15);
    occupancy.spheroids.push_back(s);
  }
  return occupancy;
}

/// Capsules and balls on some of the links, whose spheres and spheroids then only say where to
/// look; spheroids from such links to others are taken out. The wide hulls need not hold them.
inline Occupancy with_capsules(const Robot& robot, Occupancy occupancy, Random& random, int count) {
  const auto last = static_cast<int>(robot.link_names().size()) - 1;
  std::vector<std::string> links;
  for (int i = 0; i < 3; ++i)
    links.push_back(robot.link_names()[static_cast<std::size_t>(random.integer(0, last))]);
  for (int i = 0; i < count; ++i) {
    Capsule capsule;
    capsule.link = links[static_cast<std::size_t>(random.integer(0, 2))];
    capsule.a = random.point(0.15);
    capsule.b = random.chance(0.3) ? capsule.a : random.point(0.15);
    capsule.radius = random.uniform(0.01, 0.06);
    occupancy.capsules.push_back(capsule);
  }
  std::erase_if(occupancy.spheroids, [&](const Spheroid& s) {
    const auto is_one = [&](const std::string& link) {
      return std::find(links.begin(), links.end(), link) != links.end();
    };
    return s.link_a != s.link_b && (is_one(s.link_a) || is_one(s.link_b));
  });
  return occupancy;
}

/// Points in a box around the base, with radii up to `radius` if that is positive.
inline Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> random_obstacles(
    Random& random, int count, double extent, double radius = 0.0) {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> points(
      count, radius > 0.0 ? 4 : 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.row(i).head<3>() = random.point(extent).transpose();
    if (radius > 0.0) points(i, 3) = random.chance(0.3) ? 0.0 : random.uniform(0.0, radius);
  }
  return points;
}

inline std::map<std::string, double> by_joint_name(const Robot& robot, const Eigen::VectorXd& q) {
  std::map<std::string, double> positions;
  for (int i = 0; i < robot.dof(); ++i)
    positions[robot.joint_names()[static_cast<std::size_t>(i)]] = q[i];
  return positions;
}

}  // namespace pdoik::testing
