#include "pdoik/timing.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "paths/curve_timer.hpp"

namespace pdoik {
namespace {

using Rows = TimedMotion::Rows;

constexpr double kOneRow = 1e-9;          ///< rows no farther apart are one [rad] or [m]
constexpr double kLeastDeviation = 1e-9;  ///< of what is straight but for this

void check_size(Eigen::Index size, Eigen::Index wanted, const char* name) {
  if (size != wanted)
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(size) +
                                " entries, expected " + std::to_string(wanted));
}

void check_positive(double value, const std::string& name) {
  if (!(value > 0.0))
    throw std::invalid_argument(name + " is " + std::to_string(value) +
                                ", expected a positive number");
}

void check_rows(const Rows& q, const Eigen::VectorXd& at, int dof) {
  if (q.cols() != dof || q.rows() < 2)
    throw std::invalid_argument("q has shape (" + std::to_string(q.rows()) + ", " +
                                std::to_string(q.cols()) + "), expected (m, " +
                                std::to_string(dof) + ") with 2 rows or more");
  if (!q.allFinite()) throw std::invalid_argument("q holds NaN or infinity");
  if (at.size() == 0) return;
  check_size(at.size(), q.rows(), "at");
  for (Eigen::Index k = 0; k < at.size(); ++k) {
    if (!std::isfinite(at[k]) || (k > 0 && at[k] < at[k - 1]))
      throw std::invalid_argument("at does not rise, or holds NaN or infinity");
  }
}

/// The limits of joints that move, and of others 1, which they do not use.
TimingLimits of_moving(const Robot& robot, const Rows& q, const TimingLimits& given) {
  const auto n = static_cast<Eigen::Index>(robot.dof());
  check_size(given.max_acceleration.size(), n, "max_acceleration");
  if (given.max_speed.size() > 0) check_size(given.max_speed.size(), n, "max_speed");
  check_positive(given.tool_speed, "tool_speed");
  check_positive(given.tool_turn, "tool_turn");
  TimingLimits limits = given;
  limits.max_speed = robot.velocity();
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::string& joint = robot.joint_names()[static_cast<std::size_t>(i)];
    double &speed = limits.max_speed[i], &acceleration = limits.max_acceleration[i];
    if (given.max_speed.size() > 0) {
      check_positive(given.max_speed[i], "max_speed of " + joint);
      speed = std::min(speed, given.max_speed[i]);
    }
    check_positive(acceleration, "max_acceleration of " + joint);
    if (q.col(i).minCoeff() == q.col(i).maxCoeff()) {
      speed = acceleration = 1.0;
      continue;
    }
    if (!(speed > 0.0))
      throw std::invalid_argument("joint " + joint + " moves along the path and may not move");
    if (!std::isfinite(speed))
      throw std::invalid_argument("joint " + joint +
                                  " moves along the path and has no speed limit: give max_speed");
    if (!std::isfinite(acceleration))
      throw std::invalid_argument("max_acceleration of " + joint + " is infinite");
  }
  return limits;
}

/// The rows that differ from the last one kept, and where each is on the path.
void take_different(const Rows& q, const Eigen::VectorXd& at, Rows& rows, Eigen::VectorXd& places) {
  std::vector<Eigen::Index> kept{0};
  for (Eigen::Index k = 1; k < q.rows(); ++k) {
    if ((q.row(k) - q.row(k - 1)).cwiseAbs().maxCoeff() > kOneRow) kept.push_back(k);
  }
  if (kept.size() < 2) throw std::invalid_argument("q has no two different rows");
  rows = q(kept, Eigen::all);
  places.resize(rows.rows());
  for (std::size_t k = 0; k < kept.size(); ++k)
    places[static_cast<Eigen::Index>(k)] =
        at.size() > 0 ? at[kept[k]] : static_cast<double>(kept[k]);
}

}  // namespace

TimedMotion time_path(const Robot& robot, const Rows& q, const TimingLimits& given,
                      const TimingOptions& options, const Eigen::VectorXd& at) {
  check_rows(q, at, robot.dof());
  if (!(options.deviation >= 0.0) || !std::isfinite(options.deviation))
    throw std::invalid_argument("deviation is " + std::to_string(options.deviation) +
                                ", expected 0 or more");
  if (!(options.rate >= 0.0) || !std::isfinite(options.rate))
    throw std::invalid_argument("rate is " + std::to_string(options.rate) +
                                ", expected 0 or more [Hz]");
  const TimingLimits limits = of_moving(robot, q, given);
  Rows rows;
  Eigen::VectorXd places;
  take_different(q, at, rows, places);
  Eigen::VectorXd s = Eigen::VectorXd::Zero(rows.rows());
  for (Eigen::Index k = 1; k < rows.rows(); ++k)
    s[k] = s[k - 1] +
           (rows.row(k) - rows.row(k - 1)).transpose().cwiseQuotient(limits.max_speed).norm();
  const detail::RoundedCurve curve(rows, s, std::max(options.deviation, kLeastDeviation));
  detail::CurveTimer timer(robot, curve, limits);

  TimedMotion motion;
  const double end = timer.time()[timer.time().size() - 1];
  motion.time = timer.time();
  if (options.rate > 0.0) {
    const auto last = static_cast<Eigen::Index>(std::ceil(end * options.rate - 1e-9));
    motion.time =
        Eigen::VectorXd::LinSpaced(last + 1, 0.0, static_cast<double>(last)) / options.rate;
  }
  const Eigen::Index count = motion.time.size();
  for (Rows* each : {&motion.q, &motion.dq, &motion.ddq}) each->resize(count, rows.cols());
  motion.at.resize(count);
  motion.deviation = curve.deviation();
  Eigen::VectorXd value, rate, change, place;
  for (Eigen::Index k = 0; k < count; ++k) {
    double where = 0.0;
    timer.state(std::min(motion.time[k], end), where, value, rate, change);
    motion.q.row(k) = value.transpose();
    motion.dq.row(k) = rate.transpose();
    motion.ddq.row(k) = change.transpose();
    detail::along(places, s, where, place);
    motion.at[k] = place[0];
  }
  motion.q.row(count - 1) = rows.row(rows.rows() - 1);
  motion.dq.row(count - 1).setZero();
  motion.ddq.row(count - 1).setZero();
  return motion;
}

}  // namespace pdoik
