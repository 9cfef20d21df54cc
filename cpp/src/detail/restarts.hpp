#pragma once

#include <optional>
#include <vector>

#include "detail/candidates.hpp"
#include "detail/workspace.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

/// What is to be solved, one after the other.
class Requests {
 public:
  virtual ~Requests() = default;
  /// @returns Whether there is another. Both outlive its solve.
  virtual bool next(Request& request, Result*& result) = 0;
};

/// The default method. From the first start, then from those of a low-discrepancy sequence, until
/// an answer is clear: the goals alone, which is cheap; then, if what that comes to touches
/// something, with what is near if that pays.
///
/// Searches for the goals alone run in lanes. A request has one lane while there are more requests,
/// and its later starts run beside the first ones when there are not. Starts count in their order
/// whatever lane came first: answers are the same one by one, in a batch, on any number of threads.
class Restarts {
 public:
  /// The workspace outlives it.
  explicit Restarts(Workspace& workspace);

  /// Solve all. Allocates nothing if results' q have their size.
  void run(Requests& requests);

 private:
  /// What one start came to, at q.
  struct Trial {
    Eigen::VectorXd q;
    bool is_known = false;
    bool reached = false;  ///< the goals, whatever the obstacles
    double value = 0.0;    ///< how far it is from solving, at least: obstacles may be left out
    int iterations = 0, evaluations = 0;
  };
  /// One request under way.
  struct Attempt {
    explicit Attempt(Eigen::Index dof, std::size_t ahead);

    Request request;
    Result* result = nullptr;  ///< none: not in use
    Deadline deadline;
    std::optional<Status> hopeless;
    bool for_goals_alone = false;  ///< for obstacles cannot be kept off anyway
    bool redundant = false, nearest = false, found = false;
    int next_start = 0, next_verdict = 0, last_start = 0, lanes = 0;
    double search_cost = 0.0, repair_cost = 0.0, measure_cost = 0.0;  ///< in evaluations of goals
    double least = 0.0;  ///< of what was found, by the distance to what is wanted
    Eigen::VectorXd start, lower, upper;
    std::vector<Trial> trials;  ///< of start k at k modulo their number
    Candidates candidates;
    Result best;

    const Eigen::VectorXd& wanted() const {
      return request.posture != nullptr ? *request.posture : start;
    }
    Trial& trial(int k) { return trials[static_cast<std::size_t>(k) % trials.size()]; }
    bool stays_near(int k) const { return nearest || (k == 0 && request.q0 != nullptr); }
  };
  struct Lane {
    Attempt* attempt = nullptr;
    int start = 0;
  };

  void begin(Attempt& attempt, const Request& request, Result& result);
  void set_start(Attempt& attempt) const;
  /// The start of restart k >= 1.
  void restart_configuration(const Attempt& attempt, int k, Eigen::VectorXd& q) const;
  void starting_point(const Attempt& attempt, int k, Eigen::VectorXd& q) const;
  /// Give each idle lane a start of who has the fewest.
  void fill_lanes();
  Attempt* who_has_fewest_lanes();
  /// Where lanes cannot tell: balance is not kept by goals alone, and the paper's form is another.
  void search_in_turn(Attempt& attempt);
  /// Judge what is known of an attempt's starts, in their order.
  void advance(Attempt& attempt);
  /// Make what a start came to an answer, or a candidate. @returns Whether the attempt has ended.
  bool take(Attempt& attempt, int k);
  /// Whether the trial solves, in the minimiser's opinion; brings it clear if that pays.
  bool is_clear(Attempt& attempt, Trial& trial, bool stay_near);
  bool repair_pays(const Attempt& attempt) const;
  void keep_candidate(Attempt& attempt, const Trial& trial);
  /// Go from the solution that the result holds downhill to the posture as long as it solves.
  void settle(Attempt& attempt);
  void finish(Attempt& attempt);
  /// What looking at all obstacles costs, in evaluations of the goal.
  double cost_of_all() const;
  /// Have the workspace work for this attempt.
  void work_for(Attempt& attempt);

  Workspace& workspace_;
  const Model& model_;
  bool in_lanes_;
  std::vector<Lane> lanes_;
  std::vector<Attempt> attempts_;
  Attempt* worked_for_ = nullptr;
  Eigen::VectorXd q_;
};

}  // namespace pdoik::detail
