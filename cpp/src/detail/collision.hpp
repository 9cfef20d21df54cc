#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
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

/// The robot's hulls on their attached points, each point once. Points on a joint's own axis belong
/// to the body before it, since that joint does not move them; hulls that no joint moves are kept
/// apart.
struct HullModel {
  /// @param heed_fixed  Leave out the hulls that no joint moves if false.
  explicit HullModel(const Robot& robot, bool heed_fixed = true);

  std::vector<AttachedPoint> points;
  std::vector<Hull> moving, fixed;
  /// No obstacle farther than this from `reach_centre` can touch a moving hull; infinite if
  /// unknown.
  Eigen::Vector3d reach_centre = Eigen::Vector3d::Zero();
  double reach = std::numeric_limits<double>::infinity();
  /// The fixed hulls lie within this distance of `reach_centre`.
  double fixed_reach = 0.0;
};

/// Obstacle points by coordinate: in double, and in single precision relative to an origin for the
/// coarse test.
class ObstacleSet {
 public:
  void reserve(std::size_t count);
  /// Begin a set of at most `count` points; `add` fills it and `finish` pads it.
  void begin(int count, const Eigen::Vector3d& origin);
  void add(double x, double y, double z, double radius, int original_index) {
    const auto k = static_cast<std::size_t>(count_++);
    points_[k] = Vec4{x, y, z, radius};
    index_[k] = original_index;
    coarse_x_[k] = static_cast<float>(x - origin_[0]);
    coarse_y_[k] = static_cast<float>(y - origin_[1]);
    coarse_z_[k] = static_cast<float>(z - origin_[2]);
    coarse_radius_[k] = static_cast<float>(radius);
  }
  void finish();

  int count() const { return count_; }
  int padded() const { return padded_; }
  const Vec4& origin() const { return origin_; }
  ObstacleArrays arrays() const {
    return {coarse_x_.data(), coarse_y_.data(), coarse_z_.data(), coarse_radius_.data(), padded_};
  }
  /// x, y, z, radius.
  const Vec4& operator[](int j) const { return points_[static_cast<std::size_t>(j)]; }
  int original_index(int j) const { return index_[static_cast<std::size_t>(j)]; }
  /// The largest number among coarse coordinates and radii, at least 1 [m].
  double extent() const { return extent_; }

 private:
  std::vector<Vec4> points_;
  std::vector<float> coarse_x_, coarse_y_, coarse_z_, coarse_radius_;
  std::vector<int> index_;
  Vec4 origin_{};
  int count_ = 0, padded_ = 0;
  double extent_ = 1.0;
};

/// By how much a hull must grow so that rounding in the coarse test misses nothing [m].
///
/// Single precision errs in (|d|^2 - A^2 + |h|^2) A^2 - (d.h)^2 by at most E, say; growing A by s
/// takes 2 A s (b^2 + 2 A s) from it at the tip, where it takes least. Either term alone gives an s
/// that suffices.
inline double coarse_slack(double A, double half_squared, double extent) {
  constexpr double kEpsilon = 4.0 * 6e-8;
  const double E = kEpsilon * A * A * A * (2.0 * A + extent);
  const double b2 = A * A - half_squared;
  const double thin = std::sqrt(E) / (2.0 * A);
  return 1e-6 * extent + (b2 > 0.0 ? std::min(thin, E / (2.0 * A * b2)) : thin);
}

/// Distances between the robot's points and the obstacles at one configuration.
class CollisionState {
 public:
  /// @param tested  The model's moving hulls, or its fixed ones. Both must outlive the state.
  CollisionState(const HullModel& model, const std::vector<Hull>& tested)
      : model_(model),
        hulls_(tested),
        positions_(model.points.size()),
        queries_(tested.size()),
        cull_(best_cull()) {
    for (std::size_t k = 0; k < positions_.size(); ++k)
      positions_[k] = model.points[k].local;  // right for body 0
  }

  /// Room for this many pairs of hull and obstacle: called at set-up so that nothing allocates
  /// later.
  void reserve(int padded_obstacles) {
    const std::size_t pairs = hulls_.size() * static_cast<std::size_t>(padded_obstacles);
    if (pairs_.size() < pairs) pairs_.resize(pairs);
  }

