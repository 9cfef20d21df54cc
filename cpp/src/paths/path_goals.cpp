#include "paths/path_goals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace pdoik::detail {
namespace {

/// What a tool may go and turn by before a motion that follows it has to be looked at [m], [rad].
constexpr double kSwing = 0.1, kTurn = 0.35;

Eigen::Isometry3d between(const Eigen::Isometry3d& one, const Eigen::Isometry3d& other,
                          double share) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = one.translation() + share * (other.translation() - one.translation());
  const Eigen::AngleAxisd turn(one.linear().transpose() * other.linear());
  T.linear() =
      one.linear() * Eigen::AngleAxisd(share * turn.angle(), turn.axis()).toRotationMatrix();
  return T;
}

/// The axis of a target that the tool may turn about, where only that is free.
std::optional<Eigen::Vector3d> free_axis(const Goal& goal) {
  if (!goal.position_slack.isZero(0.0)) return std::nullopt;  // whose axes turn with the target
  if (goal.type == GoalType::Axis) return goal.axis.normalized();
  if (goal.type != GoalType::Pose) return std::nullopt;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d others = goal.rotation_slack;
    others[i] = 0.0;
    if (goal.rotation_slack[i] >= M_PI && others.isZero(0.0)) return Eigen::Vector3d::Unit(i);
  }
  return std::nullopt;
}

/// The least turn that takes the axis where it is to be, by a share.
void turn_axis(const Eigen::Vector3d& axis, const Eigen::Matrix3d& one,
               const Eigen::Matrix3d& other, double share, Eigen::Isometry3d& T) {
  const Eigen::Vector3d from = one * axis, to = other * axis, about = from.cross(to);
  const double angle = std::atan2(about.norm(), from.dot(to));
  const Eigen::Vector3d unit = about.norm() > 0.0 ? about.normalized() : from.unitOrthogonal();
  T.linear() = Eigen::AngleAxisd(share * angle, unit).toRotationMatrix() * one;
}

Eigen::Vector3d between(const Eigen::Vector3d& one, const Eigen::Vector3d& other, double share) {
  Eigen::Vector3d slack;
  for (int i = 0; i < 3; ++i) {
    const bool bounded = std::isfinite(one[i]) && std::isfinite(other[i]);
    slack[i] = bounded ? one[i] + share * (other[i] - one[i]) : std::min(one[i], other[i]);
  }
  return slack;
}

/// How far it is from one station to the next: of the goal whose target goes farthest.
double way_between(const std::vector<Goal>& one, const std::vector<Goal>& other) {
  double longest = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const Eigen::Isometry3d T = one[i].T_base_tip.inverse() * other[i].T_base_tip;
    const bool turns = one[i].type != GoalType::Position && one[i].type != GoalType::LookAt;
    double turn = turns ? Eigen::AngleAxisd(T.linear()).angle() : 0.0;
    if (const auto axis = free_axis(one[i]))
      turn = std::acos(std::clamp(axis->dot(T.linear() * *axis), -1.0, 1.0));
    longest = std::max(longest, T.translation().norm() / kSwing + turn / kTurn);
  }
  return longest;
}

}  // namespace

PathGoals::PathGoals(std::span<const std::vector<Goal>> stations, bool closed)
    : stations_(stations), count_(static_cast<int>(stations.size()) + (closed ? 1 : 0)) {
  for (int k = 0; k + 1 < count_; ++k) ways_.push_back(way_between(station(k), station(k + 1)));
}

std::span<const Goal> PathGoals::at(double place) {
  const int k = std::clamp(static_cast<int>(std::floor(place)), 0, count_ - 1);
  const double share = place - k;
  if (share <= 0.0 || k + 1 >= count_) return station(k);
  const std::vector<Goal>& next = station(k + 1);
  between_ = station(k);
  for (std::size_t i = 0; i < between_.size(); ++i) {
    Goal& goal = between_[i];
    const Eigen::Matrix3d R = goal.T_base_tip.linear();
    goal.T_base_tip = between(goal.T_base_tip, next[i].T_base_tip, share);
    if (const auto axis = free_axis(goal))
      turn_axis(*axis, R, next[i].T_base_tip.linear(), share, goal.T_base_tip);
    goal.position_slack = between(goal.position_slack, next[i].position_slack, share);
    goal.rotation_slack = between(goal.rotation_slack, next[i].rotation_slack, share);
  }
  return between_;
}

double PathGoals::way(int from, int to) const {
  return std::accumulate(ways_.begin() + from, ways_.begin() + to, 0.0);
}

}  // namespace pdoik::detail
