#pragma once

#include <optional>

#include "search/solve_state.hpp"
#include "search/workspace.hpp"

namespace pdoik::detail {

/// What makes the end of a search an answer: the steps of Multistart that look at what is near,
/// with the workspace's problem and judge. An answer that touches something is brought clear of it
/// if that pays; one that solves is settled where it may be better; else it is a candidate for the
/// best that there is.
class Acceptance {
 public:
  /// The workspace outlives it.
  explicit Acceptance(Workspace& workspace);

  /// Have the workspace work for one of this solve's alternatives.
  void work_for(SolveState& solve, int alternative);
  /// Whenever a solve begins anew.
  void forget(const SolveState& solve) {
    if (worked_for_ == &solve) worked_for_ = nullptr;
  }

  /// Come to where the position holds, of goals whose position comes first.
  void keep_position(SolveState& solve, Trial& trial);
  /// Bring joints by whole turns to where they are wanted.
  void unwind(const SolveState& solve, Trial& trial) const;
  /// Whether the trial solves, in the minimiser's opinion; brings it clear if that pays.
  bool is_clear(SolveState& solve, Trial& trial);
  /// Whether it solves, in the judge's.
  bool holds(SolveState& solve, const Trial& trial);
  /// Of what the result holds, which solves. @returns Whether the solve has ended.
  bool accept(SolveState& solve, int alternative);
  void keep_candidate(SolveState& solve, const Trial& trial);
  /// What the tool itself touches where the goals put it: looked at once for each alternative, when
  /// a start has reached the goals and does not solve.
  std::optional<WorstConstraint> tool_contact(SolveState& solve, const Trial& trial);
  /// Whether so many starts have ended against the same obstacle by the same hull that others will.
  /// Where joints are left over some must have been tried to bring clear as well.
  bool all_end_alike(SolveState& solve, const Trial& trial);
  /// Of a solve that has ended. Some of its starts may be under way.
  void finish(SolveState& solve);

 private:
  /// Let the result be what comes nearest to a solution.
  void return_nearest(SolveState& solve);
  /// Bring joints that move no goal's tip to where they are wanted, if the result still solves.
  void leave_idle(SolveState& solve, int alternative);
  /// Go from the solution that the result holds downhill to the posture, and to what is wished, as
  /// long as it solves.
  void settle(SolveState& solve, int alternative);
  /// What of wishes and of the way to a posture a configuration leaves.
  double left_of(const SolveState& solve, const Eigen::VectorXd& q);
  /// What looking at all obstacles costs, and what bringing an answer clear usually does, in
  /// evaluations of the goal.
  double cost_of_all() const;
  double usual_repair() const;

  Workspace& workspace_;
  const Model& model_;
  SolveState* worked_for_ = nullptr;
  int worked_for_alternative_ = 0;
  Eigen::VectorXd q_;
};

}  // namespace pdoik::detail
