#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "common/deadline.hpp"
#include "pdoik/solver.hpp"
#include "problem/model.hpp"
#include "search/candidates.hpp"
#include "search/collection.hpp"
#include "search/common_contacts.hpp"

namespace pdoik::detail {

/// One start, and what a search from it came to, at q. Who searches fills it in.
struct Trial {
  Eigen::VectorXd q;
  int number = 0;                  ///< of the start, from 0
  int alternative = 0, round = 0;  ///< which goals, and which of their starts
  int row = 0;                     ///< of the table of starts
  bool is_known = false;           ///< whether the search has ended
  bool reached = false;            ///< the goals, whatever the obstacles
  double value = 0.0;  ///< how far it is from solving, at least: obstacles may be left out
  int iterations = 0, evaluations = 0;
};

/// What a solve spent, in evaluations of goals, and whether more would pay.
class Effort {
 public:
  void search(double cost) { search_ += cost; }
  void repair(double cost) { repair_ += cost; }
  void measure(double cost) { measure_ += cost; }
  /// Whether it pays to bring an answer clear of obstacles, and to find out by how much one that
  /// does not solve falls short, for what that usually costs.
  bool repair_pays(double cost) const { return repair_ + cost < kRepairShare * search_; }
  bool measure_pays(double cost) const { return measure_ + cost < kMeasureShare * search_; }

 private:
  /// What of the cost of searches may be spent on these.
  static constexpr double kRepairShare = 0.1, kMeasureShare = 0.02;
  double search_ = 0.0, repair_ = 0.0, measure_ = 0.0;
};

/// What a request asks for, which does not change while it is solved.
struct Wanted {
  bool goals_alone = false;     ///< obstacles cannot be kept off
  bool redundant = false;       ///< joints are left over
  bool nearest = false;         ///< the answer nearest to a start or posture
  bool wishes = false;          ///< goals that are soft
  bool compromises = false;     ///< a goal whose position comes first
  bool center_of_mass = false;  ///< a goal for it: all joints count
  bool posture = false;         ///< to come near to
  bool costs = false;           ///< some alternatives cost less than others
  bool one_orientation =
      false;  ///< joints enough for the orientation of goals whose position is first
  /// Whether the best of several ends is wanted.
  bool best_of_many() const { return nearest || compromises; }
  /// Whether answers differ in what they leave of goals.
  bool has_wishes() const { return wishes || compromises; }
  /// Whether an answer is worth more the less it leaves of something.
  bool settles() const { return posture || best_of_many() || wishes; }
};

/// One request under way, and the only owner of what is known of it: which starts there are, what
/// was found and what was spent. Others ask it, and tell it what has happened.
class SolveState {
 public:
  /// @param ahead  At most so many starts are searched from before the first one is judged.
  SolveState(const Model& model, std::size_t ahead);

  /// Allocates nothing.
  /// @param base_collides  Obstacles cannot be kept off: for the goals alone.
  /// @param in_turn  For what lanes do not know: one start after the other.
  void begin(const Request& request, Result& result, const Deadline& deadline, bool base_collides,
             bool in_turn);
  /// Want all solutions, to begin with from some starts, which may be all that there need be.
  void collect(Collection& into, const std::vector<Eigen::VectorXd>& from, bool are_all);
  /// Let go of the request.
  void end() { result_ = nullptr; }
  bool in_use() const { return result_ != nullptr; }
  bool in_lanes() const { return in_use() && !in_turn_; }
  bool in_turn() const { return in_use() && in_turn_; }

  /// @name What is asked
  /// @{
  const Request& request() const { return request_; }
  const Wanted& wanted() const { return wanted_; }
  const Deadline& deadline() const { return deadline_; }
  /// What will be answered; it holds what was judged last.
  Result& result() const { return *result_; }
  /// How many lists of goals any one of which will do, and one of them.
  int alternatives() const {
    return request_.any_of.empty() ? 1 : static_cast<int>(request_.any_of.size());
  }
  std::span<const Goal> goals(int alternative) const { return request_.alternative(alternative); }
  const Eigen::VectorXd& start() const { return start_; }
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  /// What the answer should be near to, if to anything.
  const Eigen::VectorXd& preferred() const {
    return request_.posture != nullptr ? *request_.posture : start_;
  }
  double distance_to_preferred(const Eigen::VectorXd& q) const {
    return ((q - preferred()).array().square() * model_.pull.array()).sum();
  }
  /// @}

  /// @name Starts
  /// @{
  /// Whether another may be searched from, while others are, and the next.
  bool may_start_another() const {
    return in_lanes() && has_start() &&
           next_start_ - next_judged_ < static_cast<int>(trials_.size());
  }
  Trial& take_start();
  /// Where it starts, and whether its end should be near that.
  void start_at(const Trial& trial, Eigen::VectorXd& q) const;
  bool stays_near(const Trial& trial) const {
    return wanted_.best_of_many() || trial.round < seed_count() ||
           (trial.round == 0 && request_.q0 != nullptr);
  }
  /// The first that was not judged, if its search has ended. They count in their order.
  Trial* next_ended();
  bool is_exhausted() const { return !has_start() && next_judged_ >= next_start_; }
  /// Count what a search came to. @returns Whether its goals are still looked for.
  bool count(const Trial& trial);
  /// Whether all goals were given up.
  bool has_given_up() const { return live_.empty(); }
  /// @}

