#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "detail/candidates.hpp"
#include "detail/collection.hpp"
#include "detail/common_contacts.hpp"
#include "detail/deadline.hpp"
#include "detail/model.hpp"
#include "pdoik/solver.hpp"

namespace pdoik::detail {

/// What one start came to, at q.
struct Trial {
  Eigen::VectorXd q;
  int alternative = 0, round = 0;  ///< which goals, and which of their starts
  int row = 0;                     ///< of the table of starts
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
  /// Want all solutions, to begin with from some starts, which may be all that there need be.
  void collect(Collection& into, const std::vector<Eigen::VectorXd>& from, bool are_all);
  bool in_use() const { return result != nullptr; }

  /// How many lists of goals any one of which will do, and one of them.
  int alternatives() const {
    return request.any_of.empty() ? 1 : static_cast<int>(request.any_of.size());
  }
  std::span<const Goal> goals(int alternative) const { return request.alternative(alternative); }
  double cost(int alternative) const {
    return request.costs.empty() ? 0.0 : request.costs[static_cast<std::size_t>(alternative)];
  }
  /// Look for no more answers to some goals.
  void give_up(int alternative);
  bool is_given_up(int alternative) const {
    return given_up[static_cast<std::size_t>(alternative)] != 0;
  }

  /// Where a trial starts.
  void start_at(const Trial& trial, Eigen::VectorXd& q) const;
  /// Whether its end should be near that.
  bool stays_near(const Trial& trial) const {
    return ranks || (seeds != nullptr && trial.round < static_cast<int>(seeds->size())) ||
           (trial.round == 0 && request.q0 != nullptr);
  }
  /// Note what the k-th start's end leaves of its goals, 0 if they are met.
  void note_left(int k, double left);
  /// Whether there are starts left.
  bool has_start() const { return startable > 0; }
  /// The next: its number.
  int take_start();
  bool may_start_another() const {
    return in_use() && !in_turn && has_start() &&
           next_start - next_verdict < static_cast<int>(trials.size());
  }
  /// Whether the tool is in something wherever goals put it.
  bool is_blocked() const { return contact && hopeless == Status::Blocked; }
  bool is_exhausted() const { return !has_start() && next_verdict >= next_start; }

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
  std::optional<WorstConstraint> contact;  ///< of the tool at its target: no answer exists
  CommonContacts common;
  int repairs = 0;       ///< that were tried
  bool in_turn = false;  ///< for what lanes do not know: one start after the other
  bool for_goals_alone = false, redundant = false, nearest = false, found = false;
  bool ranks = false;              ///< whether the best of several ends is wanted
  bool wishes = false;             ///< goals that are soft
  bool compromises = false;        ///< a goal whose position comes first
  bool redundant_for_all = false;  ///< whether there are joints enough for its orientation as well
  bool of_mass = false;            ///< a goal for the centre of mass: all joints count
  int agreed = 0, settled = 0;  ///< of ends that were settled: those that are as good as the best
  /// One of the lists of goals: what the best end of its starts left of it [m^2], or is expected
  /// to, and how many starts it had.
  struct Standing {
    int alternative;
    double left;
    int starts;
    int row;  ///< of the table, to start from
  };
  std::vector<Standing> live;  ///< of those that are not given up, the cheapest first
  std::vector<char> given_up, tool_checked;
  const StartTable* table = nullptr;  ///< where alternatives start, if it knows them
  int last_round = 0;                 ///< of an alternative's starts, from 0
  int startable = 0;                  ///< alternatives that have starts left
  Collection* collection = nullptr;   ///< where all solutions are wanted
  const std::vector<Eigen::VectorXd>* seeds = nullptr;  ///< starts that come first, if any
  int next_start = 0, next_verdict = 0, lanes = 0;
  double search_cost = 0.0, repair_cost = 0.0, measure_cost = 0.0;  ///< in evaluations of goals
  double least = 0.0;  ///< of what was found, by its wishes and the distance to what is wanted
  double least_cost = 0.0;
  Eigen::VectorXd start, lower, upper;
  std::vector<Trial> trials;  ///< of start k at k modulo their number
  Candidates candidates;
  Result best;

 private:
  /// What a verdict says of an alternative counts a fixed number of starts later, when it is known
  /// however many lanes there are, so that answers do not depend on them.
  static constexpr int kVerdictsKnown = 16;
  struct Note {
    int alternative = -1;
    double left = 0.0;
  };
  std::array<Note, 2 * kVerdictsKnown> notes_;  ///< of start k at k modulo their number
  void begin_alternatives(bool base_collides);
  /// Look for a good start for each, and how near it comes.
  void look_up_starts();
  /// The alternative that looks likeliest to be met.
  Standing& likeliest();
  void set_bounds();
  /// A place of the low-discrepancy sequence, k >= 1.
  void draw(int k, Eigen::VectorXd& q) const;
};

}  // namespace pdoik::detail
