#include "detail/attempt.hpp"

#include <algorithm>
#include <cmath>

#include "detail/outcome.hpp"

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

}  // namespace

Attempt::Attempt(const Model& model_in, std::size_t ahead)
    : model(&model_in), trials(ahead), candidates(model_in.robot.dof()) {
  for (Eigen::VectorXd* each : {&start, &lower, &upper, &best.q}) each->setZero(model->robot.dof());
  for (Trial& trial : trials) trial.q.setZero(model->robot.dof());
}

void Attempt::begin(const Request& request_in, Result& result_in, const Deadline& deadline_in,
                    bool base_collides) {
  const Options& options = model->options;
  request = request_in;
  result = &result_in;
  deadline = deadline_in;
  begin_result(*result);
  for_goals_alone = base_collides;
  const std::span<const Goal> first = goals(0);
  redundant = model->is_redundant(first);
  wishes = std::ranges::any_of(first, &Goal::soft);
  compromises = std::ranges::any_of(
      first, [](const Goal& goal) { return goal.priority == Priority::Position; });
  of_mass = std::ranges::any_of(
      first, [](const Goal& goal) { return goal.type == GoalType::CenterOfMass; });
  nearest = options.prefer == Prefer::Nearest;
  ranks = nearest || compromises;
  redundant_for_all = compromises && model->has_joints_for(first);
  found = false;
  contact.reset();
  common.forget();
  repairs = agreed = settled = 0;
  begin_alternatives(base_collides);
  const int enough = for_goals_alone ? kStartsForGoalAlone
                     : hopeless      ? kStartsOutOfReach / alternatives()
                                     : options.max_restarts;
  last_round = std::min(options.max_restarts, enough);
  next_start = next_verdict = lanes = 0;
  search_cost = repair_cost = measure_cost = 0.0;
  candidates.clear();
  set_bounds();
  seeds = nullptr;
  collection = nullptr;
}

void Attempt::collect(Collection& into, const std::vector<Eigen::VectorXd>& from, bool are_all) {
  collection = &into;
  seeds = &from;
  if (!are_all) return;
  last_round = static_cast<int>(from.size()) - 1;
  if (from.empty()) startable = 0;
}

void Attempt::begin_alternatives(bool base_collides) {
  const int count = alternatives();
  live.clear();
  given_up.assign(static_cast<std::size_t>(count), 0);
  tool_checked.assign(static_cast<std::size_t>(count), 0);
  if (count > 1) notes_.fill(Note{});
  hopeless.reset();
  for (int k = 0; k < count; ++k) {
    const auto why = why_hopeless(*model, goals(k), base_collides);
    if (k == 0) hopeless = why;
    if (!why || count == 1) live.push_back({k, 1.0, 0, 0});
  }
  if (live.empty()) {  // all are: what comes nearest to any
    for (int k = 0; k < count; ++k) live.push_back({k, 1.0, 0, 0});
  } else if (count > 1) {
    hopeless.reset();
  }
  startable = static_cast<int>(live.size());
  table = nullptr;
  if (count > 1 && !nearest) look_up_starts();
  if (request.costs.empty()) return;
  std::ranges::stable_sort(live, {}, [this](const Standing& s) { return cost(s.alternative); });
}

void Attempt::look_up_starts() {
  const int tip = goals(0).front().tip;
  const bool is_known = std::ranges::all_of(live, [&](const Standing& standing) {
    const std::span<const Goal> asked = goals(standing.alternative);
    return asked.size() == 1 && asked.front().tip == tip && StartTable::knows(asked.front());
  });
  if (!is_known) return;
  table = &model->starts_for(tip);
  for (Standing& standing : live) {
    const StartTable::Nearest entry =
        table->nearest(goals(standing.alternative).front(), model->options.rotation_weight);
    standing.row = entry.row;
    // Where something costs less that is tried first, whatever it looks like.
    if (request.costs.empty()) standing.left = std::max<double>(entry.off, kMetOnce);
  }
}

