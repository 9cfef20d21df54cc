#include "detail/lane_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "detail/frame.hpp"
#include "detail/rollout.hpp"

namespace pdoik::detail {

namespace {

/// The axis that a unit vector lies along, to rounding, as LaneProblem::onto has it.
signed char along_axis(const Vec4& v) {
  constexpr double kRounding = 1e-15;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (std::abs(v[j]) <= kRounding && std::abs(v[k]) <= kRounding)
      return static_cast<signed char>(v[i] > 0.0 ? i + 1 : -i - 1);
  }
  return 0;
}

}  // namespace

LaneSearch::LaneSearch(const Robot& robot, const Options& options)
    : joints_(rollout_joints(robot)), problem_{} {
  for (const int link : robot.tips()) {
    Tip tip{{}, {}, to_frame(robot.T_body_link(link))};
    tip.chain.push_back(robot.body_of_link(link));
    while (tip.chain.back() > 0)
      tip.chain.push_back(robot.bodies()[static_cast<std::size_t>(tip.chain.back())].parent);
    for (const int body : tip.chain) {
      if (body > 0) tip.dofs.push_back(robot.bodies()[static_cast<std::size_t>(body)].dof);
    }
    std::sort(tip.dofs.begin(), tip.dofs.end());
    tip.dofs.erase(std::unique(tip.dofs.begin(), tip.dofs.end()), tip.dofs.end());
    tips_.push_back(std::move(tip));
  }
  kind_.reserve(tips_.size());
  goals_.resize(tips_.size());

  const int n = robot.dof(), triangle = n * (n + 1) / 2;
  LaneProblem& p = problem_;
  p.joints = joints_.data();
  for (const RolloutJoint& joint : joints_)
    onto_.push_back(
        {along_axis(joint.fixed.x), along_axis(joint.fixed.y), along_axis(joint.fixed.z)});
  p.onto = reinterpret_cast<const signed char (*)[3]>(onto_.data());
  p.bodies = static_cast<int>(joints_.size());
  p.dof = n;
  p.goals = goals_.data();
  p.rotation_weight = options.rotation_weight;
  p.position_tolerance2 = options.position_tolerance * options.position_tolerance;
  p.rotation_tolerance2 = options.rotation_tolerance * options.rotation_tolerance;
  const LevenbergMarquardtOptions& lm = options.levenberg_marquardt;
  p.max_iterations = lm.max_iterations;
  p.first_damping = lm.first_damping;
  p.damping_decrease = lm.damping_decrease;
  p.damping_increase = lm.damping_increase;
  p.max_damping = lm.max_damping;

  int rows = 0;
  const auto lay_out = [&](double* base) {  // the first time only to count
    rows = 0;
    const auto take = [&](int count) {
      double* const at = base == nullptr ? nullptr : base + rows * kernel_.width;
      rows += count;
      return at;
    };
    for (double** each : {&p.lower, &p.upper, &p.x, &p.trial, &p.gradient, &p.step, &p.is_free})
      *each = take(n);
    p.hessian = take(triangle);
    p.errors = take(kGoalRows * static_cast<int>(goals_.size()));
    for (double** each :
         {&p.state, &p.value, &p.damping, &p.scale, &p.reference, &p.since_reference,
          &p.stall_ratio, &p.stall_window, &p.iterations, &p.evaluations, &p.fresh})
      *each = take(1);
    p.frames = take(12 * p.bodies);
    p.columns = take(6 * n);
    p.factor = take(n * n);
    for (LaneGoal& goal : goals_) {
      goal.target = take(12);
      goal.slack = take(6);
      goal.weight = take(1);
    }
  };
  lay_out(nullptr);
  const std::size_t numbers = static_cast<std::size_t>(rows) * static_cast<std::size_t>(width());
  memory_.resize(numbers * sizeof(double) / sizeof(Line) + 1);
  lay_out(memory_.front().numbers);
}

bool LaneSearch::is_kind_of(std::span<const Goal> goals) const {
  const auto has_slack = [](const Goal& goal) {
    return !goal.position_slack.isZero(0.0) || !goal.rotation_slack.isZero(0.0);
  };
  return std::equal(goals.begin(), goals.end(), kind_.begin(), kind_.end(),
                    [&](const Goal& a, const Goal& b) {
                      return a.tip == b.tip && a.type == b.type && a.axis == b.axis &&
                             has_slack(a) == has_slack(b);
                    });
}

void LaneSearch::set_kind(std::span<const Goal> goals) {
  kind_.assign(goals.begin(), goals.end());
  for (std::size_t k = 0; k < goals.size(); ++k) {
    const Goal& asked = goals[k];
    const Tip& tip = tips_[static_cast<std::size_t>(asked.tip)];
    LaneGoal& goal = goals_[k];
    goal.turns = asked.type != GoalType::Position;
    goal.by_axis = asked.type == GoalType::Axis;
    goal.has_slack = !asked.position_slack.isZero(0.0) || !asked.rotation_slack.isZero(0.0);
    goal.chain = tip.chain.data();
    goal.chain_length = static_cast<int>(tip.chain.size()) - 1;
    goal.dofs = tip.dofs.data();
    goal.dof_count = static_cast<int>(tip.dofs.size());
    goal.T_body_tip = tip.T_body_tip;
    goal.axis = to_vec4(asked.axis.normalized());
  }
  problem_.goal_count = static_cast<int>(goals.size());
}

void LaneSearch::start(int lane, std::span<const Goal> goals, const Eigen::VectorXd& q,
                       const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                       Patience patience) {
  const LaneProblem& p = problem_;
  for (int i = 0; i < p.dof; ++i) {
    const double inside = std::min(std::max(q[i], lower[i]), upper[i]);
    set(p.lower, i, lane, lower[i]);
    set(p.upper, i, lane, upper[i]);
    set(p.x, i, lane, inside);
    set(p.trial, i, lane, inside);
  }
  for (std::size_t k = 0; k < goals.size(); ++k) {
    const Goal& asked = goals[k];
    const LaneGoal& goal = goals_[k];
    for (int i = 0; i < 12; ++i) set(goal.target, i, lane, asked.T_base_tip.matrix()(i % 3, i / 3));
    for (int i = 0; i < 3; ++i) {
      set(goal.slack, i, lane, asked.position_slack[i]);
      set(goal.slack, 3 + i, lane, asked.rotation_slack[i]);
    }
    set(goal.weight, 0, lane, asked.weight);
  }
  for (double* each :
       {p.damping, p.scale, p.reference, p.since_reference, p.iterations, p.evaluations})
    each[lane] = 0.0;
  p.state[lane] = static_cast<double>(LaneState::Running);
  p.value[lane] = std::numeric_limits<double>::infinity();
  p.stall_ratio[lane] = patience.stall_ratio;
  p.stall_window[lane] = patience.stall_window;
  p.fresh[lane] = 1.0;
}

LaneSearch::End LaneSearch::end(int lane, Eigen::VectorXd& q) const {
  const LaneProblem& p = problem_;
  for (int i = 0; i < p.dof; ++i) q[i] = p.x[i * kernel_.width + lane];
  return {p.state[lane] == static_cast<double>(LaneState::Done), p.value[lane],
          static_cast<int>(p.iterations[lane]), static_cast<int>(p.evaluations[lane])};
}

}  // namespace pdoik::detail
