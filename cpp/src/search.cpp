#include "detail/search.hpp"

#include <algorithm>
#include <cmath>

#include "detail/travel.hpp"

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
/// What it may spend on finding out by how much those that do not solve fall short.
constexpr double kMeasureShare = 0.02;
/// Obstacles this far from the hulls are left out while answers are brought clear [m].
constexpr double kRepairMargin = 0.1;
/// Looking at this many obstacles costs about as much as evaluating the goal.
constexpr double kObstaclesPerEvaluation = 60.0;
/// The last verdict comes after the clock has struck: time is kept for it, but no more than this
/// share.
constexpr double kMostReserved = 0.5;
/// Starts where no answer can exist: for the nearest to a target out of reach; for the goal alone
/// where the base is in collision, which ends with the first that reaches it.
constexpr int kStartsOutOfReach = 16, kStartsForGoalAlone = 100;

}  // namespace

void Search::restore(const Result& earlier, Result& result) {
  const int iterations = result.iterations, evaluations = result.evaluations,
            restarts = result.restarts;
  result = earlier;
  result.iterations = iterations;
  result.evaluations = evaluations;
  result.restarts = restarts;
}

Search::Search(const Robot& robot, const Options& options)
    : Search(robot, options, std::make_shared<Scene>()) {
  scene_->reserve(static_cast<std::size_t>(options.max_obstacles));
  const Points none(0, 3);
  set_obstacles(none);
}

Search::Search(const Robot& robot, const Options& options, const Search& other)
    : Search(robot, options, other.scene_) {
  intake_ = other.intake_;
  use_scene();
}

Search::Search(const Robot& robot, const Options& options, std::shared_ptr<Scene> scene)
    : robot_(robot),
      options_(options),
      hulls_(robot, options.heed_fixed_hulls),
      scene_(std::move(scene)),
      collision_(hulls_, hulls_.moving),
      fixed_hulls_(hulls_, hulls_.fixed),
      own_(robot, options),
      rollout_(robot),
      map_(robot, JointLimitMap::Slack::Shared),
      lagrangian_(map_, rollout_, goals_, collision_, own_, *scene_, options_.point_distance,
                  robot.dof()),
      least_squares_(rollout_, goals_, collision_, own_, *scene_, options_, robot.dof()),
      augmented_lagrangian_(map_.size(), lagrangian_options(options), options.lbfgs),
      levenberg_marquardt_(robot.dof(), options.levenberg_marquardt),
      patient_(robot.dof(), patient(options.levenberg_marquardt)),
      settling_(robot.dof(), settling(options.levenberg_marquardt)),
      judge_(robot, options_, hulls_),
      sequence_(robot.dof(), options.seed),
      candidates_(robot.dof()),
      lower_(robot.lower()),
      upper_(robot.upper()),
      long_way_(long_way(robot, hulls_)),
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
  for (Eigen::VectorXd* v : {&start_, &q_, &unsettled_, &best_.q, &saved_.q, &probe_.q, &levers_})
    v->setZero(robot.dof());
  pull_.setConstant(robot.dof(), options.posture_weight);
  if (options.joint_weights.size() > 0) pull_ = options.posture_weight * options.joint_weights;
  omega_.setZero(map_.size());
  hull_levers(robot, hulls_, robot.lower(), robot.upper(), levers_);
  levers_are_constant_ = levers_.allFinite();
  least_squares_.watch(&deadline_);
  lagrangian_.watch(&deadline_);
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

void Search::set_obstacles(const Obstacles& points) {
  if (scene_.use_count() > 1) scene_ = std::make_shared<Scene>();  // a copy of this search has it
  scene_->assign(points, options_.clearance, hulls_, fixed_hulls_);
  use_scene();
}

void Search::use_scene() {
  const int padded =
      std::max(scene_->near.padded(), (options_.max_obstacles + kLanes - 1) / kLanes * kLanes);
  collision_.reserve(padded);
  least_squares_.reserve(padded);
  least_squares_.use(*scene_);
  lagrangian_.use(*scene_);
  if (options_.method == Method::Paper || options_.inner == InnerMethod::Lbfgs)
    lagrangian_.reserve(padded);
}

bool Search::out_of_reach(const Goal& goal) const {
  const Reach& reach = tip_reach_[static_cast<std::size_t>(goal.tip)];
  const double slack =
      options_.position_tolerance + 1e-9 * reach.distance + goal.position_slack.norm();
  return (goal.T_base_tip.translation() - reach.centre(robot_)).norm() > reach.distance + slack;
}

