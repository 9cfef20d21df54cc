#include "detail/search.hpp"

#include <algorithm>
#include <cmath>

namespace pdoik::detail {
namespace {

AugmentedLagrangianOptions lagrangian_options(const Options& options) {
  AugmentedLagrangianOptions result = options.augmented_lagrangian;
  if (options.method == Method::Paper) result.form = PenaltyForm::Printed;
  return result;
}

std::vector<bool> joints_that_matter(const Robot& robot, const HullModel& hulls) {
  std::vector<bool> matters(static_cast<std::size_t>(robot.dof()), false);
  const auto mark = [&](int body) {
    for (int b = body; b > 0; b = robot.bodies()[static_cast<std::size_t>(b)].parent) {
      matters[static_cast<std::size_t>(robot.bodies()[static_cast<std::size_t>(b)].dof)] = true;
    }
  };
  for (const int tip : robot.tips()) mark(robot.body_of_link(tip));
  for (const AttachedPoint& point : hulls.points) mark(point.body);
  return matters;
}

/// Where only one start will do, slow progress is still progress.
LevenbergMarquardtOptions patient(LevenbergMarquardtOptions options) {
  options.stall_ratio = std::max(options.stall_ratio, 0.95);
  options.stall_window = std::max(options.stall_window, 4);
  return options;
}

int goal_dimensions(GoalType goal) {
  return goal == GoalType::Pose ? 6 : goal == GoalType::Axis ? 5 : 3;
}

/// What the solve may spend on bringing answers clear of obstacles, of what it spends on finding
/// answers.
constexpr double kRepairShare = 0.1;
/// Obstacles this far from the hulls are left out while that is done [m].
constexpr double kRepairMargin = 0.1;
/// Looking at this many obstacles costs about as much as evaluating the goal.
double cost_of(int obstacles) { return obstacles / 60.0; }

}  // namespace

Search::Search(const Robot& robot, const Options& options)
    : robot_(robot),
      options_(options),
      hulls_(robot, options.heed_fixed_hulls),
      collision_(hulls_, hulls_.moving),
      fixed_hulls_(hulls_, hulls_.fixed),
      rollout_(robot),
      map_(robot, JointLimitMap::Slack::Shared),
      lagrangian_(map_, rollout_, goals_, collision_, scene_, options_.point_distance, robot.dof()),
      least_squares_(rollout_, goals_, collision_, scene_, options_, robot.dof()),
      augmented_lagrangian_(map_.size(), lagrangian_options(options), options.lbfgs),
      levenberg_marquardt_(robot.dof(), options.levenberg_marquardt),
      patient_(robot.dof(), patient(options.levenberg_marquardt)),
      judge_(robot, options_, hulls_),
      sequence_(robot.dof(), options.seed),
      candidates_(robot.dof()),
      lower_(robot.lower()),
      upper_(robot.upper()),
      matters_(joints_that_matter(robot, hulls_)) {
  for (Eigen::Index i = 0; i < robot.dof(); ++i) {
    const bool turns = std::isinf(lower_[i]) &&
                       robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Continuous;
    turns_.push_back(turns ? Turn::Wrap : Turn::Limited);
  }
  for (const Body& body : robot.bodies()) {
    if (body.dof < 0 || (!body.prismatic && body.multiplier == std::round(body.multiplier)))
      continue;
    Turn& turn = turns_[static_cast<std::size_t>(body.dof)];
    if (turn == Turn::Wrap) turn = Turn::Bound;
  }
  const int tip = robot.tips().front();
  goals_.emplace_back(robot.body_of_link(tip), robot.T_body_link(tip), options.goal,
                      options.goal_axis);
  redundant_ = std::count(matters_.begin(), matters_.end(), true) > goal_dimensions(options.goal);
  start_.setZero(robot.dof());
  q_.setZero(robot.dof());
  omega_.setZero(map_.size());
  Points none(0, 3);
  scene_.reserve(static_cast<std::size_t>(options.max_obstacles));
  const int padded = (options.max_obstacles + kLanes - 1) / kLanes * kLanes;
  reserve(padded);
  set_obstacles(none);

  reach_root_ = Eigen::Vector3d::Zero();
  double length = robot.T_body_link(tip).translation().norm();
  for (int b = robot.body_of_link(tip); b > 0;) {
    const Body& body = robot.bodies()[static_cast<std::size_t>(b)];
    if (body.prismatic) {
      length += std::max(std::abs(body.multiplier * lower_[body.dof] + body.offset),
                         std::abs(body.multiplier * upper_[body.dof] + body.offset));
    }
    reach_root_ = body.T_parent_joint.translation();
    b = body.parent;
    if (b > 0) length += body.T_parent_joint.translation().norm();
  }
  reach_ = length;
}

void Search::reserve(int padded_obstacles) {
  collision_.reserve(padded_obstacles);
  fixed_hulls_.reserve(padded_obstacles);
  lagrangian_.reserve(padded_obstacles);
  least_squares_.reserve(padded_obstacles);
  judge_.reserve(padded_obstacles);
}

void Search::set_obstacles(const Obstacles& points) {
  lagrangian_.reset_multipliers();
  scene_.assign(points, options_.clearance, hulls_, fixed_hulls_);
  reserve(scene_.near.padded());
}

void Search::copy_scene(const Search& other) {
  scene_ = other.scene_;
  reserve(scene_.near.padded());
}

bool Search::out_of_reach(const Eigen::Isometry3d& target) const {
  const double slack = options_.position_tolerance + 1e-9 * reach_;
  return (target.translation() - reach_root_).norm() > reach_ + slack;
}

void Search::run(const Eigen::Isometry3d& target, const Eigen::VectorXd* q0, Result& result) {
  const Deadline deadline(options_.max_time, interrupt_);
  goals_.front().set_target(target);
  result.iterations = result.evaluations = result.restarts = 0;
  result.success = false;
  if (options_.method == Method::Paper) {
    run_paper(target, q0, deadline, result);
  } else {
    run_default(target, q0, deadline, result);
  }
  if (!result.success && base_collides())
    result.status = Status::BaseCollision;
  else if (!result.success && out_of_reach(target))
    result.status = Status::OutOfReach;
  result.time = deadline.elapsed();
}

void Search::run_paper(const Eigen::Isometry3d& target, const Eigen::VectorXd* q0,
                       const Deadline& deadline, Result& result) {
  if (q0 != nullptr) {
    map_.inverse(*q0, omega_, options_.start_inset);
    start_ = *q0;
  } else {
    omega_.setZero();  // Algorithm IK, line 1
    map_.positions(omega_, start_);
  }
  const bool struck = minimise_lagrangian(deadline, result);
  map_.positions(omega_, q_);  // Eq. recovery
  wrap_to_start();
  judge_(target, q_, scene_, result);
  result.status = result.success ? Status::Solved : struck ? Status::TimeLimit : Status::Exhausted;
}

bool Search::minimise_lagrangian(const Deadline& deadline, Result& result) {
  bool struck = false;
  const double p = options_.position_tolerance, r = options_.rotation_tolerance;
  const auto stop = [&](const Eigen::VectorXd&, double) {
    const GoalTerm& goal = goals_.front();
    if (goal.position_distance() < p && goal.rotation_distance() < r &&
        lagrangian_.last_max_constraint() <= 0.5 * options_.clearance_tolerance) {
      return true;
    }
    struck = deadline.passed();
    return struck;
  };
  const AugmentedLagrangianResult inner = augmented_lagrangian_.minimize(lagrangian_, omega_, stop);
  result.iterations += inner.iterations;
  result.evaluations += inner.evaluations;
  return struck;
}

double Search::minimise_least_squares(LevenbergMarquardt& minimiser, const Deadline& deadline,
                                      Result& result, bool& struck) {
  const LevenbergMarquardtResult inner = minimiser.minimize(
      least_squares_, q_, lower_, upper_, [&] { return struck = deadline.passed(); });
  result.iterations += inner.iterations;
  result.evaluations += inner.evaluations;
  return inner.value;
}

Search::Trial Search::try_least_squares(bool stay_near, const Deadline& deadline, Result& result) {
  Trial trial;
  least_squares_.heed_none();
  const int before = result.evaluations;
  LevenbergMarquardt& minimiser = stay_near ? patient_ : levenberg_marquardt_;
  double value = minimise_least_squares(minimiser, deadline, result, trial.struck);
  wrap_to_start();
  search_cost_ += result.evaluations - before;
  const int points = scene_.near.count();
  if (least_squares_.done()) {
    search_cost_ += cost_of(points);
    trial.solves = points == 0 || !least_squares_.touches();
    trial.shortfall = value;
    if (trial.solves || trial.struck) return trial;
    if (redundant_ && (stay_near || repair_pays(points))) {
      const int at = result.evaluations;
      least_squares_.heed_those_about(kRepairMargin);
      value = minimise_least_squares(minimiser, deadline, result, trial.struck);
      wrap_to_start();
      least_squares_.evaluate(q_);  // its last step may have been taken back
      const double each = 1.0 + cost_of(least_squares_.heeded());
      repair_cost_ += 2.0 * cost_of(points) + each * (result.evaluations - at);
      trial.solves = least_squares_.reached() && !least_squares_.touches();
    }
  }
  trial.shortfall = value;
  return trial;
}

bool Search::repair_pays(int points) const {
  constexpr int kUsualEvaluations = 8, kUsuallyAbout = 200;
  const double usual =
      2.0 * cost_of(points) + kUsualEvaluations * (1.0 + cost_of(std::min(points, kUsuallyAbout)));
  return repair_cost_ + usual < kRepairShare * search_cost_;
}

Search::Trial Search::try_lagrangian(const Deadline& deadline, Result& result) {
  Trial trial;
  map_.inverse(q_, omega_, options_.start_inset);
  trial.struck = minimise_lagrangian(deadline, result);
  map_.positions(omega_, q_);
  wrap_to_start();
  trial.solves = true;  // perhaps: the judge will say
  trial.shortfall = 0.0;
  return trial;
}

void Search::run_default(const Eigen::Isometry3d& target, const Eigen::VectorXd* q0,
                         const Deadline& deadline, Result& result) {
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const bool bounded = std::isfinite(robot_.lower()[i]) && std::isfinite(robot_.upper()[i]);
    start_[i] = q0 != nullptr ? std::clamp((*q0)[i], robot_.lower()[i], robot_.upper()[i])
                : bounded     ? 0.5 * (robot_.lower()[i] + robot_.upper()[i])
                              : 0.0;
  }
  bound_turns();
  search_cost_ = repair_cost_ = 0.0;
  candidates_.clear();
  result.status = Status::Exhausted;
  for (int k = 0; k <= options_.max_restarts; ++k) {
    if (k == 0) {
      q_ = start_;
    } else {
      restart_configuration(k);
      result.restarts = k;
    }
    const Trial trial = options_.inner == InnerMethod::LevenbergMarquardt
                            ? try_least_squares(k == 0 && q0 != nullptr, deadline, result)
                            : try_lagrangian(deadline, result);
    if (trial.solves) {
      judge_(target, q_, scene_, result);
      if (result.success) {
        result.status = Status::Solved;
        return;
      }
    }
    candidates_.add(q_, trial.shortfall);
    if (trial.struck) {
      result.status = Status::TimeLimit;
      break;
    }
    if (trial.solves && base_collides()) break;  // nothing better can be found
  }
  least_squares_.heed_all();
  judge_(target, candidates_.best([&](const auto& q) { return least_squares_.evaluate(q); }),
         scene_, result);
}

void Search::restart_configuration(int k) {
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    if (!matters_[static_cast<std::size_t>(i)]) {
      q_[i] = start_[i];
      continue;
    }
    const bool bounded = std::isfinite(lower_[i]) && std::isfinite(upper_[i]);
    const double low = bounded ? lower_[i] : start_[i] - M_PI,
                 high = bounded ? upper_[i] : start_[i] + M_PI;
    q_[i] = low + sequence_(k, i) * (high - low);
  }
}

void Search::bound_turns() {
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    if (turns_[static_cast<std::size_t>(i)] != Turn::Bound) continue;
    lower_[i] = start_[i] - M_PI;
    upper_[i] = start_[i] + M_PI;
  }
}

void Search::wrap_to_start() {
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const Turn turn = turns_[static_cast<std::size_t>(i)];
    if (turn == Turn::Bound) q_[i] = std::clamp(q_[i], start_[i] - M_PI, start_[i] + M_PI);
    if (turn != Turn::Wrap) continue;
    q_[i] = start_[i] + std::remainder(q_[i] - start_[i], 2.0 * M_PI);
  }
}

}  // namespace pdoik::detail
