#include "search/lane_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/frame.hpp"
#include "kinematics/goal_of.hpp"
#include "kinematics/rollout.hpp"

namespace pdoik::detail {

namespace {

/// The axis that a unit vector lies along, to rounding, as LaneProblem::onto has it.
signed char along_axis(const Vec4& v) {
  constexpr double kAlong = 1e-15;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (std::abs(v[j]) <= kAlong && std::abs(v[k]) <= kAlong)
      return static_cast<signed char>(v[i] > 0.0 ? i + 1 : -i - 1);
  }
  return 0;
}

}  // namespace

LaneSearch::LaneSearch(const Robot& robot, const Options& options)
    : options_(options), joints_(rollout_joints(robot)), problem_{} {
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
  kind_.reserve(kMostGoals);
  goals_.resize(2 * tips_.size());
  dofs_.resize(goals_.size());
  for (std::vector<int>& dofs : dofs_) dofs.reserve(static_cast<std::size_t>(2 * robot.dof()));

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
      goal.in_reference = take(12);
      goal.slack = take(6);
      goal.weight = take(1);
      goal.turning = take(1);
    }
  };
  lay_out(nullptr);
  const std::size_t numbers = static_cast<std::size_t>(rows) * static_cast<std::size_t>(width());
  memory_.resize(numbers * sizeof(double) / sizeof(Line) + 1);
  lay_out(memory_.front().numbers);
}

bool LaneSearch::knows(std::span<const Goal> goals) const {
  const auto hard = static_cast<std::size_t>(
      std::ranges::count_if(goals, [](const Goal& goal) { return !goal.soft; }));
  const bool of_mass = std::ranges::any_of(
      goals, [](const Goal& goal) { return goal.type == GoalType::CenterOfMass; });
  return !of_mass && hard >= 1 && hard <= goals_.size();
}

bool LaneSearch::are_alike(std::span<const Goal> goals, std::span<const Goal> others) {
  return std::equal(
      goals.begin(), goals.end(), others.begin(), others.end(), [](const Goal& a, const Goal& b) {
        return a.tip == b.tip && a.relative_to == b.relative_to && a.type == b.type &&
               a.axis == b.axis && a.soft == b.soft && a.priority == b.priority &&
               has_slack(a) == has_slack(b) && a.position_tolerance == b.position_tolerance &&
               a.rotation_tolerance == b.rotation_tolerance &&
               a.T_tip_tool.matrix() == b.T_tip_tool.matrix();
      });
}

void LaneSearch::set_kind(std::span<const Goal> goals) {
  kind_.assign(goals.begin(), goals.end());
  problem_.goal_count = 0;
  const auto squared = [](double tolerance) { return tolerance * tolerance; };
  for (const Goal& asked : goals) {
    if (asked.soft) continue;
    const Tip& tip = tips_[static_cast<std::size_t>(asked.tip)];
    std::vector<int>& dofs = dofs_[static_cast<std::size_t>(problem_.goal_count)];
    LaneGoal& goal = goals_[static_cast<std::size_t>(problem_.goal_count++)];
    goal.turns = asked.type != GoalType::Position;
    goal.yields = asked.priority == Priority::Position;
    goal.looks = asked.type == GoalType::LookAt;
    goal.by_axis = goal.turns && asked.type != GoalType::Pose;
    goal.is_placed = !goal.looks;
    goal.has_slack = has_slack(asked);
    goal.position_tolerance2 = squared(position_tolerance(asked, options_));
    goal.rotation_tolerance2 = squared(rotation_tolerance(asked, options_));
    goal.chain = tip.chain.data();
    goal.chain_length = static_cast<int>(tip.chain.size()) - 1;
    dofs = tip.dofs;
    goal.reference_chain = nullptr;
    goal.reference_chain_length = 0;
    if (asked.relative_to >= 0) {
      const Tip& reference = tips_[static_cast<std::size_t>(asked.relative_to)];
      goal.reference_chain = reference.chain.data();
      goal.reference_chain_length = static_cast<int>(reference.chain.size()) - 1;
      dofs.insert(dofs.end(), reference.dofs.begin(), reference.dofs.end());
      std::sort(dofs.begin(), dofs.end());
      dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
    }
    goal.dofs = dofs.data();
    goal.dof_count = static_cast<int>(dofs.size());
    goal.T_body_tip = compose(tip.T_body_tip, to_frame(asked.T_tip_tool));
    goal.axis = to_vec4(asked.axis.normalized());
  }
}

void LaneSearch::start(int lane, std::span<const Goal> goals, const Eigen::VectorXd& q,
                       const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                       Patience patience, bool yields) {
  const LaneProblem& p = problem_;
  for (int i = 0; i < p.dof; ++i) {
    const double inside = std::min(std::max(q[i], lower[i]), upper[i]);
    set(p.lower, i, lane, lower[i]);
    set(p.upper, i, lane, upper[i]);
    set(p.x, i, lane, inside);
    set(p.trial, i, lane, inside);
  }
  std::size_t k = 0;
  for (const Goal& asked : goals) {
    if (asked.soft) continue;
    const LaneGoal& goal = goals_[k++];
    if (asked.relative_to < 0) {
      for (int i = 0; i < 12; ++i)
        set(goal.target, i, lane, asked.T_base_tip.matrix()(i % 3, i / 3));
    } else {
      // What moves with a tip that no joint moves stands still.
      const Tip& reference = tips_[static_cast<std::size_t>(asked.relative_to)];
      const Frame T = compose(reference.T_body_tip, to_frame(asked.T_base_tip));
      double* const rows = goal.reference_chain_length > 0 ? goal.in_reference : goal.target;
      const Vec4* const axes[] = {&T.x, &T.y, &T.z, &T.p};
      for (int i = 0; i < 12; ++i) set(rows, i, lane, (*axes[i / 3])[i % 3]);
    }
    for (int i = 0; i < 3; ++i) {
      set(goal.slack, i, lane, asked.position_slack[i]);
      set(goal.slack, 3 + i, lane, asked.rotation_slack[i]);
    }
    set(goal.weight, 0, lane, asked.weight);
    set(goal.turning, 0, lane, yields ? 0.0 : 1.0);
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