std::optional<Status> Search::why_hopeless(std::span<const Goal> goals) {
  if (base_collides()) return Status::BaseCollision;
  for (std::size_t k = 0; k < goals.size(); ++k) {
    if (out_of_reach(goals[k])) return Status::OutOfReach;
    GoalTerm& goal = goals_[k];
    if (goal.body() > 0) continue;
    goal.place(rollout_.frame(0));  // which no joint moves
    if (goal.position_distance() > options_.position_tolerance ||
        goal.rotation_distance() > options_.rotation_tolerance)
      return Status::OutOfReach;
  }
  return std::nullopt;
}

void Search::begin(double max_time, Result& result) {
  deadline_ = Deadline(max_time - std::min(verdict_time_, kMostReserved * max_time), interrupt_);
  late_ = 0;
  result.iterations = result.evaluations = result.restarts = 0;
  result.success = false;
}

void Search::end(Result& result) const {
  result.time = deadline_.elapsed();
  result.intake = intake_;
  result.late_evaluations = late_;
}

void Search::run(const Request& request, Result& result) {
  begin(options_.max_time, result);
  set_goals(request.goals);
  const std::optional<Status> hopeless = why_hopeless(request.goals);
  if (options_.method == Method::Paper)
    run_paper(request, result);
  else
    run_default(request, hopeless.has_value(), result);
  result.status = result.success       ? Status::Solved
                  : hopeless           ? *hopeless
                  : deadline_.struck() ? Status::TimeLimit
                                       : Status::Exhausted;
  end(result);
}

void Search::judge_answer(std::span<const Goal> goals, const Eigen::VectorXd& q, Result& result,
                          double look) {
  if (deadline_.struck()) ++late_;
  const double began = deadline_.elapsed();
  judge_(goals, q, *scene_, result, look);
  const double took = deadline_.elapsed() - began;
  verdict_time_ = std::max(took, 0.5 * (took + verdict_time_));
}

void Search::run_paper(const Request& request, Result& result) {
  if (request.q0 != nullptr) {
    map_.inverse(*request.q0, omega_, options_.start_inset);
    start_ = *request.q0;
  } else {
    omega_.setZero();  // Algorithm IK, line 1
    map_.positions(omega_, start_);
  }
  minimise_lagrangian(result);
  map_.positions(omega_, q_);  // Eq. recovery
  wrap_to_start();
  judge_answer(request.goals, q_, result);
}

void Search::minimise_lagrangian(Result& result) {
  const double p = options_.position_tolerance, r = options_.rotation_tolerance;
  const auto struck = [&] { return deadline_.passed(); };
  const auto stop = [&](const Eigen::VectorXd&, double) {
    if (lagrangian_.last_max_constraint() <= 0.5 * options_.clearance_tolerance &&
        std::all_of(goals_.begin(), goals_.end(), [&](const GoalTerm& goal) {
          return goal.position_distance() < p && goal.rotation_distance() < r;
        })) {
      return true;
    }
    return struck();
  };
  const AugmentedLagrangianResult inner =
      augmented_lagrangian_.minimize(lagrangian_, omega_, stop, struck);
  result.iterations += inner.iterations;
  result.evaluations += inner.evaluations;
}

double Search::minimise_least_squares(LevenbergMarquardt& minimiser, Result& result) {
  if (deadline_.struck()) return std::numeric_limits<double>::infinity();
  const LevenbergMarquardtResult inner =
      minimiser.minimize(least_squares_, q_, lower_, upper_, [&] { return deadline_.passed(); });
  result.iterations += inner.iterations;
  result.evaluations += inner.evaluations;
  return inner.value;
}

double Search::cost_of_all() const {
  const double count = scene_->near.count();
  // Of a cloud in order most is passed by in blocks.
  return scene_->near.in_order() ? 20.0 + 0.01 * count / kObstaclesPerEvaluation
                                 : count / kObstaclesPerEvaluation;
}

Search::Trial Search::try_goal_alone(bool stay_near, Result& result) {
  Trial trial;
  least_squares_.heed_none();
  const int before = result.evaluations;
  trial.shortfall = minimise_least_squares(stay_near ? patient_ : levenberg_marquardt_, result);
  trial.reached = least_squares_.done();
  wrap_to_start();
  search_cost_ += result.evaluations - before;
  return trial;
}

