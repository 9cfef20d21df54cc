#include <cstdint>
#include <stdexcept>
#include <string>

#include "decode.hpp"
#include "judgement.hpp"
#include "pdoik/errors.hpp"
#include "pdoik/tracker.hpp"

/// A control loop from bytes: a step throws nothing, keeps inside speed limits times period and the
/// joint limits, and what it calls tracking is.
namespace pdoik::fuzz {
namespace {

TrackerOptions tracker_options(Bytes& bytes, const Robot& robot) {
  choose_wildness(bytes);
  constexpr double kPeriods[] = {1e-3, 2e-3, 1e-2, 1e-6, 1e-12, 1.0};
  TrackerOptions o;
  o.period = bytes.one_in(8) ? bytes.number(1e-4, 0.01) : bytes.pick(kPeriods);
  // A deadline that a fuzzer can wait for.
  o.max_time = bytes.one_in(8) ? bytes.number(0.0, 1e-3) : o.period > 2e-3 ? 2e-3 : 0.0;
  if (o.max_time > 5e-3) o.max_time = 5e-3;
  if (bytes.one_in(4)) o.speed_share = bytes.number(0.0, 2.0);
  if (bytes.one_in(4)) o.max_speed = vector(bytes, robot.dof(), 0.0, 3.0);
  if (bytes.one_in(4)) o.posture_weight = bytes.number(0.0, 0.1);
  if (bytes.one_in(4)) o.smoothness = bytes.number(0.0, 0.1);
  return o;
}

/// How far each joint may go in one step, as the headers promise it.
Eigen::VectorXd step_limits(const Tracker& tracker) {
  const Robot& robot = tracker.robot();
  const TrackerOptions& o = tracker.options();
  Eigen::VectorXd limits(robot.dof());
  for (Eigen::Index i = 0; i < limits.size(); ++i) {
    // A joint that may not move at all does not, whatever share of that is allowed.
    const double share = robot.velocity()[i] == 0.0 ? 0.0 : o.speed_share * robot.velocity()[i];
    limits[i] = o.period * std::min(share, o.max_speed.size() > 0 ? o.max_speed[i] : kInfinity);
  }
  return limits;
}

void check_step(const Tracker& tracker, const Eigen::VectorXd& before, const Eigen::VectorXd& most,
                std::span<const Goal> goals, const Cloud& obstacles, const TrackerResult& result) {
  check_configuration(tracker.robot(), result.q);
  PDOIK_PROPERTY(tracker.q() == result.q);
  for (Eigen::Index i = 0; i < before.size(); ++i) {
    const double moved = std::abs(result.q[i] - before[i]);
    PDOIK_PROPERTY(moved <= most[i] + 1e-12 * std::max(1.0, std::abs(before[i])),
                   "joint " << i << " moved by " << moved << ", its limit is " << most[i]);
  }
  PDOIK_PROPERTY(result.step_limited >= -1 && result.step_limited < tracker.robot().dof());
  if (result.tracking == TrackerStatus::InvalidInput) {
    PDOIK_PROPERTY(result.q == before && std::string(result.complaint) != "");
    return;
  }
  PDOIK_PROPERTY(std::string(result.complaint) == "", result.complaint);
  if (result.tracking == TrackerStatus::Tracking) PDOIK_PROPERTY(result.success);
  constexpr double kLook = 0.5;  // [m]
  if (result.success)
    check_success(tracker.robot(), tracker.solver_options(), goals, obstacles, result, kLook);
  (void)tracker.describe(result.worst);
}

void control(Bytes& bytes) {
  const Robot made = robot(bytes);
  const Options solver_options = options(bytes, made);
  Tracker tracker(made, solver_options, tracker_options(bytes, made));
  const Eigen::VectorXd most = step_limits(tracker);
  std::vector<Goal> wanted = goals(bytes, made, solver_options);
  Cloud obstacles(0, 3);
  for (int k = bytes.integer(1, 12); k > 0; --k) {
    try {
      if (bytes.one_in(4)) tracker.reset(configuration(bytes, made));
      if (bytes.one_in(6)) tracker.set_posture(configuration(bytes, made));
    } catch (const std::invalid_argument&) {  // a posture or start that makes no sense
    }
    if (bytes.one_in(4)) wanted = goals(bytes, made, solver_options);
    if (bytes.one_in(3)) {
      const Cloud next = cloud(bytes, made);
      if (tracker.set_obstacles(next)) obstacles = next;
    }
    if (bytes.one_in(64)) tracker.refuse_obstacles("refused");
    const Eigen::VectorXd before = tracker.q();
    const auto stepped = [&]() -> const TrackerResult& {
      try {
        return tracker.step(wanted);
      } catch (const std::exception& error) {
        PDOIK_PROPERTY(false, "a step threw: " << error.what());
      }
      std::abort();
    };
    check_step(tracker, before, most, wanted, obstacles, stepped());
  }
  PDOIK_PROPERTY(tracker.latency().quantile(0.5) <= tracker.latency().max());
}

}  // namespace
}  // namespace pdoik::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pdoik::fuzz::Bytes bytes(data, size);
  try {
    pdoik::fuzz::control(bytes);
  } catch (const std::invalid_argument&) {  // at construction
  } catch (const pdoik::LoadError&) {
  }
  return 0;
}
