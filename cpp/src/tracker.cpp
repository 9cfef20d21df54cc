#include "pdoik/tracker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>

#include "detail/check_input.hpp"
#include "detail/describe.hpp"
#include "detail/goal_of.hpp"
#include "detail/search.hpp"

namespace pdoik {

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
  if (!(o.speed_share > 0.0)) refuse("speed_share", o.speed_share, "a positive number");
  for (const auto& [name, value] :
       {std::pair{"posture_weight", o.posture_weight}, std::pair{"smoothness", o.smoothness}}) {
    if (!(value >= 0.0) || !std::isfinite(value))
      refuse(name, value, "a finite number of at least 0");
  }
  if (o.max_speed.size() == 0)
    o.max_speed.setConstant(robot.dof(), std::numeric_limits<double>::infinity());
  detail::check_step(o.max_speed, robot.dof(), "max_speed");
  if (o.max_time == 0.0) o.max_time = 0.8 * o.period;
  return o;
}

/// Clearance beyond this is not measured [m].
constexpr double kLook = 0.5;

/// A bound on how far any point of a hull gets when every joint makes its step [m].
double travel(const Robot& robot, const detail::HullModel& hulls, const Eigen::VectorXd& step) {
  double farthest = 0.0;
  for (const detail::AttachedPoint& point : hulls.points) {
    double arm = detail::to_vector3(point.local).norm(), sum = 0.0;
    for (int b = point.body; b > 0;) {
      const Body& body = robot.bodies()[static_cast<std::size_t>(b)];
      const double moves = std::abs(body.multiplier) * step[body.dof];
      sum += body.prismatic ? moves : moves * arm;
      if (body.prismatic) {
        arm += std::max(std::abs(body.multiplier * robot.lower()[body.dof] + body.offset),
                        std::abs(body.multiplier * robot.upper()[body.dof] + body.offset));
      }
      arm += body.T_parent_joint.translation().norm();
      b = body.parent;
    }
    farthest = std::max(farthest, sum);
  }
  return std::isfinite(farthest) ? farthest : std::numeric_limits<double>::max();
}

}  // namespace

/// The robot and options a search refers to, kept at one address, and the loop's memory.
struct Tracker::Implementation {
  Implementation(const Robot& robot_in, const Options& solver_options_in,
                 const TrackerOptions& options_in)
      : robot(robot_in),
        solver_options(solver_options_in),
        options(checked(options_in, robot)),
        search(robot, solver_options) {
    const Eigen::VectorXd speed =
        (options.speed_share * robot.velocity()).cwiseMin(options.max_speed);
    step = options.period * speed;
    margin = travel(robot, detail::HullModel(robot), step);
    last = robot.mid_configuration();
    posture = last;
    lower.setZero(robot.dof());
    upper.setZero(robot.dof());
    pull_to.setZero(robot.dof());
    weights.setOnes(robot.dof());
    if (solver_options.joint_weights.size() > 0) weights = solver_options.joint_weights;
    pull = options.posture_weight * weights;
    pull.array() += options.smoothness;
    result.q = last;
  }

  /// The last answer once more, with what it is worth now left unsaid.
  void hold(const std::string& why) {
    text = why;
    static_cast<Result&>(result) = Result{};
    result.q = last;
    result.tracking = TrackerStatus::InvalidInput;
    result.step_limited = -1;
    result.complaint = text.c_str();
  }

  void advance(std::span<const Goal> goals) {
    lower = (last - step).cwiseMax(robot.lower());
    upper = (last + step).cwiseMin(robot.upper());
    const bool pulls = has_posture && options.posture_weight > 0.0;
    if (pulls) {
      pull_to = (options.posture_weight * weights.array() * posture.array() +
                 options.smoothness * last.array()) /
                pull.array().max(1e-300);
    }
    search.follow({.goals = goals,
                   .from = &last,
                   .lower = &lower,
                   .upper = &upper,
                   .pull_to = pulls ? &pull_to : nullptr,
                   .pull = pulls ? &pull : nullptr,
                   .max_time = options.max_time,
                   .margin = margin,
                   .advance = 0.5 * margin,
                   .turn = 0.5 * step.sum(),
                   .look = kLook},
                  result);
    result.complaint = "";
    result.tracking = result.status == Status::TimeLimit ? TrackerStatus::DeadlineStruck
                      : result.success                   ? TrackerStatus::Tracking
                                                         : TrackerStatus::Infeasible;
    result.step_limited = -1;
    for (Eigen::Index i = 0; i < last.size() && result.step_limited < 0; ++i) {
      const bool down = result.q[i] <= lower[i] && lower[i] > robot.lower()[i];
      const bool up = result.q[i] >= upper[i] && upper[i] < robot.upper()[i];
      if (down || up) result.step_limited = static_cast<int>(i);
    }
    last = result.q;
  }

  Robot robot;
  Options solver_options;
  TrackerOptions options;
  detail::Search search;
  Eigen::VectorXd step, last, lower, upper, posture, weights, pull_to, pull;
  bool has_posture = false;
  double margin = 0.0;
  std::string cloud_complaint;  ///< of the last cloud, empty if it was taken
  std::string text;
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
  return detail::describe(worst, robot());
}

void Tracker::reset(VectorIn q) {
  detail::check_configuration(q, robot().dof(), "q");
  impl_->last = q.cwiseMax(robot().lower()).cwiseMin(robot().upper());
}

void Tracker::set_posture(VectorIn posture) {
  impl_->has_posture = posture.size() > 0;
  if (!impl_->has_posture) return;
  detail::check_configuration(posture, robot().dof(), "posture");
  impl_->posture = posture;
}

bool Tracker::set_obstacles(const Obstacles& points) {
  try {
    detail::check_obstacles(points);
    if (points.rows() > impl_->solver_options.max_obstacles) {
      throw std::invalid_argument("obstacles has " + std::to_string(points.rows()) +
                                  " rows, expected at most max_obstacles, " +
                                  std::to_string(impl_->solver_options.max_obstacles));
    }
  } catch (const std::invalid_argument& refused) {
    refuse_obstacles(refused.what());
    return false;
  }
  impl_->search.set_obstacles(points);
  impl_->cloud_complaint.clear();
  return true;
}

void Tracker::refuse_obstacles(const std::string& complaint) { impl_->cloud_complaint = complaint; }

const TrackerResult& Tracker::hold(const std::string& complaint) {
  impl_->hold(complaint);
  impl_->latency.add(0.0);
  return impl_->result;
}

const TrackerResult& Tracker::step(std::span<const Goal> goals) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point started = Clock::now();
  try {
    detail::check_goals(goals, robot(), solver_options());
    if (impl_->cloud_complaint.empty())
      impl_->advance(goals);
    else
      impl_->hold(impl_->cloud_complaint);
  } catch (const std::invalid_argument& refused) {
    impl_->hold(refused.what());
  }
  impl_->result.time = std::chrono::duration<double>(Clock::now() - started).count();
  impl_->latency.add(impl_->result.time);
  return impl_->result;
}

const TrackerResult& Tracker::step(const Eigen::Isometry3d& T_base_tip) {
  const Goal only = detail::goal_of(solver_options(), T_base_tip);
  return step({&only, 1});
}

}  // namespace pdoik
