#include "detail/attempt.hpp"

#include <algorithm>
#include <cmath>

#include "detail/outcome.hpp"

namespace pdoik::detail {
namespace {

/// Starts where no answer can exist: for the nearest to a target out of reach; for the goal alone
/// where the base is in collision, which ends with the first that reaches it.
constexpr int kStartsOutOfReach = 16, kStartsForGoalAlone = 100;

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
  hopeless = why_hopeless(*model, request.goals, base_collides);
  redundant = model->is_redundant(request.goals);
  nearest = options.prefer == Prefer::Nearest;
  found = tool_checked = false;
  contact.reset();
  common.forget();
  repairs = 0;
  const int enough = for_goals_alone ? kStartsForGoalAlone
                     : hopeless      ? kStartsOutOfReach
                                     : options.max_restarts;
  last_start = std::min(options.max_restarts, enough);
  next_start = next_verdict = lanes = 0;
  search_cost = repair_cost = measure_cost = 0.0;
  candidates.clear();
  set_bounds();
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
}

void Attempt::start_at(int k, Eigen::VectorXd& q) const {
  if (k == 0)
    q = start;
  else
    draw(k, q);
}

void Attempt::draw(int k, Eigen::VectorXd& q) const {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!model->matters[static_cast<std::size_t>(i)]) {
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
