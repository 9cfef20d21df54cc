#include "search/all_solutions.hpp"

#include <algorithm>
#include <cmath>

#include "search/collection.hpp"
#include "search/derivatives.hpp"

namespace pdoik::detail {
namespace {

/// All solutions of one request.
class All final : public OneRequest {
 public:
  All(const Model& model, const Request& request, Result& result, Collection& collection)
      : OneRequest(request, result), model_(model), collection_(collection) {}

  void prepare(SolveState& solve) override {
    const std::span<const Goal> goals = solve.request().goals;
    const Goal& goal = goals.front();
    const ClosedForm& form = model_.closed_forms[static_cast<std::size_t>(goal.tip)];
    const bool is_closed = form.is_known() && goals.size() == 1 && goal.type == GoalType::Pose &&
                           goal.relative_to < 0 && !goal.soft && goal.position_slack.isZero(0.0) &&
                           goal.rotation_slack.isZero(0.0);
    if (is_closed) {
      form.solve(goal.T_base_tip * goal.T_tip_tool.inverse(), solve.start(), solve.lower(),
                 solve.upper(), seeds_);
      if (form.is_exact()) collection_.expect_no_others();
    }
    solve.collect(collection_, seeds_, collection_.expects_no_others());
  }

 private:
  const Model& model_;
  Collection& collection_;
  std::vector<Eigen::VectorXd> seeds_;
};

}  // namespace

int whole_turns(const Model& model, const Eigen::VectorXd& q) {
  int ways = 1;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (model.turns[static_cast<std::size_t>(i)] != Model::Turn::Whole) continue;
    const double up = (model.robot.upper()[i] - q[i]) / (2.0 * M_PI),
                 down = (q[i] - model.robot.lower()[i]) / (2.0 * M_PI);
    ways *= 1 + static_cast<int>(std::floor(up)) + static_cast<int>(std::floor(down));
  }
  return ways;
}

Solutions all_solutions(Workspace& workspace, Multistart& multistart, const Request& request,
                        const AllOptions& wanted, Result& best) {
  const Model& model = workspace.model();
  Collection collection(model, wanted);
  All requests(model, request, best, collection);
  multistart.run(requests);

  Solutions all;
  all.status = best.status;
  all.restarts = best.restarts;
  all.time = best.time;
  all.results = std::move(collection.results);
  Eigen::VectorXd wanted_at = model.robot.mid_configuration();
  if (request.q0 != nullptr) wanted_at = *request.q0;
  if (request.posture != nullptr) wanted_at = *request.posture;
  const auto way = [&](const Result& to) {
    return ((to.q - wanted_at).array().square() * model.pull.array()).sum();
  };
  std::ranges::stable_sort(all.results, {}, way);
  if (wanted.limit > 0 && all.results.size() > static_cast<std::size_t>(wanted.limit))
    all.results.resize(static_cast<std::size_t>(wanted.limit));
  all.complete = collection.expects_no_others() && best.status != Status::TimeLimit;
  for (Result& each : all.results) {
    each.status = Status::Solved;
    all.turns.push_back(whole_turns(model, each.q));
    all.complete = all.complete && !is_singular(workspace, request.goals, each.q);
  }
  all.coverage = all.complete ? 1.0 : collection.coverage();
  if (!all.results.empty()) all.status = Status::Solved;
  return all;
}

}  // namespace pdoik::detail
