#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "detail/candidates.hpp"
#include "detail/common_contacts.hpp"
#include "detail/deadline.hpp"
#include "detail/model.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

/// What one start came to, at q.
struct Trial {
  Eigen::VectorXd q;
  bool is_known = false;
  bool reached = false;  ///< the goals, whatever the obstacles
  double value = 0.0;    ///< how far it is from solving, at least: obstacles may be left out
  int iterations = 0, evaluations = 0;
};

/// One request under way: its starts, what is known of them, and what was spent.
struct Attempt {
  /// @param ahead  At most so many starts are searched from before the first one's verdict.
  Attempt(const Model& model, std::size_t ahead);

  /// Allocates nothing. @param base_collides  Obstacles cannot be kept off: for the goals alone.
  void begin(const Request& request, Result& result, const Deadline& deadline, bool base_collides);
  bool in_use() const { return result != nullptr; }

  /// Where the k-th start is.
  void start_at(int k, Eigen::VectorXd& q) const;
  /// Whether the k-th start's end should be near it.
  bool stays_near(int k) const { return nearest || (k == 0 && request.q0 != nullptr); }
  bool may_start_another() const {
    return in_use() && next_start <= last_start &&
           next_start - next_verdict < static_cast<int>(trials.size());
  }

  /// What the answer should be near to, if to anything.
  const Eigen::VectorXd& wanted() const {
    return request.posture != nullptr ? *request.posture : start;
  }
  double distance_to_wanted(const Eigen::VectorXd& q) const {
    return ((q - wanted()).array().square() * model->pull.array()).sum();
  }
  Trial& trial(int k) { return trials[static_cast<std::size_t>(k) % trials.size()]; }

  const Model* model;
  Request request;
  Result* result = nullptr;  ///< none: not in use
  Deadline deadline;
  std::optional<Status> hopeless;
  bool tool_checked = false;
  std::optional<WorstConstraint> contact;  ///< of the tool at its target: no answer exists
  CommonContacts common;
  int repairs = 0;  ///< that were tried
  bool for_goals_alone = false, redundant = false, nearest = false, found = false;
  int next_start = 0, next_verdict = 0, last_start = 0, lanes = 0;
  double search_cost = 0.0, repair_cost = 0.0, measure_cost = 0.0;  ///< in evaluations of goals
  double least = 0.0;  ///< of what was found, by the distance to what is wanted
  Eigen::VectorXd start, lower, upper;
  std::vector<Trial> trials;  ///< of start k at k modulo their number
  Candidates candidates;
  Result best;

 private:
  void set_bounds();
  /// A place of the low-discrepancy sequence, k >= 1.
  void draw(int k, Eigen::VectorXd& q) const;
};

}  // namespace pdoik::detail