void Attempt::give_up(int alternative) {
  if (is_given_up(alternative)) return;
  given_up[static_cast<std::size_t>(alternative)] = 1;
  std::erase_if(live, [&](const Standing& standing) {
    if (standing.alternative != alternative) return false;
    startable -= standing.starts <= last_round ? 1 : 0;
    return true;
  });
}

void Attempt::note_left(int k, double left) {
  notes_[static_cast<std::size_t>(k) % notes_.size()] = {trial(k).alternative,
                                                         std::max(left, kMetOnce)};
}

Attempt::Standing& Attempt::likeliest() {
  Standing* chosen = nullptr;
  double likeliest_left = 0.0;
  for (Standing& standing : live) {
    if (standing.starts > last_round) continue;
    const double looks = standing.left * std::pow(kLessLikely, standing.starts);
    if (chosen != nullptr && !(looks < likeliest_left)) continue;
    chosen = &standing;
    likeliest_left = looks;
  }
  return *chosen;
}

int Attempt::take_start() {
  const int k = next_start++;
  if (k >= kVerdictsKnown && live.size() > 1) {
    const Note& note = notes_[static_cast<std::size_t>(k - kVerdictsKnown) % notes_.size()];
    for (Standing& standing : live) {
      if (standing.alternative == note.alternative)
        standing.left = std::min(standing.left, note.left);
    }
  }
  Standing& standing = live.size() == 1 ? live.front() : likeliest();
  Trial& next = trial(k);
  next.is_known = false;
  next.alternative = standing.alternative;
  next.round = standing.starts++;
  next.row = standing.row;
  if (standing.starts > last_round) --startable;
  return k;
}

void Attempt::set_bounds() {
  lower = model->robot.lower();
  upper = model->robot.upper();
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    const bool bounded = std::isfinite(lower[i]) && std::isfinite(upper[i]);
    start[i] = request.q0 != nullptr ? std::clamp((*request.q0)[i], lower[i], upper[i])
               : bounded             ? 0.5 * (lower[i] + upper[i])
                                     : 0.0;
    if (model->turns[static_cast<std::size_t>(i)] == Model::Turn::Bound) {
      lower[i] = start[i] - M_PI;
      upper[i] = start[i] + M_PI;
    }
    if (request.max_step == nullptr) continue;
    lower[i] = std::max(lower[i], start[i] - (*request.max_step)[i]);
    upper[i] = std::min(upper[i], start[i] + (*request.max_step)[i]);
  }
  for (const Lock& lock : request.locks)
    start[lock.joint] = lower[lock.joint] = upper[lock.joint] = lock.position;
}

void Attempt::start_at(const Trial& trial, Eigen::VectorXd& q) const {
  const int count = seeds == nullptr ? 0 : static_cast<int>(seeds->size());
  if (trial.round < count) {
    q = (*seeds)[static_cast<std::size_t>(trial.round)];
    return;
  }
  // Where a start is given it comes first. One from the table is enough: those next to it mostly
  // end where it does.
  if (table != nullptr && trial.round == (request.q0 != nullptr ? 1 : 0)) {
    q = table->q(trial.row);
    for (Eigen::Index i = 0; i < q.size(); ++i)
      if (!model->matters[static_cast<std::size_t>(i)]) q[i] = start[i];
    return;
  }
  if (trial.round == 0)
    q = start;
  else
    draw(trial.round, q);
}

void Attempt::draw(int k, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!of_mass && !model->matters[static_cast<std::size_t>(i)]) {
      q[i] = start[i];
      continue;
    }
    const bool bounded = std::isfinite(lower[i]) && std::isfinite(upper[i]);
    const double low = bounded ? lower[i] : start[i] - M_PI,
                 high = bounded ? upper[i] : start[i] + M_PI;
    q[i] = low + model->sequence(k, i) * (high - low);
    if (!nearest) continue;
    // Close to what is wanted as often as far from it: the whole range, half of it, a quarter, ...
    constexpr double kScales[] = {0.5, 0.25, 0.125, 1.0};
    q[i] = std::clamp(wanted()[i] + kScales[k % 4] * (q[i] - 0.5 * (low + high)), low, high);
  }
}

}  // namespace pdoik::detail