Search::Trial Search::try_least_squares(bool stay_near, Result& result) {
  Trial trial = try_goal_alone(stay_near, result);
  if (!trial.reached || deadline_.passed()) return trial;
  if (scene_->near.count() == 0) {
    trial.solves = true;
    return trial;
  }
  search_cost_ += cost_of_all();
  trial.solves = !least_squares_.touches();
  if (trial.solves || !redundant_ || !(stay_near || repair_pays()) || deadline_.passed())
    return trial;
  const int before = result.evaluations;
  least_squares_.heed_those_about(kRepairMargin);
  if (!deadline_.passed())
    trial.shortfall = minimise_least_squares(stay_near ? patient_ : levenberg_marquardt_, result);
  wrap_to_start();
  const double each = 1.0 + least_squares_.heeded() / kObstaclesPerEvaluation;
  repair_cost_ += 2.0 * cost_of_all() + each * (result.evaluations - before);
  if (deadline_.passed()) return trial;
  least_squares_.evaluate(q_);  // the last step may have been taken back
  trial.reached = least_squares_.reached();
  trial.solves = trial.reached && !least_squares_.touches();
  return trial;
}

bool Search::repair_pays() const {
  constexpr int kUsualEvaluations = 8, kUsuallyAbout = 200;
  const int about = std::min(scene_->near.count(), kUsuallyAbout);
  const double usual =
      2.0 * cost_of_all() + kUsualEvaluations * (1.0 + about / kObstaclesPerEvaluation);
  return repair_cost_ + usual < kRepairShare * search_cost_;
}

Search::Trial Search::try_lagrangian(Result& result) {
  Trial trial;
  map_.inverse(q_, omega_, options_.start_inset);
  minimise_lagrangian(result);
  map_.positions(omega_, q_);
  wrap_to_start();
  trial.solves = !deadline_.struck();  // perhaps: the judge will say
  return trial;
}

void Search::keep_candidate(const Trial& trial, bool alone) {
  const bool by_lagrangian = options_.inner == InnerMethod::Lbfgs;  // whose shortfall nobody knows
  bool measured = alone || (scene_->near.count() == 0 && !by_lagrangian);
  double shortfall = trial.shortfall;
  const double cost = 1.0 + cost_of_all();
  const bool pays = by_lagrangian || measure_cost_ + cost < kMeasureShare * search_cost_;
  if (!measured && pays && !deadline_.passed()) {
    measure_cost_ += cost;
    least_squares_.heed_all();
    shortfall = least_squares_.evaluate(q_);
    measured = true;
  }
  candidates_.add(q_, shortfall, measured);
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

void Search::run_default(const Request& request, bool hopeless, Result& result) {
  set_start(request);
  search_cost_ = repair_cost_ = measure_cost_ = 0.0;
  candidates_.clear();
  const bool nearest = options_.prefer == Prefer::Nearest, alone = base_collides();
  const Eigen::VectorXd* wanted = request.posture != nullptr ? request.posture : &start_;
  const int enough = alone      ? kStartsForGoalAlone
                     : hopeless ? kStartsOutOfReach
                                : options_.max_restarts;
  const int last_start = std::min(options_.max_restarts, enough);
  double least = 0.0;  // of what was found, by the distance to what is wanted
  bool found = false;
  for (int k = 0; k <= last_start; ++k) {
    if (k > 0 && deadline_.passed()) break;
    if (k == 0) {
      q_ = start_;
    } else {
      restart_configuration(k, nearest ? wanted : nullptr);
      result.restarts = k;
    }
    const bool stay_near = nearest || (k == 0 && request.q0 != nullptr);
    const Trial trial = alone ? try_goal_alone(stay_near, result)
                        : options_.inner == InnerMethod::LevenbergMarquardt
                            ? try_least_squares(stay_near, result)
                            : try_lagrangian(result);
    if (trial.solves) {
      judge_answer(request.goals, q_, result);
      if (result.success) {
        if (request.posture != nullptr || nearest) settle(request.goals, *wanted, result);
        if (!nearest) return;
        const double distance = squared_distance(result.q, *wanted, pull_);
        if (!found || distance < least) {
          found = true;
          least = distance;
          best_ = result;
        }
        continue;
      }
    }
    if (!found) keep_candidate(trial, alone);
    if (alone && trial.reached) break;  // nothing better can be found
  }
  if (found) {
    restore(best_, result);
    return;
  }
  if (!alone) {
    least_squares_.heed_all();
    candidates_.measure([&](const auto& q) { return least_squares_.evaluate(q); },
                        [&] { return deadline_.passed(); });
  }
  judge_answer(request.goals, candidates_.best(), result);  // may solve by a tolerance's breadth
}

void Search::settle(std::span<const Goal> goals, const Eigen::VectorXd& posture, Result& result) {
  saved_ = result;
  const double before = squared_distance(result.q, posture, pull_);
  least_squares_.heed_all();
  least_squares_.pull_towards(&posture, &pull_);
  minimise_least_squares(settling_, result);
  least_squares_.pull_towards(nullptr, nullptr);
  minimise_least_squares(patient_, result);
  wrap_to_start();
  judge_answer(goals, q_, result);
  if (result.success && squared_distance(q_, posture, pull_) < before) return;
  restore(saved_, result);
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
