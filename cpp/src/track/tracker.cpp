#include "pdoik/tracker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/check_input.hpp"
#include "hulls/travel.hpp"
#include "kinematics/goal_of.hpp"
#include "obstacles/check_obstacles.hpp"
#include "obstacles/describe.hpp"
#include "pdoik/cloud.hpp"
#include "problem/check_request.hpp"
#include "track/step.hpp"

namespace pdoik {

using Clock = std::chrono::steady_clock;

const char* to_string(TrackerStatus status) {
  switch (status) {
    case TrackerStatus::Tracking:
      return "tracking";
    case TrackerStatus::Infeasible:
      return "infeasible";
    case TrackerStatus::DeadlineStruck:
      return "deadline_struck";
    case TrackerStatus::InvalidInput:
      return "invalid_input";
  }
  return "unknown";
}

namespace {

TrackerOptions checked(TrackerOptions o, const Robot& robot) {
  const auto refuse = [](const std::string& name, double value, const char* expected) {
    throw std::invalid_argument(name + " is " + std::to_string(value) + ", expected " + expected);
  };
  if (!(o.period > 0.0) || !std::isfinite(o.period))
    refuse("period", o.period, "a positive time [s]");
  if (!(o.max_time >= 0.0)) refuse("max_time", o.max_time, "a time of at least 0 [s]");
  if (!(o.speed_share > 0.0) || !std::isfinite(o.speed_share))
    refuse("speed_share", o.speed_share, "a positive finite number");
  for (const auto& [name, value] :
       {std::pair{"posture_weight", o.posture_weight}, std::pair{"smoothness", o.smoothness}}) {
    if (!(value >= 0.0) || !std::isfinite(value))
      refuse(name, value, "a finite number of at least 0");
  }
  if (o.max_speed.size() == 0)
    o.max_speed.setConstant(robot.dof(), std::numeric_limits<double>::infinity());
  if (o.max_acceleration.size() == 0)
    o.max_acceleration.setConstant(robot.dof(), std::numeric_limits<double>::infinity());
  detail::check_step(o.max_speed, robot.dof(), "max_speed");
  detail::check_step(o.max_acceleration, robot.dof(), "max_acceleration");
  for (Eigen::Index i = 0; i < o.max_acceleration.size(); ++i) {
    if (o.max_acceleration[i] == 0.0)
      refuse("max_acceleration[" + std::to_string(i) + "]", 0.0, "a positive number");
  }
  if (o.max_time == 0.0) o.max_time = 0.8 * o.period;
  return o;
}

/// Clearance beyond this is not measured [m].
constexpr double kLook = 0.5;

/// How fast each joint may go: no farther than half a turn in a step, since a longer way round ends
/// nowhere else.
Eigen::VectorXd speed_of(const Robot& robot, const TrackerOptions& options) {
  Eigen::VectorXd speed = (options.speed_share * robot.velocity()).cwiseMin(options.max_speed);
  for (Eigen::Index i = 0; i < speed.size(); ++i) {
    const bool slides = robot.joint_types()[static_cast<std::size_t>(i)] == JointType::Prismatic;
    if (!slides) speed[i] = std::min(speed[i], M_PI / options.period);
  }
  return speed;
}

/// Whether there is a finite velocity for each of some obstacles.
bool accepts_velocity(const ObstacleVelocity& velocity, Eigen::Index obstacles,
                      detail::InputError& error) {
  if (velocity.rows() != 1 && velocity.rows() != obstacles) {
    error.say("obstacle_velocity has %lld rows, expected 1 or one for each of %lld obstacles",
              static_cast<long long>(velocity.rows()), static_cast<long long>(obstacles));
    return false;
  }
  if (!velocity.allFinite()) {
    error.say("obstacle_velocity has a number that is not finite");
    return false;
  }
  return true;
}

/// A goal is never brought so near that it counts as reached before it is, in its tolerances.
constexpr double kBeyondTolerance = 10.0;

}  // namespace

/// The loop's memory.
struct Tracker::Implementation {
  Implementation(const Robot& robot_in, const Options& solver_options_in,
                 const TrackerOptions& options_in)
      : model(std::make_shared<detail::Model>(robot_in, solver_options_in)),
        robot(model->robot),
        solver_options(model->options),
        options(checked(options_in, robot)),
        scene(robot, model->hulls, solver_options),
        workspace(model, scene),
        way(workspace),
        braking(options.period, robot.lower(), robot.upper(), speed_of(robot, options),
                options.max_acceleration) {
    margin = detail::farthest_travel(robot, model->hulls, braking.farthest());
    tip_travel = detail::farthest_tip_travel(robot, braking.farthest());
    last = robot.mid_configuration();
    braking.begin(last, Eigen::VectorXd());
    posture = last;
    lower.setZero(robot.dof());
    upper.setZero(robot.dof());
    pull_to.setZero(robot.dof());
    weights.setOnes(robot.dof());
    if (solver_options.joint_weights.size() > 0) weights = solver_options.joint_weights;
    set_pull();
    result.q = last;
  }

