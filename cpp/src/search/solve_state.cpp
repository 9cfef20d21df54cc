#include "search/solve_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "search/outcome.hpp"

namespace pdoik::detail {
namespace {

/// Starts where no answer can exist: for the nearest to a target out of reach; for the goal alone
/// where the base is in collision, which ends with the first that reaches it.
constexpr int kStartsOutOfReach = 16, kStartsForGoalAlone = 100;

/// Each start makes its goals look less likely to be met: as if they had left so many times as
/// much.
constexpr double kLessLikely = 2.0;
/// What goals leave that were met, and were not clear: other ends may be [m^2].
constexpr double kMetOnce = 1e-3;

/// Two ends came to the same if what they leave of wishes differs by no more than this share; of so
/// many ends so many have to have come to the best before others are not tried.
constexpr double kAlike = 2e-3;
constexpr int kAgreements = 5, kSettlements = 12;

}  // namespace

SolveState::SolveState(const Model& model, std::size_t ahead)
    : model_(model), trials_(ahead), candidates_(model.robot.dof()) {
  for (Eigen::VectorXd* each : {&start_, &lower_, &upper_, &best_.q})
    each->setZero(model_.robot.dof());
  for (Trial& trial : trials_) trial.q.setZero(model_.robot.dof());
}

void SolveState::begin(const Request& request, Result& result, const Deadline& deadline,
                       bool base_collides, bool in_turn) {
  request_ = request;
  result_ = &result;
  deadline_ = deadline;
  in_turn_ = in_turn;
  begin_result(result);
  wanted_ = wanted_of(base_collides);
  has_found_ = false;
  contact_.reset();
  contacts_.forget();
  repairs_ = agreed_ = settled_ = 0;
  begin_alternatives(base_collides);
  const int enough = wanted_.goals_alone ? kStartsForGoalAlone
                     : hopeless_         ? kStartsOutOfReach / alternatives()
                                         : model_.options.max_restarts;
  last_round_ = std::min(model_.options.max_restarts, enough);
  next_start_ = next_judged_ = 0;
  effort_ = {};
  candidates_.clear();
  set_bounds();
  seeds_ = nullptr;
  collection_ = nullptr;
}

Wanted SolveState::wanted_of(bool base_collides) const {
  const std::span<const Goal> first = goals(0);
  Wanted wanted;
  wanted.goals_alone = base_collides;
  wanted.redundant = model_.is_redundant(first);
  wanted.nearest = model_.options.prefer == Prefer::Nearest;
  wanted.wishes = std::ranges::any_of(first, &Goal::soft);
  wanted.compromises = std::ranges::any_of(
      first, [](const Goal& goal) { return goal.priority == Priority::Position; });
  wanted.center_of_mass = std::ranges::any_of(
      first, [](const Goal& goal) { return goal.type == GoalType::CenterOfMass; });
  wanted.posture = request_.posture != nullptr;
  wanted.costs = !request_.costs.empty();
  wanted.one_orientation = wanted.compromises && model_.has_joints_for(first);
  return wanted;
}

void SolveState::collect(Collection& into, const std::vector<Eigen::VectorXd>& from, bool are_all) {
  collection_ = &into;
  seeds_ = &from;
  if (!are_all) return;
  last_round_ = static_cast<int>(from.size()) - 1;
  if (from.empty()) startable_ = 0;
}

void SolveState::begin_alternatives(bool base_collides) {
  const int count = alternatives();
  live_.clear();
  given_up_.assign(static_cast<std::size_t>(count), 0);
  tool_checked_.assign(static_cast<std::size_t>(count), 0);
  if (count > 1) notes_.fill(Note{});
  hopeless_.reset();
  for (int k = 0; k < count; ++k) {
    const auto why = why_hopeless(model_, goals(k), base_collides);
    if (k == 0) hopeless_ = why;
    if (!why || count == 1) live_.push_back({k, 1.0, 0, 0});
  }
  if (live_.empty()) {  // all are: what comes nearest to any
    for (int k = 0; k < count; ++k) live_.push_back({k, 1.0, 0, 0});
  } else if (count > 1) {
    hopeless_.reset();
  }
  startable_ = static_cast<int>(live_.size());
  table_ = nullptr;
  if (count > 1 && !wanted_.nearest) look_up_starts();
  if (!wanted_.costs) return;
  std::ranges::stable_sort(live_, {}, [this](const Standing& s) { return cost(s.alternative); });
}

void SolveState::look_up_starts() {
  const int tip = goals(0).front().tip;
  const bool is_known = std::ranges::all_of(live_, [&](const Standing& standing) {
    const std::span<const Goal> asked = goals(standing.alternative);
    return asked.size() == 1 && asked.front().tip == tip && StartTable::knows(asked.front());
  });
  if (!is_known) return;
  table_ = &model_.starts_for(tip);
  for (Standing& standing : live_) {
    const StartTable::Nearest entry =
        table_->nearest(goals(standing.alternative).front(), model_.options.rotation_weight);
    standing.row = entry.row;
    // Where something costs less that is tried first, whatever it looks like.
    if (!wanted_.costs) standing.left = std::max<double>(entry.off, kMetOnce);
  }
}

void SolveState::set_bounds() {
  lower_ = model_.robot.lower();
  upper_ = model_.robot.upper();
  for (Eigen::Index i = 0; i < start_.size(); ++i) {
    const bool bounded = std::isfinite(lower_[i]) && std::isfinite(upper_[i]);
    start_[i] = request_.q0 != nullptr ? std::clamp((*request_.q0)[i], lower_[i], upper_[i])
                : bounded              ? 0.5 * (lower_[i] + upper_[i])
                                       : 0.0;
    if (model_.turns[static_cast<std::size_t>(i)] == Model::Turn::Bound) {
      lower_[i] = start_[i] - M_PI;
      upper_[i] = start_[i] + M_PI;
    }
    if (request_.max_step == nullptr) continue;
    lower_[i] = std::max(lower_[i], start_[i] - (*request_.max_step)[i]);
    upper_[i] = std::min(upper_[i], start_[i] + (*request_.max_step)[i]);
  }
  for (const Lock& lock : request_.locks)
    start_[lock.joint] = lower_[lock.joint] = upper_[lock.joint] = lock.position;
}

SolveState::Standing& SolveState::likeliest() {
  Standing* chosen = nullptr;
  double likeliest_left = 0.0;
  for (Standing& standing : live_) {
    if (standing.starts > last_round_) continue;
    const double looks = standing.left * std::pow(kLessLikely, standing.starts);
    if (chosen != nullptr && !(looks < likeliest_left)) continue;
    chosen = &standing;
    likeliest_left = looks;
  }
  return *chosen;
}

Trial& SolveState::take_start() {
  const int k = next_start_++;
  if (k >= kEndsKnown && live_.size() > 1) {
    const Note& note = notes_[static_cast<std::size_t>(k - kEndsKnown) % notes_.size()];
    for (Standing& standing : live_) {
      if (standing.alternative == note.alternative)
        standing.left = std::min(standing.left, note.left);
    }
  }
  Standing& standing = live_.size() == 1 ? live_.front() : likeliest();
  Trial& next = trial(k);
  next.is_known = false;
  next.number = k;
  next.alternative = standing.alternative;
  next.round = standing.starts++;
  next.row = standing.row;
  if (standing.starts > last_round_) --startable_;
  return next;
}

void SolveState::start_at(const Trial& trial, Eigen::VectorXd& q) const {
  if (trial.round < seed_count()) {
    q = (*seeds_)[static_cast<std::size_t>(trial.round)];
    return;
  }
  // Where a start is given it comes first. One from the table is enough: those next to it mostly
  // end where it does.
  if (table_ != nullptr && trial.round == (request_.q0 != nullptr ? 1 : 0)) {
    q = table_->q(trial.row);
    for (Eigen::Index i = 0; i < q.size(); ++i)
      if (!model_.matters[static_cast<std::size_t>(i)]) q[i] = start_[i];
    return;
  }
  if (trial.round == 0)
    q = start_;
  else
    draw(trial.round, q);
}

void SolveState::draw(int k, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!wanted_.center_of_mass && !model_.matters[static_cast<std::size_t>(i)]) {
      q[i] = start_[i];
      continue;
    }
    const bool bounded = std::isfinite(lower_[i]) && std::isfinite(upper_[i]);
    const double low = bounded ? lower_[i] : start_[i] - M_PI,
                 high = bounded ? upper_[i] : start_[i] + M_PI;
    q[i] = low + model_.sequence(k, i) * (high - low);
    if (!wanted_.nearest) continue;
    // Close to what is wanted as often as far from it: the whole range, half of it, a quarter, ...
    constexpr double kScales[] = {0.5, 0.25, 0.125, 1.0};
    q[i] = std::clamp(preferred()[i] + kScales[k % 4] * (q[i] - 0.5 * (low + high)), low, high);
  }
}

