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

std::vector<bool> joints_that_matter(const Robot& robot, const HullModel& hulls, bool balance) {
  std::vector<bool> matters(static_cast<std::size_t>(robot.dof()), balance);
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

/// Where the cost has no zero, it goes on while there is anything to gain.
LevenbergMarquardtOptions settling(LevenbergMarquardtOptions options) {
  options.first_damping = 1e-3;
  options.stall_ratio = 0.999;
  options.stall_window = 2;
  return options;
}

int goal_dimensions(GoalType goal) {
  return goal == GoalType::Pose ? 6 : goal == GoalType::Axis ? 5 : 3;
}

double squared_distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                        const Eigen::VectorXd& weights) {
  return ((a - b).array().square() * weights.array()).sum();
}

/// What the solve may spend on bringing answers clear of obstacles, of what it spends on finding
/// answers.
constexpr double kRepairShare = 0.1;
/// Obstacles this far from the hulls are left out while that is done [m].
constexpr double kRepairMargin = 0.1;
/// What goals weigh against constraints when both cannot be had.
constexpr double kYieldingGoals = 1e-4;
/// Looking at this many obstacles costs about as much as evaluating the goal.
double cost_of(int obstacles) { return obstacles / 60.0; }

}  // namespace

Search::Search(const Robot& robot, const Options& options)
    : robot_(robot),
      options_(options),
      hulls_(robot, options.heed_fixed_hulls),
      collision_(hulls_, hulls_.moving),
      fixed_hulls_(hulls_, hulls_.fixed),
      own_(robot, options),
      rollout_(robot),
      map_(robot, JointLimitMap::Slack::Shared),
      lagrangian_(map_, rollout_, goals_, collision_, own_, scene_, options_.point_distance,
                  robot.dof()),
      least_squares_(rollout_, goals_, collision_, own_, scene_, options_, robot.dof()),
      augmented_lagrangian_(map_.size(), lagrangian_options(options), options.lbfgs),
      levenberg_marquardt_(robot.dof(), options.levenberg_marquardt),
      patient_(robot.dof(), patient(options.levenberg_marquardt)),
      settling_(robot.dof(), settling(options.levenberg_marquardt)),
      judge_(robot, options_, hulls_),
      sequence_(robot.dof(), options.seed),
      candidates_(robot.dof()),
      lower_(robot.lower()),
      upper_(robot.upper()),
      matters_(joints_that_matter(robot, hulls_, options.balance.wanted())),
      matter_count_(std::count(matters_.begin(), matters_.end(), true)) {
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
  goals_.reserve(robot.tips().size());
  for (const int tip : robot.tips()) {
    tip_reach_.push_back(
        reach_of(robot, robot.body_of_link(tip), robot.T_body_link(tip).translation().norm()));
  }
  start_.setZero(robot.dof());
  q_.setZero(robot.dof());
  best_.setZero(robot.dof());
  unsettled_.setZero(robot.dof());
  pull_.setConstant(robot.dof(), options.posture_weight);
  if (options.joint_weights.size() > 0) pull_ = options.posture_weight * options.joint_weights;
  omega_.setZero(map_.size());
  Points none(0, 3);
  scene_.reserve(static_cast<std::size_t>(options.max_obstacles));
  const int padded = (options.max_obstacles + kLanes - 1) / kLanes * kLanes;
  reserve(padded);
  set_obstacles(none);
}