  /// What pulls at each joint: the last answer, and a posture where one is set.
  void set_pull() {
    posture_pull = (has_posture ? options.posture_weight : 0.0) * weights;
    pull = posture_pull.array() + options.smoothness;
  }

  /// The last answer once more, with what it is worth now left unsaid.
  void hold(const char* why) {
    Eigen::VectorXd q = std::move(result.q);  // its memory stays
    static_cast<Result&>(result) = Result{};
    result.q = std::move(q);
    result.q = last;
    result.tracking = TrackerStatus::InvalidInput;
    result.step_limited = -1;
    result.stopped_hard = braking.moves();
    braking.begin(last, Eigen::VectorXd());
    result.complaint = why;
  }

  /// How much of what is farthest a step may lead to now.
  double share_of_farthest() const {
    const Eigen::VectorXd& farthest = braking.farthest();
    if (!braking.limited() || !farthest.allFinite()) return 1.0;
    double share = 0.0;
    for (Eigen::Index i = 0; i < last.size(); ++i) {
      const double far = std::max(upper[i] - last[i], last[i] - lower[i]);
      if (farthest[i] > 0.0) share = std::max(share, far / farthest[i]);
    }
    return std::min(share, 1.0);
  }

  void advance(std::span<const Goal> goals) {
    pull_to = last;
    if (has_posture) {
      pull_to = (options.posture_weight * weights.array() * posture.array() +
                 options.smoothness * last.array()) /
                pull.array().max(1e-300);
    }
    const auto reading = scene.read(error);
    if (!error.empty()) {
      hold(error.text());
      return;
    }
    if (scene.has_changed()) workspace.use(scene);
    way.follow(goals, last, braking);
    braking.box(last, lower, upper);
    const double share = share_of_farthest();
    way.take({.goals = goals,
              .from = &last,
              .lower = &lower,
              .upper = &upper,
              .pull_to = &pull_to,
              .pull = &pull,
              .posture = has_posture ? &posture : nullptr,
              .weights = has_posture ? &posture_pull : nullptr,
              .max_time = options.max_time,
              .margin = share * margin,
              .advance = std::max(0.5 * share * tip_travel,
                                  kBeyondTolerance * solver_options.position_tolerance),
              .turn = std::max(0.5 * share * braking.farthest().sum(),
                               kBeyondTolerance * solver_options.rotation_tolerance),
              .look = kLook,
              .braking = &braking},
             result);
    result.complaint = "";
    if (!ahead.empty() && result.worst.kind == WorstConstraint::Kind::Clearance &&
        result.worst.obstacle >= points)
      result.worst.obstacle = ahead[static_cast<std::size_t>(result.worst.obstacle - points)];
    result.tracking = result.status == Status::TimeLimit ? TrackerStatus::DeadlineStruck
                      : result.success                   ? TrackerStatus::Tracking
                                                         : TrackerStatus::Infeasible;
    result.stopped_hard = braking.was_hard();
    result.step_limited = -1;
    for (Eigen::Index i = 0; i < last.size() && result.step_limited < 0; ++i) {
      const bool down = way.aim()[i] <= lower[i] && lower[i] > robot.lower()[i];
      const bool up = way.aim()[i] >= upper[i] && upper[i] < robot.upper()[i];
      if (down || up) result.step_limited = static_cast<int>(i);
    }
    last = result.q;
  }