  /// Put the attached points where a rollout has them.
  void place(const Rollout& rollout) {
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      positions_[k] = transform(rollout.frame(model_.points[k].body), model_.points[k].local);
    }
  }
  /// Or where they are by other means.
  void place(std::size_t point, const Vec4& position) { positions_[point] = position; }

  /// The pairs that may touch when the semi-major axis of hull h is grown by grow(h), without a
  /// square root: none if there are no obstacles.
  template <class Grow>
  void find_near(const ObstacleSet& obstacles, Grow&& grow) {
    near_count_ = 0;
    if (obstacles.count() == 0) return;
    for (std::size_t h = 0; h < queries_.size(); ++h) set_query(h, obstacles, grow(h));
    near_count_ = cull_(obstacles.arrays(), queries_.data(), static_cast<int>(queries_.size()),
                        pairs_.data());
  }

  /// Whether `test` holds for any pair that may touch. Hulls are asked one after the other, the one
  /// that answered yes last time first, and of each hull's pairs first those that `surely` holds
  /// for, a cheaper test. Changes the near pairs.
  template <class Surely, class Test>
  bool any_near(const ObstacleSet& obstacles, Surely&& surely, Test&& test) {
    near_count_ = 0;
    if (obstacles.count() == 0) return false;
    for (std::size_t k = 0; k < queries_.size(); ++k) {
      const std::size_t h = k == 0 ? first_asked_ : k - (k <= first_asked_ ? 1 : 0);
      set_query(h, obstacles, 0.0);
      near_count_ = cull_(obstacles.arrays(), &queries_[h], 1, pairs_.data());
      NearPair* const end = pairs_.data() + near_count_;
      for (NearPair* pair = pairs_.data(); pair != end; ++pair)
        pair->hull = static_cast<std::int32_t>(h);
      if (std::any_of(pairs_.data(), end, surely) || std::any_of(pairs_.data(), end, test)) {
        first_asked_ = h;
        return true;
      }
    }
    near_count_ = 0;
    return false;
  }

  int near_count() const { return near_count_; }
  const NearPair& near(int k) const { return pairs_[static_cast<std::size_t>(k)]; }
  const Vec4* positions() const { return positions_.data(); }
  const Vec4& position(int point) const { return positions_[static_cast<std::size_t>(point)]; }
  const std::vector<Hull>& hulls() const { return hulls_; }
  const Hull& hull(const NearPair& pair) const {
    return hulls_[static_cast<std::size_t>(pair.hull)];
  }
  int body_of_point(int point) const { return model_.points[static_cast<std::size_t>(point)].body; }
  void use_baseline() { cull_ = cull_baseline; }

 private:
  void set_query(std::size_t h, const ObstacleSet& obstacles, double grow) {
    const Hull& hull = hulls_[h];
    const Vec4 centre = broadcast(0.5) * (position(hull.a) + position(hull.b)) - obstacles.origin();
    const Vec4 half = broadcast(0.5) * (position(hull.b) - position(hull.a));
    HullQuery& query = queries_[h];
    for (int i = 0; i < 3; ++i) {
      query.centre[i] = static_cast<float>(centre[i]);
      query.half[i] = static_cast<float>(half[i]);
    }
    const double A = hull.semi_major + grow;
    query.semi_major =
        static_cast<float>(A + coarse_slack(A, dot3(half, half), obstacles.extent()));
  }

  const HullModel& model_;
  const std::vector<Hull>& hulls_;
  std::vector<Vec4> positions_;
  std::vector<HullQuery> queries_;
  std::vector<NearPair> pairs_;
  int near_count_ = 0;
  std::size_t first_asked_ = 0;
  CullFunction cull_;
};

/// The least distance from an obstacle (less its radius) to a hull, and which.
struct Clearance {
  double distance = std::numeric_limits<double>::infinity();
  int source = -1;    ///< the hull's place in the occupancy
  int obstacle = -1;  ///< the obstacle's original row
};

/// Exact Euclidean clearance of the state's hulls where it is placed, if below `than`, by trying
/// every pair.
Clearance least_clearance(const CollisionState& state, const ObstacleSet& obstacles,
                          Clearance than = {});

/// The same among the pairs that are within g of each other, at least. Changes the state's near
/// pairs.
Clearance least_clearance_within(CollisionState& state, const ObstacleSet& obstacles, double g,
                                 Clearance than = {});

/// The same by growing the hulls until obstacles come to lie in them: points nearer than g to a
/// hull lie in it when it is grown by g, so once the least is below g it is found.
Clearance least_clearance_by_growing(CollisionState& state, const ObstacleSet& obstacles,
                                     Clearance than = {});

/// The obstacles of one scene, sorted by what the arm can do about them.
struct Scene {
  using Points =
      Eigen::Ref<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 0,
                 Eigen::OuterStride<>>;

  void reserve(std::size_t count);
  /// @param points  (N, 3) or (N, 4) rows x y z [radius]; radii grow by `margin`.
  /// @param fixed_hulls  A state of the hulls that no joint moves, reserved for these points.
  void assign(const Points& points, double margin, const HullModel& hulls,
              CollisionState& fixed_hulls);
  /// Clearance of every hull, margin included, at the configuration where `moving` is placed.
  /// Leaves the states' near pairs changed; both need room for the obstacles.
  /// @param within_limits  Whether the joints are, so that what is out of reach stays so.
  /// @param look  What is farther is not looked for: the distance is then this, and nobody's [m].
  Clearance clearance(CollisionState& moving, CollisionState& fixed_hulls,
                      bool within_limits = true,
                      double look = std::numeric_limits<double>::infinity()) const;

  ObstacleSet near;  ///< within reach of a moving hull: the solver's
  ObstacleSet far;   ///< out of reach of all of them: only the reported clearance sees these
  double far_bound =
      std::numeric_limits<double>::infinity();  ///< no far one comes closer than this
  double fixed_far_bound =
      std::numeric_limits<double>::infinity();  ///< nor as close to a hull that no joint moves
  Clearance fixed;  ///< the deepest obstacle in a hull that no joint moves, if there is any
};

}  // namespace pdoik::detail