void Search::set_goals(std::span<const Goal> goals) {
  goals_.clear();
  int fixed = 0;
  for (const Goal& goal : goals) {
    goals_.emplace_back(robot_, goal);
    fixed += goal_dimensions(goal.type);
  }
  redundant_ = matter_count_ > fixed;
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

bool Search::out_of_reach(const Goal& goal) const {
  const Reach& reach = tip_reach_[static_cast<std::size_t>(goal.tip)];
  const double slack =
      options_.position_tolerance + 1e-9 * reach.distance + goal.position_slack.norm();
  return (goal.T_base_tip.translation() - reach.centre(robot_)).norm() > reach.distance + slack;
}

void Search::run(const Request& request, Result& result) {
  const Deadline deadline(options_.max_time, interrupt_);
  set_goals(request.goals);
  result.iterations = result.evaluations = result.restarts = 0;
  result.success = false;
  if (options_.method == Method::Paper) {
    run_paper(request, deadline, result);
  } else {
    run_default(request, deadline, result);
  }
  if (!result.success && base_collides()) {
    result.status = Status::BaseCollision;
  } else if (!result.success && std::any_of(request.goals.begin(), request.goals.end(),
                                            [&](const Goal& g) { return out_of_reach(g); })) {
    result.status = Status::OutOfReach;
  }
  result.time = deadline.elapsed();
}

void Search::run_paper(const Request& request, const Deadline& deadline, Result& result) {
  if (request.q0 != nullptr) {
    map_.inverse(*request.q0, omega_, options_.start_inset);
    start_ = *request.q0;
  } else {
    omega_.setZero();  // Algorithm IK, line 1
    map_.positions(omega_, start_);
  }
  const bool struck = minimise_lagrangian(deadline, result);
  map_.positions(omega_, q_);  // Eq. recovery
  wrap_to_start();
  judge_(request.goals, q_, scene_, result);
  result.status = result.success ? Status::Solved : struck ? Status::TimeLimit : Status::Exhausted;
}

bool Search::minimise_lagrangian(const Deadline& deadline, Result& result) {
  bool struck = false;
  const double p = options_.position_tolerance, r = options_.rotation_tolerance;
  const auto stop = [&](const Eigen::VectorXd&, double) {
    if (lagrangian_.last_max_constraint() <= 0.5 * options_.clearance_tolerance &&
        std::all_of(goals_.begin(), goals_.end(), [&](const GoalTerm& goal) {
          return goal.position_distance() < p && goal.rotation_distance() < r;
        })) {
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

void Search::set_start(const Request& request) {
  lower_ = robot_.lower();
  upper_ = robot_.upper();
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const bool bounded = std::isfinite(lower_[i]) && std::isfinite(upper_[i]);
    start_[i] = request.q0 != nullptr ? std::clamp((*request.q0)[i], lower_[i], upper_[i])
                : bounded             ? 0.5 * (lower_[i] + upper_[i])
                                      : 0.0;
    if (turns_[static_cast<std::size_t>(i)] == Turn::Bound) {
      lower_[i] = start_[i] - M_PI;
      upper_[i] = start_[i] + M_PI;
    }
    if (request.max_step == nullptr) continue;
    lower_[i] = std::max(lower_[i], start_[i] - (*request.max_step)[i]);
    upper_[i] = std::min(upper_[i], start_[i] + (*request.max_step)[i]);
  }
}

void Search::run_default(const Request& request, const Deadline& deadline, Result& result) {
  set_start(request);
  search_cost_ = repair_cost_ = 0.0;
  candidates_.clear();
  result.status = Status::Exhausted;
  const bool nearest = options_.prefer == Prefer::Nearest;
  const Eigen::VectorXd* wanted = request.posture != nullptr ? request.posture : &start_;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= options_.max_restarts; ++k) {
    if (k == 0) {
      q_ = start_;
    } else {
      restart_configuration(k, nearest ? wanted : nullptr);
      result.restarts = k;
    }
    const bool stay_near = nearest || (k == 0 && request.q0 != nullptr);
    const Trial trial = options_.inner == InnerMethod::LevenbergMarquardt
                            ? try_least_squares(stay_near, deadline, result)
                            : try_lagrangian(deadline, result);
    if (trial.solves) {
      judge_(request.goals, q_, scene_, result);
      if (result.success) {
        result.status = Status::Solved;
        if (request.posture != nullptr || nearest) settle(request.goals, *wanted, deadline, result);
        if (!nearest) return;
        const double distance = squared_distance(result.q, *wanted, pull_);
        if (distance < least) {
          least = distance;
          best_ = result.q;
        }
        if (deadline.passed()) break;
        continue;
      }
    }
    if (std::isinf(least)) candidates_.add(q_, trial.shortfall);
    if (trial.struck) {
      result.status = Status::TimeLimit;
      break;
    }
    if (trial.solves && base_collides()) break;  // nothing better can be found
  }
  if (std::isfinite(least)) {
    judge_(request.goals, best_, scene_, result);
    result.status = Status::Solved;
    return;
  }
  least_squares_.heed_all();
  judge_(request.goals, candidates_.best([&](const auto& q) { return least_squares_.evaluate(q); }),
         scene_, result);
  if (result.success) result.status = Status::Solved;  // by a tolerance's breadth
}

void Search::settle(std::span<const Goal> goals, const Eigen::VectorXd& posture,
                    const Deadline& deadline, Result& result) {
  unsettled_ = result.q;
  const double before = squared_distance(result.q, posture, pull_);
  bool struck = false;
  least_squares_.heed_all();
  least_squares_.pull_towards(&posture, &pull_);
  minimise_least_squares(settling_, deadline, result, struck);
  least_squares_.pull_towards(nullptr, nullptr);
  minimise_least_squares(patient_, deadline, result, struck);
  wrap_to_start();
  judge_(goals, q_, scene_, result);
  if (result.success && squared_distance(q_, posture, pull_) < before) return;
  judge_(goals, unsettled_, scene_, result);
}

void Search::follow(const Following& step, Result& result) {
  const Deadline deadline(step.max_time, interrupt_);
  set_goals(step.goals);
  result.iterations = result.evaluations = result.restarts = 0;
  lower_ = *step.lower;
  upper_ = *step.upper;
  q_ = *step.from;
  least_squares_.pull_towards(nullptr, nullptr);
  least_squares_.heed_none();
  least_squares_.evaluate(q_);
  // A goal that is farther than a step can bring it is approached by what a step can.
  for (GoalTerm& goal : goals_) goal.come_within(step.advance, step.turn);
  if (scene_.near.count() > 0) least_squares_.heed_those_about(step.margin, true);
  bool struck = false;
  if (step.pull_to != nullptr) {
    least_squares_.pull_towards(step.pull_to, step.pull);
    minimise_least_squares(settling_, deadline, result, struck);
    least_squares_.pull_towards(nullptr, nullptr);
  }
  if (!struck) minimise_least_squares(patient_, deadline, result, struck);
  if (step.pull_to != nullptr && !struck && !least_squares_.holds()) {
    // The posture may have led astray: once more without it, and back if that is no better.
    unsettled_ = q_;
    q_ = *step.from;
    minimise_least_squares(patient_, deadline, result, struck);
    if (!least_squares_.holds()) {
      q_ = unsettled_;
      least_squares_.evaluate(q_);
    }
  }
  if (!struck && !least_squares_.holds()) {
    // Not everything can be had: a goal that is far must not push the robot through a constraint.
    least_squares_.scale_goals(kYieldingGoals / std::max(1.0, least_squares_.goal_pull()));
    minimise_least_squares(settling_, deadline, result, struck);
    least_squares_.scale_goals(1.0);
  }
  judge_(step.goals, q_, scene_, result, step.look);
  result.status = result.success ? Status::Solved : struck ? Status::TimeLimit : Status::Exhausted;
  if (!result.success) {
    // Half-way to a posture is no place to be if staying solves.
    judge_(step.goals, *step.from, scene_, result, step.look);
    if (!result.success)
      judge_(step.goals, q_, scene_, result, step.look);
    else if (!struck)
      result.status = Status::Solved;
  }
  result.time = deadline.elapsed();
}

void Search::restart_configuration(int k, const Eigen::VectorXd* near) {
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    if (!matters_[static_cast<std::size_t>(i)]) {
      q_[i] = start_[i];
      continue;
    }
    const bool bounded = std::isfinite(lower_[i]) && std::isfinite(upper_[i]);
    const double low = bounded ? lower_[i] : start_[i] - M_PI,
                 high = bounded ? upper_[i] : start_[i] + M_PI;
    q_[i] = low + sequence_(k, i) * (high - low);
    if (near == nullptr) continue;
    // Close to what is wanted as often as far from it: the whole range, half of it, a quarter, ...
    constexpr double kScales[] = {0.5, 0.25, 0.125, 1.0};
    q_[i] = std::clamp((*near)[i] + kScales[k % 4] * (q_[i] - 0.5 * (low + high)), low, high);
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
