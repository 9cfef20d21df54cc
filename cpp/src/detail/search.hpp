#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "detail/candidates.hpp"
#include "detail/collision.hpp"
#include "detail/deadline.hpp"
#include "detail/goal_term.hpp"
#include "detail/judge.hpp"
#include "detail/lagrangian_problem.hpp"
#include "detail/least_squares_problem.hpp"
#include "detail/low_discrepancy.hpp"
#include "pdoik/joint_limit_map.hpp"
#include "pdoik/options.hpp"
#include "pdoik/point_cloud.hpp"
#include "pdoik/result.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

/// Algorithm IK and its restarts, with every piece of memory they need.
class Search {
 public:
  /// Both must outlive the search and stay where they are.
  Search(const Robot& robot, const Options& options);

  void set_obstacles(const Obstacles& points);
  void copy_scene(const Search& other);
  void set_interrupt(std::function<bool()> wanted) { interrupt_ = std::move(wanted); }
  /// One solve. Allocates nothing if result.q has its size.
  void run(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd* q0, Result& result);
  void judge(const Eigen::Isometry3d& T_base_tip, const Eigen::VectorXd& q, Result& result) {
    judge_(T_base_tip, q, scene_, result);
  }

 private:
  void reserve(int padded_obstacles);
  void run_paper(const Eigen::Isometry3d& target, const Eigen::VectorXd* q0,
                 const Deadline& deadline, Result& result);
  void run_default(const Eigen::Isometry3d& target, const Eigen::VectorXd* q0,
                   const Deadline& deadline, Result& result);
  /// What one start of the default method came to, with its end in q_.
  struct Trial {
    bool struck = false;     ///< by the deadline
    bool solves = false;     ///< in the minimiser's opinion
    double shortfall = 0.0;  ///< how far it is from solving, at least: obstacles may be left out
  };
  /// The goal alone, which is cheap; obstacles only if the answer touches some, and then if it is
  /// to stay near or while that pays.
  Trial try_least_squares(bool stay_near, const Deadline& deadline, Result& result);
  bool repair_pays(int points) const;
  /// The paper's formulation.
  Trial try_lagrangian(const Deadline& deadline, Result& result);
  /// Minimise least squares from q_; its value at the end, which q_ then holds.
  double minimise_least_squares(LevenbergMarquardt& minimiser, const Deadline& deadline,
                                Result& result, bool& struck);
  bool minimise_lagrangian(const Deadline& deadline, Result& result);
  /// The start of restart k >= 1, into q_.
  void restart_configuration(int k);
  /// Joints without limits stay within half a turn of the start: by wrapping the answer, or by
  /// bounds where a mimic joint follows at a rate that a whole turn would not leave unchanged.
  void bound_turns();
  void wrap_to_start();
  bool base_collides() const { return scene_.fixed.distance < -options_.clearance_tolerance; }
  bool out_of_reach(const Eigen::Isometry3d& target) const;

  const Robot& robot_;
  const Options& options_;
  HullModel hulls_;
  Scene scene_;
  CollisionState collision_, fixed_hulls_;
  Rollout rollout_;
  std::vector<GoalTerm> goals_;
  JointLimitMap map_;
  LagrangianProblem lagrangian_;
  LeastSquaresProblem least_squares_;
  AugmentedLagrangian augmented_lagrangian_;
  LevenbergMarquardt levenberg_marquardt_, patient_;
  Judge judge_;
  LowDiscrepancy sequence_;
  Candidates candidates_;
  Eigen::VectorXd lower_, upper_, start_, q_, omega_;
  std::vector<bool> matters_;  ///< joints that move the tip or a hull
  bool redundant_ = false;     ///< more joints move tip or hulls than the goal fixes
  double search_cost_ = 0.0, repair_cost_ = 0.0;  ///< of this solve, in evaluations of the goal
  enum class Turn { Limited, Wrap, Bound };
  std::vector<Turn> turns_;
  std::function<bool()> interrupt_;
  Eigen::Vector3d reach_root_;
  double reach_ = 0.0;
};

}  // namespace pdoik::detail