Trial* SolveState::next_ended() {
  if (next_judged_ >= next_start_ || !trial(next_judged_).is_known) return nullptr;
  return &trial(next_judged_++);
}

bool SolveState::count(const Trial& trial) {
  result_->iterations += trial.iterations;
  result_->evaluations += trial.evaluations;
  result_->restarts = trial.number;
  if (given_up_[static_cast<std::size_t>(trial.alternative)] != 0) return false;
  effort_.search(trial.evaluations);
  if (alternatives() > 1 && !wanted_.costs && !wanted_.best_of_many()) {
    const double left = trial.reached ? 0.0 : 2.0 * trial.value;
    notes_[static_cast<std::size_t>(trial.number) % notes_.size()] = {trial.alternative,
                                                                      std::max(left, kMetOnce)};
  }
  return true;
}

void SolveState::give_up(int alternative) {
  char& given_up = given_up_[static_cast<std::size_t>(alternative)];
  if (given_up != 0) return;
  given_up = 1;
  std::erase_if(live_, [&](const Standing& standing) {
    if (standing.alternative != alternative) return false;
    startable_ -= standing.starts <= last_round_ ? 1 : 0;
    return true;
  });
}

void SolveState::add_solution() {
  if (!has_found_) best_ = *result_;
  has_found_ = true;
  collection_->add(*result_);
}

