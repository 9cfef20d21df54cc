#pragma once

#include <functional>
#include <memory>
#include <optional>
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
#include "detail/scene.hpp"
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
  /// One among the same obstacles as another search for the same robot, which it shares them with.
  Search(const Robot& robot, const Options& options, const Search& other);

  void set_obstacles(const Obstacles& points);
  /// What results say that taking the obstacles in took [s].
  void set_intake(double seconds) { intake_ = seconds; }
  void set_interrupt(std::function<bool()> wanted) { interrupt_ = std::move(wanted); }
  /// One solve. Allocates nothing if result.q has its size.
  void run(const Request& request, Result& result);
  void judge(std::span<const Goal> goals, const Eigen::VectorXd& q, Result& result) {
    judge_(goals, q, *scene_, result);
  }
  const HullModel& hulls() const { return hulls_; }

  /// What one step of a control loop is asked.
  struct Following {
    std::span<const Goal> goals;
    const Eigen::VectorXd *from, *lower, *upper;  ///< the last answer, and bounds about it
    const Eigen::VectorXd *pull_to, *pull;  ///< see LeastSquaresProblem::pull_towards; may be null
    double max_time;                        ///< [s]
    /// Obstacles farther than this from the hulls cannot be met within a step; may be infinite [m].
    double margin;
    double advance, turn;  ///< how far a tip may be asked to go in one step [m], [rad]
    double look;           ///< clearance beyond this is told as this [m]
  };
  /// The step from the last answer that comes nearest to goals and constraints: result.status is
  /// Solved, TimeLimit or Exhausted. Allocates nothing if result.q has its size.
  void follow(const Following& following, Result& result);

 private:
  Search(const Robot& robot, const Options& options, std::shared_ptr<Scene> scene);
  void use_scene();
  void set_goals(std::span<const Goal> goals);
  /// Begin a solve or step that ends after this long.
  void begin(double max_time, Result& result);
  void end(Result& result) const;
  /// Where the first start is, and the bounds of this solve.
  void set_start(const Request& request);
  /// Why no answer can exist, if that is known without a search.
  std::optional<Status> why_hopeless(std::span<const Goal> goals);
  void run_paper(const Request& request, Result& result);
  void run_default(const Request& request, bool hopeless, Result& result);
  /// Judge a configuration, a pass over what is near.
  void judge_answer(std::span<const Goal> goals, const Eigen::VectorXd& q, Result& result,
                    double look = std::numeric_limits<double>::infinity());
  /// Go back to an earlier verdict, but not to how much work it took.
  static void restore(const Result& earlier, Result& result);
  /// Go from the solution in q_, which the result holds, downhill to the posture as long as the
  /// answer solves.
  void settle(std::span<const Goal> goals, const Eigen::VectorXd& posture, Result& result);
  /// What one start of the default method came to, with its end in q_.
  struct Trial {
    bool reached = false;    ///< the goal, whatever the obstacles
    bool solves = false;     ///< in the minimiser's opinion
    double shortfall = 0.0;  ///< how far it is from solving, at least: obstacles may be left out
  };
  /// The goal alone, which is cheap; obstacles only if the answer touches some, and then if it is
  /// to stay near or while that pays.
  Trial try_least_squares(bool stay_near, Result& result);
  /// The goal alone, where obstacles cannot be kept off anyway.
  Trial try_goal_alone(bool stay_near, Result& result);
  bool repair_pays() const;
  /// The paper's formulation.
  Trial try_lagrangian(Result& result);
  /// Keep the end of a trial as one to return if none solves.
  /// @param alone  Whether only the goal counts.
  void keep_candidate(const Trial& trial, bool alone);
  /// What looking at all obstacles costs, in evaluations of the goal.
  double cost_of_all() const;
  /// Minimise least squares from q_; its value at the end, which q_ then holds.
  double minimise_least_squares(LevenbergMarquardt& minimiser, Result& result);
  void minimise_lagrangian(Result& result);
  /// The start of restart k >= 1, into q_.
  void restart_configuration(int k, const Eigen::VectorXd* near);
  /// Joints without limits stay within half a turn of the start: by wrapping the answer, or by
  /// bounds where a mimic joint follows at a rate that a whole turn would not leave unchanged.
  void wrap_to_start();
  bool base_collides() const { return scene_->fixed.distance < -options_.clearance_tolerance; }
  bool out_of_reach(const Goal& goal) const;
  /// The configuration within lower_ and upper_ that comes nearest to goals and constraints, into
  /// q_, downhill from the last answer; obstacles farther than a margin cannot be met [m].
  void approach(const Following& step, double margin, Result& result);
  /// Whether hulls stay clear of obstacles and each other on the straight way from the last answer
  /// to q_.
  bool clear_on_the_way(const Following& step);
  /// How far hulls may move before one meets an obstacle or another; negative if they do [m].
  double room(const Result& verdict) const;
  /// A step whose way is longer than this is looked at along it [m].
  static double long_way(const Robot& robot, const HullModel& hulls);
  /// A bound on how far any part of a hull gets on that way [m].
  double way_from(const Eigen::VectorXd& from);

  const Robot& robot_;
  const Options& options_;
  HullModel hulls_;
  std::shared_ptr<Scene> scene_;  ///< changed only while nobody shares it
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
  Deadline deadline_;
  Result best_, saved_, probe_;  ///< of this solve: the nearest solution; to go back to; on the way
  Eigen::VectorXd lower_, upper_, start_, q_, omega_, unsettled_, pull_, levers_;
  double long_way_;
  bool levers_are_constant_ = false;  ///< no slide without limits lengthens them
  std::vector<bool> matters_;         ///< joints that move the tip or a hull
  std::ptrdiff_t matter_count_ = 0;
  bool redundant_ = false;  ///< more joints move tips or hulls than the goals fix
  /// Of this solve, in evaluations of the goal.
  double search_cost_ = 0.0, repair_cost_ = 0.0, measure_cost_ = 0.0;
  double intake_ = 0.0;
  double verdict_time_ = 0.0;  ///< what a verdict takes, by the last ones [s]
  int late_ = 0;               ///< evaluations and passes begun after the deadline struck
  enum class Turn { Limited, Wrap, Bound };
  std::vector<Turn> turns_;
  std::function<bool()> interrupt_;
  std::vector<Reach> tip_reach_;
};

}  // namespace pdoik::detail
