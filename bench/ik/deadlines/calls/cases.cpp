#include "cases.hpp"

#include <functional>
#include <random>

namespace pdoik::bench {
namespace {

constexpr int kDraws = 60;  // configurations tried for goals of one kind

Eigen::VectorXd random_configuration(const Robot& robot, std::mt19937& random) {
  Eigen::VectorXd q(robot.dof());
  for (int i = 0; i < robot.dof(); ++i)
    q[i] = std::uniform_real_distribution<double>(robot.lower()[i], robot.upper()[i])(random);
  return q;
}

/// Every tip's pose at q, but for the base link, the last tip.
std::vector<Goal> goals_at(const Robot& robot, const Eigen::VectorXd& q) {
  std::vector<Goal> goals(robot.tips().size() - 1);
  for (std::size_t i = 0; i < goals.size(); ++i) {
    goals[i].tip = static_cast<int>(i);
    goals[i].T_base_tip = robot.fk(q, robot.tips()[i]);
  }
  return goals;
}

}  // namespace

Robot robot_with_base_tip(const std::string& name) {
  const Robot robot = Robot::builtin(name);
  std::vector<std::string> tips = robot.tip_links();
  tips.push_back(robot.base_link());
  return Robot::builtin(name, {}, tips);
}

std::optional<Eigen::RowVector3d> point_in_base_hull(const Robot& robot) {
  for (const Sphere& sphere : robot.occupancy().spheres)
    if (sphere.link == robot.base_link()) return Eigen::RowVector3d(sphere.center);
  for (const Spheroid& spheroid : robot.occupancy().spheroids)
    if (spheroid.link_a == robot.base_link() && spheroid.link_b == robot.base_link())
      return Eigen::RowVector3d(0.5 * (spheroid.focus_a + spheroid.focus_b));
  return std::nullopt;
}

std::vector<Case> cases_among(const Robot& robot, const Cloud& cloud, int count,
                              std::uint32_t seed) {
  std::mt19937 random(seed);
  Options options;
  options.base_collision = false;
  options.max_obstacles = std::max(1, static_cast<int>(cloud.rows()));
  Solver judge(robot, options);
  judge.set_obstacles(cloud);
  Case clear{"clear", {}}, buried{"buried", {}}, far{"far", {}}, fixed{"fixed tip", {}};
  const auto wanting = [&](const Case& kind) { return std::ssize(kind.goals) < count; };
  Result result;
  std::vector<Goal> goals;
  for (int draw = 0; draw < kDraws && (wanting(clear) || wanting(buried)); ++draw) {
    const Eigen::VectorXd q = random_configuration(robot, random);
    goals = goals_at(robot, q);
    judge.judge(goals, q, result);
    Case& kind = result.clearance > 0.0 ? clear : buried;
    if (wanting(kind)) kind.goals.push_back(goals);
  }
  for (int i = 0; i < count; ++i) {
    goals = goals_at(robot, random_configuration(robot, random));
    goals.front().T_base_tip.translation() += Eigen::Vector3d(3.0, 0.5 * i, 0.0);
    far.goals.push_back(goals);

    Goal still;
    still.tip = static_cast<int>(robot.tips().size()) - 1;
    still.T_base_tip.translation().x() = 0.05 * (i + 1);
    fixed.goals.push_back({still});
  }
  Case base{"base hull", {}, true};
  if (point_in_base_hull(robot)) base.goals = clear.goals.empty() ? buried.goals : clear.goals;
  std::vector<Case> result_cases;
  for (Case& kind :
       {std::ref(clear), std::ref(buried), std::ref(far), std::ref(fixed), std::ref(base)})
    if (!kind.goals.empty()) result_cases.push_back(std::move(kind));
  return result_cases;
}

}  // namespace pdoik::bench
