#include "pdoik/cloud.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "common/check_input.hpp"
#include "obstacles/check_obstacles.hpp"
#include "obstacles/clearance.hpp"
#include "obstacles/cloud_state.hpp"
#include "obstacles/own_rows.hpp"
#include "obstacles/rows.hpp"

namespace pdoik {
namespace {

using detail::CellOrder;
using detail::CloudState;
using detail::ObstacleSet;
using detail::OwnRows;
using detail::Vec4;

/// Points that have numbers, as ObstacleSet takes them in.
struct Numbered {
  const std::vector<Vec4>& points;
  const std::vector<int>& ids;

  const Vec4& operator()(int row) const { return points[static_cast<std::size_t>(row)]; }
  int id(int row) const { return ids[static_cast<std::size_t>(row)]; }
  void prefetch(int row) const { __builtin_prefetch(&points[static_cast<std::size_t>(row)]); }
};

/// A copy, checked: what another thread writes into the rows meanwhile is in it or is not.
template <class Rows>
OwnRows taken(const Rows& points) {
  detail::check_count(points.rows(), "points");
  OwnRows own;
  own.take(points);
  detail::InputError error;
  detail::accepts_obstacles(own.rows(), error, "points");
  error.raise();
  return own;
}

void check(const Eigen::AlignedBox3d& region) {
  if (region.min().allFinite() && region.max().allFinite() &&
      (region.min().array() <= region.max().array()).all())
    return;
  for (int axis = 0; axis < 3; ++axis) {
    if (region.min()[axis] <= region.max()[axis] && std::isfinite(region.min()[axis]) &&
        std::isfinite(region.max()[axis]))
      continue;
    throw std::invalid_argument(std::string("region goes from ") +
                                std::to_string(region.min()[axis]) + " to " +
                                std::to_string(region.max()[axis]) + " along " + "xyz"[axis] +
                                ", expected finite numbers in order");
  }
}

template <class Rows>
std::shared_ptr<CloudState> taken_in(const Rows& points) {
  const OwnRows own = taken(points);
  const Obstacles rows = own.rows();
  auto state = std::make_shared<CloudState>();
  CellOrder order;
  state->change_unshared().assign(static_cast<int>(rows.rows()), order,
                                  detail::RowsOf<Obstacles>{rows, rows.cols() > 3});
  return state;
}

/// All points once more, with those that come after them.
void rebuild(ObstacleSet& set, const std::vector<Vec4>& more) {
  std::vector<Vec4> points;
  std::vector<int> ids;
  const auto count = static_cast<std::size_t>(set.count()) + more.size();
  points.reserve(count);
  ids.reserve(count);
  for (int place = 0; place < set.places(); ++place) {
    if (!set.holds(place)) continue;
    points.push_back(set[place]);
    ids.push_back(set.id(place));
  }
  int next = set.next_id();
  for (const Vec4& point : more) {
    points.push_back(point);
    ids.push_back(next++);
  }
  CellOrder order;
  ObstacleSet anew;
  anew.assign(static_cast<int>(points.size()), order, Numbered{points, ids});
  anew.set_next_id(next);
  set = std::move(anew);
}

template <class Rows>
int replace(CloudState& state, const Rows& points, const Eigen::AlignedBox3d& region) {
  const OwnRows own = taken(points);
  check(region);
  const Obstacles all = own.rows();
  const detail::RowsOf<Obstacles> rows{all, all.cols() > 3};
  // What was rounded on its way here still counts as inside.
  const double slack = 1e-6 * std::max(1.0, region.max().cwiseAbs().maxCoeff());
  std::vector<Vec4> more;
  more.reserve(static_cast<std::size_t>(all.rows()));
  for (int row = 0; row < static_cast<int>(all.rows()); ++row) {
    more.push_back(rows(row));
    if (region.exteriorDistance(detail::to_vector3(more.back())) > slack) {
      throw std::invalid_argument("points has row " + std::to_string(row) +
                                  " outside of the region that it is to fill");
    }
  }
  return state.update([region, more = std::move(more)](ObstacleSet& set) {
    const int removed = set.remove(region);
    const auto total = static_cast<std::size_t>(set.count()) + more.size();
    if (total > Cloud::kMostPoints)
      throw std::invalid_argument("the cloud would have more than " +
                                  std::to_string(Cloud::kMostPoints) + " points");
    CellOrder order;
    if (set.insert(more, order))
      return CloudState::Changed{removed, static_cast<std::size_t>(removed) + more.size()};
    rebuild(set, more);
    return CloudState::Changed{removed, total};
  });
}

}  // namespace

Cloud::Cloud() : Cloud(Obstacles(Eigen::Matrix<double, 0, 3, Eigen::RowMajor>())) {}
Cloud::Cloud(const Obstacles& points) : state_(taken_in(points)) {}
Cloud::Cloud(const ObstaclesF& points) : state_(taken_in(points)) {}

std::size_t Cloud::size() const {
  return static_cast<std::size_t>(state_->read().points().count());
}

int Cloud::update(const Obstacles& points, const Eigen::AlignedBox3d& region) {
  return replace(*state_, points, region);
}
int Cloud::update(const ObstaclesF& points, const Eigen::AlignedBox3d& region) {
  return replace(*state_, points, region);
}

int Cloud::remove(const Eigen::AlignedBox3d& region) {
  check(region);
  return state_->update([region](ObstacleSet& set) {
    const int removed = set.remove(region);
    return CloudState::Changed{removed, static_cast<std::size_t>(removed)};
  });
}

int Cloud::remove_robot(const Robot& robot, VectorIn q, double padding) {
  detail::check_configuration(q, robot.dof(), "q");
  if (!(padding >= 0.0) || !std::isfinite(padding)) {
    throw std::invalid_argument("padding is " + std::to_string(padding) +
                                ", expected a finite length of at least 0 [m]");
  }
  if (robot.occupancy().empty())
    throw std::invalid_argument("the robot has no occupancy, so nobody knows what it fills");
  const detail::HullModel hulls(robot);
  std::vector<Eigen::Isometry3d> T_base_body(robot.bodies().size());
  robot.body_poses(q, T_base_body);
  return state_->update([&](ObstacleSet& set) {
    std::vector<int> within;
    for (const auto* group : {&hulls.moving, &hulls.fixed}) {
      detail::CollisionState state(hulls, *group);
      state.reserve(static_cast<int>(detail::CollisionState::kChunk),
                    detail::CollisionState::kChunk);
      state.place(T_base_body);
      detail::find_within(state, set, padding, within);
    }
    const int removed = set.remove(std::move(within));
    // Never again: what it looks at is gone then.
    return CloudState::Changed{removed, static_cast<std::size_t>(set.count()) + 1};
  });
}

Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> Cloud::points() const {
  const auto reading = state_->read();
  const ObstacleSet& set = reading.points();
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> rows(set.count(), 4);
  Eigen::Index next = 0;
  for (int place = 0; place < set.places(); ++place) {
    if (!set.holds(place)) continue;
    const Vec4& o = set[place];
    rows.row(next++) << o[0], o[1], o[2], o[3];
  }
  return rows;
}

Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> Cloud::sample(int most) const {
  const auto reading = state_->read();
  const ObstacleSet& set = reading.points();
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> rows(most, 4);
  Eigen::Index next = 0;
  const int step = std::max(1, (set.places() + most - 1) / most);
  for (int place = 0; place < set.places(); place += step) {
    if (!set.holds(place)) continue;
    const Vec4& o = set[place];
    rows.row(next++) << o[0], o[1], o[2], o[3];
  }
  return rows.topRows(next);
}

std::vector<int> Cloud::ids() const {
  const auto reading = state_->read();
  const ObstacleSet& set = reading.points();
  std::vector<int> ids;
  for (int place = 0; place < set.places(); ++place)
    if (set.holds(place)) ids.push_back(set.id(place));
  return ids;
}

std::size_t Cloud::bytes() const { return state_->bytes(); }

}  // namespace pdoik
