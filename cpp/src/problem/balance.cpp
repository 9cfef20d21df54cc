#include "problem/balance.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace pdoik::detail {
namespace {

double cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// The convex hull of `flat` by Andrew's monotone chain, counter-clockwise; its number of corners.
int convex_hull(const std::vector<Eigen::Vector2d>& flat, std::vector<int>& order,
                std::vector<int>& corners) {
  const auto at = [&](int i) -> const Eigen::Vector2d& {
    return flat[static_cast<std::size_t>(i)];
  };
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    return at(i).x() < at(j).x() || (at(i).x() == at(j).x() && at(i).y() < at(j).y());
  });
  int count = 0;
  const auto add = [&](int i, int keep) {
    while (count > keep) {
      const Eigen::Vector2d& last = at(corners[static_cast<std::size_t>(count - 1)]);
      const Eigen::Vector2d& before = at(corners[static_cast<std::size_t>(count - 2)]);
      if (cross2(last - before, at(i) - last) > 0.0) break;
      --count;
    }
    corners[static_cast<std::size_t>(count++)] = i;
  };
  for (const int i : order) add(i, 1);
  const int lower = count;
  for (auto i = order.rbegin() + 1; i != order.rend(); ++i) add(*i, lower);
  return count - 1;  // the first corner has come round again
}

}  // namespace

Balance::Balance(const Robot& robot, const BalanceOptions& options)
    : options_(options),
      wanted_(options.wanted()),
      lower_(options.com_lower),
      upper_(options.com_upper) {
  const std::size_t bodies = robot.bodies().size();
  mass_.assign(bodies, 0.0);
  subtree_mass_.assign(bodies, 0.0);
  local_com_.assign(bodies, Vec4{});
  moment_.assign(bodies, Vec4{});
  subtree_moment_.assign(bodies, Vec4{});
  for (const Body& body : robot.bodies()) parent_.push_back(body.parent);

  double total = 0.0;
  for (const LinkDescription& link : robot.links()) total += link.mass;
  const bool has_mass = total > 0.0 && std::isfinite(total);
  if (!has_mass && !wanted_) return;  // and nobody may ask
  if (!has_mass)
    throw std::invalid_argument("balance is asked for, but the robot's links have no mass");
  for (std::size_t i = 0; i < robot.links().size(); ++i) {
    const LinkDescription& link = robot.links()[i];
    const auto body = static_cast<std::size_t>(robot.body_of_link(static_cast<int>(i)));
    const Eigen::Vector3d at = robot.T_body_link(static_cast<int>(i)) * link.center_of_mass;
    const double share = link.mass / total;
    mass_[body] += share;
    local_com_[body] += broadcast(share) * to_vec4(at);
  }
  for (std::size_t b = 0; b < bodies; ++b) {
    if (mass_[b] > 0.0) local_com_[b] *= broadcast(1.0 / mass_[b]);
    subtree_mass_[b] = mass_[b];
  }
  for (std::size_t b = bodies - 1; b > 0; --b)
    subtree_mass_[static_cast<std::size_t>(parent_[b])] += subtree_mass_[b];

  if (!wanted_) return;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = options.com_lower[axis], high = options.com_upper[axis];
    if (low <= high) continue;
    throw std::invalid_argument("balance.com_lower[" + std::to_string(axis) + "] is " +
                                std::to_string(low) + ", expected at most com_upper's " +
                                std::to_string(high));
  }
  const double length = options.up.norm();
  if (!(length > 1e-9) || !std::isfinite(length))
    throw std::invalid_argument("balance.up has length " + std::to_string(length) +
                                ", expected a direction");
  if (!std::isfinite(options.support_margin))
    throw std::invalid_argument("balance.support_margin is not finite");
  const Eigen::Vector3d up = options.up / length;
  up_ = to_vec4(up);
  side_ = up.unitOrthogonal();
  ahead_ = up.cross(side_);
  for (const Contact& contact : options.contacts) {
    const int link = robot.link_index(contact.link);
    for (const Eigen::Vector3d& point : contact.points) {
      if (!point.allFinite())
        throw std::invalid_argument("balance.contacts of '" + contact.link +
                                    "' hold NaN or infinity");
      body_of_point_.push_back(robot.body_of_link(link));
      points_.push_back(to_vec4(robot.T_body_link(link) * point));
    }
  }
  if (!options.contacts.empty() && points_.size() < 3) {
    throw std::invalid_argument("balance.contacts hold " + std::to_string(points_.size()) +
                                " points, expected at least 3");
  }
  position_.resize(points_.size());
  flat_.resize(points_.size());
  order_.resize(points_.size());
  std::iota(order_.begin(), order_.end(), 0);
  corners_.resize(2 * points_.size() + 1);
}

