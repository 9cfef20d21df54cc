#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "detail/frame.hpp"
#include "detail/rollout.hpp"
#include "pdoik/robot.hpp"
#include "simd/cull.hpp"

namespace pdoik::detail {

/// A point of the robot that distances are measured from: u_i of the paper, or any further one.
struct AttachedPoint {
  int body;
  Vec4 local;  ///< in the body's frame
};

/// A sphere (a == b, semi_major its radius) or a spheroid with foci at two attached points.
struct Hull {
  int a, b;
  double semi_major;
  int source;  ///< its place in the occupancy: spheres first, then spheroids
  bool is_sphere() const { return a == b; }
};

/// The robot's hulls on their attached points, each point once. Points on a joint's own axis belong to the
/// body before it, since that joint does not move them; hulls that no joint moves are kept apart.
struct HullModel {
  explicit HullModel(const Robot& robot);

  std::vector<AttachedPoint> points;
  std::vector<Hull> moving, fixed;
  /// No obstacle farther than this from `reach_centre` can touch a moving hull; infinite if unknown.
  Eigen::Vector3d reach_centre = Eigen::Vector3d::Zero();
  double reach = std::numeric_limits<double>::infinity();
};

/// Obstacle points by coordinate.
class ObstacleSet {
 public:
  void reserve(std::size_t count);
  void clear() { resize(0); }
  /// Append one point; `finish` then pads.
  void add(const Eigen::Vector3d& point, double radius, int original_index);
  void finish() { resize(count_); }

  int count() const { return count_; }
  int padded() const { return padded_; }
    ObstacleArrays arrays() const { return {x_.data(), y_.data(), z_.data(), radius_.data(), padded_}; }
  Vec4 point(int j) const {
    const auto k = static_cast<std::size_t>(j);
    return Vec4{x_[k], y_[k], z_[k], 0.0};
  }
  double radius(int j) const { return radius_[static_cast<std::size_t>(j)]; }
  int original_index(int j) const { return index_[static_cast<std::size_t>(j)]; }
  bool any_radius() const { return any_radius_; }

 private:
  void resize(int count);
  std::vector<double> x_, y_, z_, radius_;
  std::vector<int> index_;
  int count_ = 0, padded_ = 0;
  bool any_radius_ = false;
};

/// Distances between the robot's points and the obstacles at one configuration.
class CollisionState {
 public:
  explicit CollisionState(const HullModel& hulls)
      : hulls_(hulls), positions_(hulls.points.size()), queries_(hulls.moving.size()), cull_(best_cull()) {}

  /// Room for this many pairs of hull and obstacle: called at set-up so that nothing allocates later.
  void reserve(int padded_obstacles) {
    const std::size_t pairs = hulls_.moving.size() * static_cast<std::size_t>(padded_obstacles);
    if (pairs_.size() < pairs) pairs_.resize(pairs);
  }

  /// Points and hulls at a rollout's configuration. grow[h], if given, is added to each semi-major axis.
  void place(const Rollout& rollout, const double* grow = nullptr) {
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      positions_[k] = transform(rollout.frame(hulls_.points[k].body), hulls_.points[k].local);
    }
    for (std::size_t h = 0; h < queries_.size(); ++h) {
      const Hull& hull = hulls_.moving[h];
      const Vec4& a = position(hull.a);
      const Vec4& b = position(hull.b);
      HullQuery& query = queries_[h];
      for (int i = 0; i < 3; ++i) {
        query.centre[i] = 0.5 * (a[i] + b[i]);
        query.half[i] = 0.5 * (b[i] - a[i]);
      }
      query.semi_major = hull.semi_major + (grow != nullptr ? grow[h] : 0.0);
    }
  }

  /// The pairs that may touch, found without a square root.
  void find_near(const ObstacleSet& obstacles) {
    near_count_ = obstacles.count() == 0
                      ? 0
                      : cull_(obstacles.arrays(), queries_.data(), static_cast<int>(queries_.size()), pairs_.data());
  }

  int near_count() const { return near_count_; }
  const NearPair& near(int k) const { return pairs_[static_cast<std::size_t>(k)]; }
  const Vec4* positions() const { return positions_.data(); }
  const Vec4& position(int point) const { return positions_[static_cast<std::size_t>(point)]; }
  const HullModel& hulls() const { return hulls_; }
  void use_baseline() { cull_ = cull_baseline; }

 private:
  const HullModel& hulls_;
  std::vector<Vec4> positions_;
  std::vector<HullQuery> queries_;
  std::vector<NearPair> pairs_;
  int near_count_ = 0;
  CullFunction cull_;
};

/// The least distance from an obstacle (less its radius) to a hull, and which.
struct Clearance {
  double distance = std::numeric_limits<double>::infinity();
  int source = -1;    ///< the hull's place in the occupancy
  int obstacle = -1;  ///< the obstacle's original row
};

/// Exact Euclidean clearance of the hulls whose attached points are at `positions`, if below `than`.
Clearance least_clearance(const std::vector<Hull>& hulls, const Vec4* positions, const ObstacleSet& obstacles,
                          Clearance than = {});

/// The obstacles of one scene, sorted by what the arm can do about them.
struct Scene {
  using Points = Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                            Eigen::OuterStride<>>;

  void reserve(std::size_t count);
  /// @param points  (N, 3) or (N, 4) rows x y z [radius]; radii grow by `margin`.
  void assign(const Points& points, double margin, const HullModel& hulls);
  /// Clearance of every hull, with the attached points at `positions`. Margin included.
  Clearance clearance(const HullModel& hulls, const Vec4* positions) const;

  ObstacleSet near;   ///< within reach of a moving hull: the solver's
  ObstacleSet far;    ///< out of reach of all of them: only the reported clearance sees these
  double far_bound = std::numeric_limits<double>::infinity();  ///< no far one comes closer than this
  Clearance fixed;    ///< of the hulls that no joint moves

 private:
  std::vector<Vec4> positions_of_fixed_;
};

}  // namespace pdoik::detail