  /// @name What was found
  /// @{
  bool has_found() const { return has_found_; }
  const Result& best() const { return best_; }
  /// Whether all solutions are wanted, and enough are known.
  bool collects() const { return collection_ != nullptr; }
  bool has_collected() const { return collection_->is_full(); }
  /// An end that meets the goals, clear of everything or not; and a solution, which the result
  /// holds: for those that are wanted.
  void note_end(const Trial& trial) { collection_->note(trial.q); }
  void add_solution();
  /// An answer, which the result holds: the best is kept.
  /// @param left  What it leaves of wishes and of the way to what is wanted.
  /// @returns Whether others will not do better.
  bool rank(int alternative, double left);
  /// Those that did not solve.
  Candidates& candidates() { return candidates_; }
  /// What runs, or was not judged, when the solve ends may be the best that there is.
  void add_unjudged(int alternative, const Eigen::VectorXd& q, double value) {
    candidates_.add(q, alternative, value, wanted_.goals_alone);
  }
  void add_unjudged();
  bool wants_candidates() const {
    return !has_found_ && !result_->holds && !(contact_ && hopeless_ == Status::Blocked);
  }
  /// @}

  /// @name Why there is no answer
  /// @{
  const std::optional<Status>& hopeless() const { return hopeless_; }
  /// Whether the tool is to be looked at for an alternative: once.
  bool may_check_tool(int alternative);
  /// The tool touches something wherever a trial's goals put it. @returns Whether all end so.
  bool block(const Trial& trial, const WorstConstraint& contact);
  /// All starts end against the same.
  void block() { hopeless_ = Status::Blocked; }
  /// Contacts that starts have in common.
  CommonContacts& contacts() { return contacts_; }
  /// Whether so many answers were tried to bring clear that others will not come clear either.
  bool has_repaired_enough() const { return !wanted_.redundant || repairs_ >= kRepairsThatTell; }
  void count_repair() { ++repairs_; }
  /// What touches the tool at its target.
  std::optional<WorstConstraint> contact() const { return contact_; }
  /// @}

  Effort& effort() { return effort_; }

 private:
  /// One of the lists of goals: what the best end of its starts left of it [m^2], or is expected
  /// to, and how many starts it had.
  struct Standing {
    int alternative;
    double left;
    int starts;
    int row;  ///< of the table, to start from
  };
  /// What the k-th start's end left of its goals.
  struct Note {
    int alternative = -1;
    double left = 0.0;
  };
  /// From so many answers that could not be brought clear one may conclude that others cannot.
  static constexpr int kRepairsThatTell = 4;
  /// What an end says of an alternative counts a fixed number of starts later, when it is known
  /// however many lanes there are, so that answers do not depend on them.
  static constexpr int kEndsKnown = 16;

  bool has_start() const { return startable_ > 0; }
  int seed_count() const { return seeds_ == nullptr ? 0 : static_cast<int>(seeds_->size()); }
  Trial& trial(int k) { return trials_[static_cast<std::size_t>(k) % trials_.size()]; }
  double cost(int alternative) const {
    return wanted_.costs ? request_.costs[static_cast<std::size_t>(alternative)] : 0.0;
  }
  /// What its goals and options say a request wants.
  Wanted wanted_of(bool base_collides) const;
  void begin_alternatives(bool base_collides);
  /// Look for a good start for each, and how near it comes.
  void look_up_starts();
  /// The alternative that looks likeliest to be met.
  Standing& likeliest();
  /// Look for no more answers to some goals.
  void give_up(int alternative);
  /// Whether so many starts have come to the same as the best that others will not do better.
  bool is_agreed(double left, bool is_best);
  void set_bounds();
  /// A place of the low-discrepancy sequence, k >= 1.
  void draw(int k, Eigen::VectorXd& q) const;

  const Model& model_;
  Request request_;
  Result* result_ = nullptr;  ///< none: not in use
  Deadline deadline_;
  Wanted wanted_;
  bool in_turn_ = false;
  Eigen::VectorXd start_, lower_, upper_;

  std::vector<Standing> live_;  ///< of those that are not given up, the cheapest first
  std::vector<char> given_up_, tool_checked_;
  const StartTable* table_ = nullptr;  ///< where alternatives start, if it knows them
  const std::vector<Eigen::VectorXd>* seeds_ = nullptr;  ///< starts that come first, if any
  int last_round_ = 0;                                   ///< of an alternative's starts, from 0
  int startable_ = 0;                                    ///< alternatives that have starts left
  int next_start_ = 0, next_judged_ = 0;
  std::vector<Trial> trials_;               ///< of start k at k modulo their number
  std::array<Note, 2 * kEndsKnown> notes_;  ///< of start k at k modulo their number

  Result best_;
  bool has_found_ = false;
  double least_ = 0.0, least_cost_ = 0.0;  ///< what the best leaves, and costs
  int agreed_ = 0, settled_ = 0;  ///< of ends that were ranked: those that are as good as the best
  Candidates candidates_;
  Collection* collection_ = nullptr;  ///< where all solutions are wanted
  std::optional<Status> hopeless_;
  std::optional<WorstConstraint> contact_;  ///< of the tool at its target: no answer exists
  CommonContacts contacts_;
  int repairs_ = 0;  ///< that were tried
  Effort effort_;
};

}  // namespace pdoik::detail
