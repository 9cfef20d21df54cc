#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <span>

#include "pdoik/augmented_lagrangian.hpp"
#include "pdoik/options.hpp"
#include "pdoik/robot.hpp"
#include "pdoik/solver.hpp"

namespace pdoik {

/// What `Method::Paper` minimises (Eq. AL), for an optimiser of the user's own: the distance to a
/// target, obstacles by multiplier and penalty, and the gradient by reverse accumulation.
///
/// It is a problem as `AugmentedLagrangian` wants one:
///
///     pdoik::Lagrangian problem(robot, options);
///     problem.set_target(T_base_tip);
///     problem.set_obstacles(points);
///     Eigen::VectorXd x = problem.variables(q0);
///     pdoik::AugmentedLagrangian(problem.size()).minimize(problem, x);
///
/// A Lagrangian belongs to one thread, and allocates nothing but in its constructor and where
/// `set_obstacles` of a Solver would.
class Lagrangian {
 public:
  /// What the optimiser's variables are.
  enum class Variables {
    Slack,      ///< the paper's: omega, from which limits hold; one per joint, see JointLimitMap
    Positions,  ///< q itself; limits are the optimiser's to hold
  };

  /// Of a robot, with neither goals nor obstacles yet.
  /// @param options  Goal, clearance, balance, self-collision and point_distance count; the rest
  /// belongs to solvers.
  /// @throws std::invalid_argument as Solver's constructor does.
  explicit Lagrangian(const Robot& robot, const Options& options = {},
                      Variables variables = Variables::Slack);
  Lagrangian(Lagrangian&&) noexcept;             ///< moved, not copied
  Lagrangian& operator=(Lagrangian&&) noexcept;  ///< moved, not copied
  ~Lagrangian();

  /// As it was at construction.
  const Robot& robot() const;
  /// Those it was made with.
  const Options& options() const;

  /// Goals, at most one a tip; forgets the multipliers.
  /// @throws std::invalid_argument as Solver::solve does.
  void set_goals(std::span<const Goal> goals);
  /// The same for a robot with one tip, whose goal is of the options' type.
  void set_target(const Eigen::Isometry3d& T_base_tip);
  /// Obstacle points; forgets the multipliers.
  /// @throws std::invalid_argument as Solver::set_obstacles does.
  void set_obstacles(const Obstacles& points);

  /// The number of variables.
  Eigen::Index size() const;
  /// Variables at q, shape (size(),). As slack, q is moved options.start_inset of each range off
  /// its limits.
  Eigen::VectorXd variables(VectorIn q) const;
  /// Joint positions at x, shape (n,).
  /// @throws std::invalid_argument if x has another length than size(), as what follows does.
  Eigen::VectorXd positions(const Eigen::VectorXd& x) const;

  /// Eq. AL at x with the multipliers as they are, and its gradient, resized to (size(),).
  double lagrangian(const Eigen::VectorXd& x, const Penalty& penalty, Eigen::VectorXd& gradient);
  /// max(0, max_j c_j(x)), the robot's own constraints included: of Eq. joint_coll_avoid and, being
  /// a sum of two distances, twice the depth of Eq. link_coll_avoid [m].
  double max_constraint(const Eigen::VectorXd& x);
  /// All multipliers to zero.
  void reset_multipliers();
  /// Each multiplier to Penalty::updated_multiplier of its constraint at x.
  void update_multipliers(const Eigen::VectorXd& x, const Penalty& penalty);

  /// The tips' largest position error where `lagrangian` was last evaluated [m].
  double last_position_error() const;
  /// Their largest rotation error there [rad].
  double last_rotation_error() const;
  /// The largest constraint there, at least 0 [m].
  double last_max_constraint() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> impl_;
};

}  // namespace pdoik
