#pragma once

#include <string>
#include <vector>

#include "brute_force.hpp"
#include "pdoik/solver.hpp"
#include "random_robots.hpp"

/// The three arms of the paper with hulls set by hand, and problems that have a solution.
namespace pdoik::testing {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

using ObstacleMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A ball at each link's origin and a spheroid from it to the next one's: not tight, but moving as
/// an arm does.
inline Robot with_hulls(Robot robot) {
  Occupancy occupancy;
  const Eigen::VectorXd q = robot.mid_configuration();
  const std::vector<std::string>& links = robot.link_names();
  for (std::size_t i = 0; i < links.size(); ++i) {
    occupancy.spheres.push_back({links[i], Eigen::Vector3d::Zero(), 0.07});
    if (i + 1 == links.size()) break;
    const double apart =
        (robot.fk(q, links[i]).translation() - robot.fk(q, links[i + 1]).translation()).norm();
    if (apart < 0.05) continue;
    occupancy.spheroids.push_back({links[i], Eigen::Vector3d::Zero(), links[i + 1],
                                   Eigen::Vector3d::Zero(), 0.5 * apart + 0.03});
  }
  robot.set_occupancy(occupancy);
  robot.set_ignored_pairs({});  // the shipped ones are of the shipped hulls
  return robot;
}

inline std::vector<std::string> arm_names() { return {"panda", "ur10", "iiwa14"}; }

/// One of them far from its limits, from singularities and from being stretched.
inline Eigen::VectorXd bent_arm(const Robot& robot) {
  Eigen::VectorXd q = robot.mid_configuration();
  q[1] += robot.name() == "ur10" ? -1.2 : 0.4;
  q[2] += robot.name() == "ur10" ? 1.5 : 0.0;
  q[3] -= 0.8;
  q[4] += 0.4;
  q[5] += 0.7;
  return q;
}

struct Problem {
  Eigen::VectorXd q;  ///< one solution
  Eigen::Isometry3d target;
  ObstacleMatrix obstacles;
};

/// A reachable target with `count` obstacles around that leave its configuration `margin` of room.
inline Problem solvable_problem(const Robot& robot, Random& random, int count, double radius = 0.0,
                                double margin = 0.03) {
  Problem problem;
  problem.q = random_configuration(robot, random, 0.02);
  problem.target = robot.fk(problem.q);
  problem.obstacles = ObstacleMatrix(count, radius > 0.0 ? 4 : 3);
  for (Eigen::Index k = 0; k < count;) {
    const ObstacleMatrix one = random_obstacles(random, 1, 0.9, radius);
    if (brute_force_clearance(robot, problem.q, one, 50) < margin) continue;
    problem.obstacles.row(k++) = one;
  }
  return problem;
}

inline const char* name_of(GoalType goal) {
  return goal == GoalType::Pose ? "pose" : goal == GoalType::Axis ? "axis" : "position";
}

/// A solver's settings that no clock decides.
inline Options timeless(GoalType goal = GoalType::Pose, Method method = Method::Default,
                        InnerMethod inner = InnerMethod::LevenbergMarquardt) {
  Options options;
  options.goal = goal;
  options.method = method;
  options.inner = inner;
  options.max_time = std::numeric_limits<double>::infinity();
  return options;
}

/// Pose errors straight from forward kinematics.
inline double position_error(const Robot& robot, const Eigen::VectorXd& q,
                             const Eigen::Isometry3d& target) {
  return (robot.fk(q).translation() - target.translation()).norm();
}
inline double rotation_error(const Robot& robot, const Eigen::VectorXd& q,
                             const Eigen::Isometry3d& target, const Options& options) {
  const Eigen::Matrix3d R = robot.fk(q).linear(), wanted = target.linear();
  if (options.goal == GoalType::Position) return 0.0;
  if (options.goal == GoalType::Pose) {
    return 2.0 * std::asin(std::min(1.0, (R - wanted).norm() /
                                             std::sqrt(8.0)));  // |R - R*| = sqrt(8) sin(angle/2)
  }
  const Eigen::Vector3d axis = options.goal_axis.normalized();
  return 2.0 * std::asin(std::min(1.0, 0.5 * (R * axis - wanted * axis).norm()));
}

}  // namespace pdoik::testing
