#pragma once

#include <functional>
#include <span>
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
#include "detail/own_constraints.hpp"
#include "detail/reach.hpp"
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
  void run(const Request& request, Result& result);
  void judge(std::span<const Goal> goals, const Eigen::VectorXd& q, Result& result) {
    judge_(goals, q, scene_, result);
  }

  /// What one step of a control loop is asked.
  struct Following {
    std::span<const Goal> goals;
    const Eigen::VectorXd *from, *lower, *upper;  ///< the last answer, and bounds about it
    const Eigen::VectorXd *pull_to, *pull;  ///< see LeastSquaresProblem::pull_towards; may be null
    double max_time;                        ///< [s]
    double margin;  ///< obstacles farther than this from the hulls cannot be met within a step [m]
    double advance, turn;  ///< how far a tip may be asked to go in one step [m], [rad]
    double look;           ///< clearance beyond this is told as this [m]
  };
  /// The step from the last answer that comes nearest to goals and constraints: result.status is
  /// Solved, TimeLimit or Exhausted. Allocates nothing if result.q has its size.
  void follow(const Following& following, Result& result);

 private:
  void reserve(int padded_obstacles);
  void set_goals(std::span<const Goal> goals);
  /// Where the first start is, and the bounds of this solve.
  void set_start(const Request& request);
  void run_paper(const Request& request, const Deadline& deadline, Result& result);
  void run_default(const Request& request, const Deadline& deadline, Result& result);
  /// Go from the solution in q_, which the result holds, downhill to the posture as long as the
  /// answer solves.
  void settle(std::span<const Goal> goals, const Eigen::VectorXd& posture, const Deadline& deadline,
              Result& result);
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
  void restart_configuration(int k, const Eigen::VectorXd* near);
  /// Joints without limits stay within half a turn of the start: by wrapping the answer, or by
  /// bounds where a mimic joint follows at a rate that a whole turn would not leave unchanged.
  void wrap_to_start();
  bool base_collides() const { return scene_.fixed.distance < -options_.clearance_tolerance; }
  bool out_of_reach(const Goal& goal) const;

  const Robot& robot_;
  const Options& options_;
  HullModel hulls_;
  Scene scene_;
  CollisionState collision_, fixed_hulls_;
  OwnConstraints own_;
  Rollout rollout_;
  std::vector<GoalTerm> goals_;
  JointLimitMap map_;
  LagrangianProblem lagrangian_;
  LeastSquaresProblem least_squares_;
  AugmentedLagrangian augmented_lagrangian_;
  LevenbergMarquardt levenberg_marquardt_, patient_, settling_;
  Judge judge_;
  LowDiscrepancy sequence_;
  Candidates candidates_;
  Eigen::VectorXd lower_, upper_, start_, q_, omega_, best_, unsettled_, pull_;
  std::vector<bool> matters_;  ///< joints that move the tip or a hull
  std::ptrdiff_t matter_count_ = 0;
  bool redundant_ = false;  ///< more joints move tips or hulls than the goals fix
  double search_cost_ = 0.0, repair_cost_ = 0.0;  ///< of this solve, in evaluations of the goal
  enum class Turn { Limited, Wrap, Bound };
  std::vector<Turn> turns_;
  std::function<bool()> interrupt_;
  std::vector<Reach> tip_reach_;
};

}  // namespace pdoik::detail
