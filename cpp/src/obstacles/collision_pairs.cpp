#include "pdoik/collision_pairs.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>

#include "hulls/self_collision.hpp"
#include "obstacles/collision_state.hpp"

namespace pdoik {
namespace {

/// Tells which links touch where a robot is placed, its ignored pairs included.
class TouchFinder {
 public:
  using Pair = std::pair<int, int>;  // links, the smaller index first

  explicit TouchFinder(const Robot& robot)
      : robot_(without_ignored_pairs(robot)),
        hulls_(robot_),
        self_(robot_, hulls_, 0.0),
        T_base_body_(robot_.bodies().size()),
        placed_(hulls_, hulls_.moving) {}

  std::set<Pair> touching_at(VectorIn q) {
    robot_.body_poses(q, T_base_body_);
    placed_.place(T_base_body_);
    self_.place(placed_.positions(), placed_.frames());
    self_.find_near([](int) { return 0.0; });
    std::set<Pair> links;
    for (int k = 0; k < self_.near_count(); ++k) {
      const auto& [one, two] = self_.pair(self_.near(k).pair).link;
      links.insert(std::minmax(one, two));
    }
    return links;
  }

  LinkPair names(const Pair& pair) const {
    const std::vector<std::string>& links = robot_.link_names();
    return {links[static_cast<std::size_t>(pair.first)],
            links[static_cast<std::size_t>(pair.second)]};
  }

 private:
  static Robot without_ignored_pairs(Robot robot) {
    robot.set_ignored_pairs({});
    return robot;
  }

  Robot robot_;
  detail::HullModel hulls_;
  detail::SelfCollision self_;
  std::vector<Eigen::Isometry3d> T_base_body_;
  detail::CollisionState placed_;
};

Eigen::VectorXd random_configuration(const Robot& robot, std::mt19937_64& engine) {
  Eigen::VectorXd q(robot.dof());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool limited = std::isfinite(robot.lower()[i]) && std::isfinite(robot.upper()[i]);
    const bool slides = robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Prismatic;
    const double wide = slides ? 1.0 : std::numbers::pi;
    const double low = limited ? robot.lower()[i] : -wide;
    const double high = limited ? robot.upper()[i] : wide;
    // Written out: the standard library's distributions differ between implementations.
    q[i] = low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1.0p-53);
  }
  return q;
}

}  // namespace

std::vector<LinkPair> pairs_always_touching(const Robot& robot, int samples, std::uint64_t seed,
                                            double share) {
  if (samples < 1)
    throw std::invalid_argument("samples is " + std::to_string(samples) + ", expected at least 1");
  if (!(share > 0.0 && share <= 1.0))
    throw std::invalid_argument("share is " + std::to_string(share) + ", expected it in (0, 1]");
  TouchFinder finder(robot);
  std::mt19937_64 engine(seed);
  std::map<TouchFinder::Pair, int> counts;
  for (int k = 0; k < samples; ++k) {
    for (const TouchFinder::Pair& pair : finder.touching_at(random_configuration(robot, engine)))
      ++counts[pair];
  }
  std::vector<LinkPair> pairs;
  for (const auto& [pair, count] : counts) {
    if (count >= share * samples) pairs.push_back(finder.names(pair));
  }
  return pairs;
}

std::vector<LinkPair> pairs_touching_at(const Robot& robot, VectorIn q) {
  TouchFinder finder(robot);
  std::vector<LinkPair> pairs;
  for (const TouchFinder::Pair& pair : finder.touching_at(q)) pairs.push_back(finder.names(pair));
  return pairs;
}

}  // namespace pdoik