void Balance::ask(std::span<const Goal> goals) {
  lower_ = options_.com_lower;
  upper_ = options_.com_upper;
  is_asked_ = false;
  for (const Goal& goal : goals) {
    if (goal.type != GoalType::CenterOfMass) continue;
    is_asked_ = true;
    const Eigen::Vector3d middle = goal.T_base_tip.translation();
    lower_ = lower_.cwiseMax(middle - goal.position_slack);
    upper_ = upper_.cwiseMin(middle + goal.position_slack);
  }
}

void Balance::find_polygon() {
  if (points_.empty()) return;
  for (std::size_t k = 0; k < points_.size(); ++k) {
    const Eigen::Vector3d p = to_vector3(position_[k]);
    flat_[k] = {side_.dot(p), ahead_.dot(p)};
  }
  corner_count_ = convex_hull(flat_, order_, corners_);
}

Balance::Term Balance::segment_constraint() const {
  const int a = corners_[0], b = corners_[1];
  const Eigen::Vector2d& at = flat_[static_cast<std::size_t>(a)];
  const Eigen::Vector2d edge = flat_[static_cast<std::size_t>(b)] - at;
  const Eigen::Vector3d com = to_vector3(com_);
  const Eigen::Vector2d from = Eigen::Vector2d(side_.dot(com), ahead_.dot(com)) - at;
  const double length2 = edge.squaredNorm();
  const double along = length2 > 1e-24 ? std::clamp(edge.dot(from) / length2, 0.0, 1.0) : 0.0;
  const Eigen::Vector2d gap = from - along * edge;
  const Eigen::Vector2d outward = gap.stableNormalized();
  const Vec4 normal = to_vec4(outward.x() * side_ + outward.y() * ahead_);
  return {kBox + a,
          gap.norm() + options_.support_margin,
          normal,
          a,
          b,
          broadcast(along - 1.0) * normal,
          broadcast(-along) * normal};
}

Balance::Term Balance::edge_constraint(int k) const {
  const auto corner = [&](int i) { return corners_[static_cast<std::size_t>(i % corner_count_)]; };
  const int a = corner(k), b = corner(k + 1);
  const Eigen::Vector2d& at = flat_[static_cast<std::size_t>(a)];
  const Eigen::Vector2d edge = flat_[static_cast<std::size_t>(b)] - at;
  const Eigen::Vector3d com = to_vector3(com_);
  const Eigen::Vector2d from = Eigen::Vector2d(side_.dot(com), ahead_.dot(com)) - at;
  const double length = edge.norm();
  const Eigen::Vector2d outward = Eigen::Vector2d(edge.y(), -edge.x()) / length;
  const double along = edge.dot(from) / (length * length);
  const Vec4 normal = to_vec4(outward.x() * side_ + outward.y() * ahead_);
  Term term;
  term.slot = kBox + a;
  term.c = outward.dot(from) + options_.support_margin;
  term.dc_dcom = normal;
  term.a = a;
  term.b = b;
  // The distance to a line changes with its points as the weights by which it passes them.
  term.dc_da = broadcast(along - 1.0) * normal;
  term.dc_db = broadcast(-along) * normal;
  return term;
}

void Balance::add_row(const Term& term, const Rollout& rollout, double* row) {
  subtree_moment_ = moment_;
  for (std::size_t b = subtree_moment_.size() - 1; b > 0; --b) {
    // All that a body carries moves with it as if its mass were at its centre.
    rollout.add_joint_row(static_cast<int>(b), broadcast(subtree_mass_[b]) * term.dc_dcom,
                          cross3(subtree_moment_[b], term.dc_dcom), row);
    subtree_moment_[static_cast<std::size_t>(parent_[b])] += subtree_moment_[b];
  }
  const auto add = [&](int point, const Vec4& direction) {
    const auto k = static_cast<std::size_t>(point);
    rollout.add_row(body_of_point_[k], direction, cross3(position_[k], direction), row);
  };
  if (term.a >= 0) add(term.a, term.dc_da);
  if (term.b >= 0) add(term.b, term.dc_db);
}

void Balance::add_wrenches(const Term& term, double slope, Rollout& rollout) const {
  const Vec4 pull = broadcast(slope) * term.dc_dcom;
  for (std::size_t b = 1; b < mass_.size(); ++b) {
    if (mass_[b] > 0.0)
      rollout.add_wrench(static_cast<int>(b), broadcast(mass_[b]) * pull, cross3(moment_[b], pull));
  }
  const auto push = [&](int point, const Vec4& direction) {
    const auto k = static_cast<std::size_t>(point);
    rollout.add_force(body_of_point_[k], position_[k], broadcast(slope) * direction);
  };
  if (term.a >= 0) push(term.a, term.dc_da);
  if (term.b >= 0) push(term.b, term.dc_db);
}

}  // namespace pdoik::detail