bool SolveState::rank(int alternative, double left) {
  const double its_cost = cost(alternative);
  const bool is_best =
      !has_found_ || its_cost < least_cost_ || (its_cost == least_cost_ && left < least_);
  const bool is_agreed_on = wanted_.compromises && is_agreed(left, is_best);
  if (is_best) {
    has_found_ = true;
    least_ = left;
    least_cost_ = its_cost;
    best_ = *result_;
  }
  for (int other = 0; wanted_.costs && other < alternatives(); ++other) {
    const double theirs = cost(other);
    if (theirs > least_cost_ || (theirs == least_cost_ && !wanted_.best_of_many())) give_up(other);
  }
  return is_agreed_on || has_given_up();
}

bool SolveState::is_agreed(double left, bool is_best) {
  ++settled_;
  const bool is_alike = settled_ > 1 && std::abs(left - least_) <= kAlike * std::max(left, least_);
  agreed_ = is_alike ? agreed_ + 1 : is_best ? 1 : agreed_;
  const bool solves = result_->success && model_.options.prefer == Prefer::First &&
                      !wanted_.wishes && !wanted_.posture;
  return solves || (!wanted_.one_orientation && agreed_ >= kAgreements && settled_ >= kSettlements);
}

void SolveState::add_unjudged() {
  for (int k = next_judged_; k < next_start_ && wants_candidates(); ++k) {
    Trial& each = trial(k);
    if (!each.is_known) continue;
    model_.wrap(start_, each.q);
    add_unjudged(each.alternative, each.q, each.value);
  }
}

bool SolveState::may_check_tool(int alternative) {
  if (has_found_ || wanted_.goals_alone) return false;
  return std::exchange(tool_checked_[static_cast<std::size_t>(alternative)], char{1}) == 0;
}

bool SolveState::block(const Trial& trial, const WorstConstraint& contact) {
  contact_ = contact;
  give_up(trial.alternative);
  if (!has_given_up()) return false;
  block();
  candidates_.clear();  // nothing will be better than what reaches the goals
  candidates_.add(trial.q, trial.alternative, 0.0, true);
  return true;
}

}  // namespace pdoik::detail
