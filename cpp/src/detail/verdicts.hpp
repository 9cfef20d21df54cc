#pragma once

#include "detail/attempt.hpp"
#include "detail/workspace.hpp"

namespace pdoik::detail {

/// Makes what a start came to an answer, or a candidate for the best that there is. An answer that
/// touches something is brought clear of it if that pays.
class Verdicts {
 public:
  /// The workspace outlives it.
  explicit Verdicts(Workspace& workspace);

  /// Of the k-th start. @returns Whether the attempt has ended.
  bool take(Attempt& attempt, int k);
  /// Of an attempt that has ended. Some of its starts may be under way.
  void finish(Attempt& attempt);
  /// Have the workspace work for one of this attempt's alternatives.
  void work_for(Attempt& attempt, int alternative);
  /// To be told whenever an attempt begins anew.
  void forget(const Attempt& attempt) {
    if (worked_for_ == &attempt) worked_for_ = nullptr;
  }

 private:
  /// Whether the trial solves, in the minimiser's opinion; brings it clear if that pays.
  bool is_clear(Attempt& attempt, Trial& trial, bool stay_near);
  /// Of what the result holds, which solves. @returns Whether the attempt has ended.
  bool accept(Attempt& attempt, int alternative);
  /// Whether so many starts have come to the same as the best that others will not do better.
  bool is_agreed(Attempt& attempt, double value, bool is_best);
  /// Come to where the position holds, of goals whose position comes first.
  void hold_position(Attempt& attempt, Trial& trial);
  /// Whether the tool itself is in an obstacle where the goals put it: looked at once for each
  /// alternative, when a start has reached the goals and does not solve.
  bool is_blocked(Attempt& attempt, int alternative);
  /// Whether so many starts have ended against the same obstacle by the same hull that others will.
  /// Where joints are left over some must have been tried to bring clear as well.
  bool all_end_alike(Attempt& attempt, const Trial& trial);
  bool repair_pays(const Attempt& attempt) const;
  void keep_candidate(Attempt& attempt, const Trial& trial);
  /// Bring joints that move no goal's tip to where they are wanted, if the result still solves.
  void leave_idle(Attempt& attempt, int alternative);
  /// Go from the solution that the result holds downhill to the posture, and to what is wished, as
  /// long as it solves.
  void settle(Attempt& attempt, int alternative);
  /// What of wishes and of the way to a posture a configuration leaves.
  double left_of(const Attempt& attempt, const Eigen::VectorXd& q);
  /// What looking at all obstacles costs, in evaluations of the goal.
  double cost_of_all() const;

  Workspace& workspace_;
  const Model& model_;
  Attempt* worked_for_ = nullptr;
  int worked_for_alternative_ = 0;
  Eigen::VectorXd q_;
};

}  // namespace pdoik::detail