  std::shared_ptr<const detail::Model> model;
  const Robot& robot;
  const Options& solver_options;
  TrackerOptions options;
  detail::Scene scene;
  detail::Workspace workspace;
  detail::Step way;
  detail::Braking braking;
  Eigen::VectorXd last, lower, upper, posture, weights, pull_to, pull, posture_pull;
  bool has_posture = false;
  double margin = 0.0, tip_travel = 0.0;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> with_ahead;
  std::vector<int> ahead;  ///< of points where they will be: which they are
  Eigen::Index points = 0;
  detail::InputError cloud_error;  ///< of the last cloud, empty if it was taken
  detail::InputError error;        ///< of the last goals, or of a robot without hulls
  TrackerResult result;
  LatencyHistogram latency;
};

Tracker::Tracker(const Robot& robot, const Options& solver_options, const TrackerOptions& options) {
  detail::check_set_up(robot, solver_options);
  if (solver_options.method == Method::Paper)
    throw std::invalid_argument("a tracker needs method 'default'");
  impl_ = std::make_unique<Implementation>(robot, solver_options, options);
}
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;
Tracker::~Tracker() = default;

const Robot& Tracker::robot() const { return impl_->robot; }
const Options& Tracker::solver_options() const { return impl_->solver_options; }
const TrackerOptions& Tracker::options() const { return impl_->options; }
const Eigen::VectorXd& Tracker::q() const { return impl_->last; }
const LatencyHistogram& Tracker::latency() const { return impl_->latency; }
void Tracker::clear_latency() { impl_->latency.clear(); }
std::string Tracker::describe(const WorstConstraint& worst) const {
  return detail::describe(worst, robot(), impl_->scene);
}

const Eigen::VectorXd& Tracker::velocity() const { return impl_->braking.velocity(); }

void Tracker::reset(VectorIn q, VectorIn velocity) {
  detail::check_configuration(q, robot().dof(), "q");
  if (velocity.size() > 0) detail::check_configuration(velocity, robot().dof(), "velocity");
  impl_->last = q.cwiseMax(robot().lower()).cwiseMin(robot().upper());
  impl_->braking.begin(impl_->last, velocity);
}

void Tracker::set_posture(VectorIn posture) {
  if (posture.size() > 0) {
    detail::check_configuration(posture, robot().dof(), "posture");
    impl_->posture = posture;
  }
  impl_->has_posture = posture.size() > 0;
  impl_->set_pull();
}

bool Tracker::set_obstacles(const Obstacles& points, const ObstacleVelocity& velocity) {
  if (points.cols() < 3) return set_obstacles(points);
  if (!accepts_velocity(velocity, points.rows(), impl_->cloud_error)) return false;
  std::vector<int> ahead = std::move(impl_->ahead);  // its memory stays
  ahead.clear();
  const auto of = [&](Eigen::Index row) { return velocity.row(velocity.rows() == 1 ? 0 : row); };
  for (Eigen::Index row = 0; row < points.rows(); ++row)
    if (!of(row).isZero(0.0)) ahead.push_back(static_cast<int>(row));
  auto& all = impl_->with_ahead;
  all.resize(points.rows() + static_cast<Eigen::Index>(ahead.size()), points.cols());
  all.topRows(points.rows()) = points;
  for (std::size_t k = 0; k < ahead.size(); ++k) {
    auto row = all.row(points.rows() + static_cast<Eigen::Index>(k));
    row = points.row(ahead[k]);
    row.head<3>() += impl_->options.period * of(ahead[k]);
  }
  const bool taken = set_obstacles(all);
  impl_->points = points.rows();
  impl_->ahead = std::move(ahead);
  return taken;
}

bool Tracker::set_obstacles(const Obstacles& points) {
  const Clock::time_point started = Clock::now();
  impl_->ahead.clear();
  detail::InputError& error = impl_->cloud_error;
  const int most = impl_->solver_options.max_obstacles;
  if (points.rows() > most) {
    error.say("obstacles has %lld rows, expected at most max_obstacles, %d",
              static_cast<long long>(points.rows()), most);
    return false;
  }
  const Obstacles own = impl_->scene.copied(points);
  if (!detail::accepts_obstacles(own, error)) return false;
  impl_->scene.assign(own);
  impl_->scene.intake = std::chrono::duration<double>(Clock::now() - started).count();
  return true;
}

void Tracker::set_obstacles(const Cloud& cloud) {
  impl_->ahead.clear();
  impl_->cloud_error.clear();
  impl_->scene.use(cloud.state_);
}

void Tracker::set_shapes(const Shapes& shapes) { impl_->scene.use(shapes.set_); }

void Tracker::set_shapes(const Shapes& shapes, const ObstacleVelocity& velocity) {
  const std::span<const Shape> given = shapes.shapes();
  detail::InputError error;
  if (!accepts_velocity(velocity, static_cast<Eigen::Index>(given.size()), error))
    throw std::invalid_argument(error.text());
  std::vector<Shape> all(given.begin(), given.end());
  std::vector<std::string> names = shapes.set_->names;
  for (std::size_t k = 0; k < given.size(); ++k) {
    const Eigen::Vector3d way =
        options().period *
        velocity.row(velocity.rows() == 1 ? 0 : static_cast<Eigen::Index>(k)).transpose();
    if (way.isZero(0.0)) continue;
    Shape moved = given[k];
    moved.name += " (ahead)";
    moved.T_base_shape.pretranslate(way);
    all.push_back(std::move(moved));
    names.push_back(names[k]);  // rules know it as the one that moves
  }
  auto set = std::make_shared<detail::ShapeSet>(std::move(all), shapes.set_->contacts);
  set->names = std::move(names);
  set_shapes(Shapes(std::move(set)));
}

void Tracker::attach(std::span<const Attachment> things) { impl_->scene.attach(things); }
void Tracker::attach(const std::string& link, std::span<const Shape> shapes,
                     std::span<const std::string> may_touch) {
  impl_->scene.attach(link, shapes, may_touch);
}
void Tracker::detach(const std::string& name) { impl_->scene.detach(name); }
void Tracker::detach() { impl_->scene.detach(); }
std::vector<Attachment> Tracker::attached() const { return impl_->scene.attached(); }

void Tracker::refuse_obstacles(const std::string& error) {
  impl_->cloud_error.say("%s", error.c_str());
}

const TrackerResult& Tracker::hold(const std::string& error) {
  impl_->error.say("%s", error.c_str());
  impl_->hold(impl_->error.text());
  impl_->latency.add(0.0);
  return impl_->result;
}

const TrackerResult& Tracker::step(std::span<const Goal> goals) {
  const Clock::time_point started = Clock::now();
  if (!detail::accepts_goals(goals, robot(), solver_options(), impl_->error))
    impl_->hold(impl_->error.text());
  else if (impl_->braking.limited() && std::ranges::any_of(goals, &Goal::stands))
    impl_->hold(
        "a goal that stands is not for a tracker with max_acceleration: joints that brake "
        "each for itself would move it");
  else if (std::ranges::any_of(goals, [](const Goal& goal) {
             return goal.soft || goal.priority != Priority::Both;
           }))
    impl_->hold("a goal is soft or has a priority, which is for a Solver");
  else if (!impl_->cloud_error.empty())
    impl_->hold(impl_->cloud_error.text());
  else
    impl_->advance(goals);
  impl_->result.time = std::chrono::duration<double>(Clock::now() - started).count();
  impl_->latency.add(impl_->result.time);
  return impl_->result;
}

const TrackerResult& Tracker::step(const Eigen::Isometry3d& T_base_tip) {
  const Goal only = detail::goal_of(solver_options(), T_base_tip);
  return step({&only, 1});
}

}  // namespace pdoik
