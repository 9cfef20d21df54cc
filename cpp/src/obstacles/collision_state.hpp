#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "hulls/allowed_contact.hpp"
#include "hulls/capsule_queries.hpp"
#include "hulls/coarse_hull.hpp"
#include "hulls/hull_model.hpp"
#include "hulls/spheroid_distance.hpp"
#include "kinematics/rollout.hpp"
#include "obstacles/obstacle_set.hpp"
#include "simd/cull.hpp"

namespace pdoik::detail {

/// Distances between the robot's points and the obstacles at one configuration.
class CollisionState {
 public:
  /// At most this many near pairs are kept at a time.
  static constexpr std::size_t kMostPairs = 1U << 16U;
  /// Room that is enough where pairs are only visited.
  static constexpr std::size_t kChunk = 1U << 12U;

  /// @param tested  The model's moving hulls, or its fixed ones. Both must outlive the state.
  CollisionState(const HullModel& model, const std::vector<Hull>& tested)
      : model_(model),
        hulls_(tested),
        positions_(model.points.size()),
        queries_(tested.size()),
        capsule_queries_(tested),
        supports_(tested.size(), 0.0),
        pairs_(static_cast<std::size_t>(kLanes)) {
    for (std::size_t k = 0; k < positions_.size(); ++k)
      positions_[k] = model.points[k].local;  // right for body 0
    int bodies = 1;
    for (const Hull& hull : tested) bodies = std::max(bodies, hull.body + 1);
    own_frames_.assign(static_cast<std::size_t>(bodies), to_frame(Eigen::Isometry3d::Identity()));
    frames_ = own_frames_.data();
  }
  CollisionState(const CollisionState&) = delete;

  /// Room for the pairs of hulls and this many obstacles, or for `most` if that is less: called at
  /// set-up so that nothing allocates later.
  void reserve(int padded_obstacles, std::size_t most = kMostPairs) {
    const std::size_t pairs = hulls_.size() * static_cast<std::size_t>(padded_obstacles);
    if (pairs_.size() < std::min(pairs, most)) pairs_.resize(std::min(pairs, most));
  }

  /// Put the attached points where a rollout has them.
  void place(const Rollout& rollout) {
    capsule_queries_.forget();
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      positions_[k] = transform(rollout.frame(model_.points[k].body), model_.points[k].local);
    }
    frames_ = &rollout.frame(0);
  }
  /// Or where the bodies are.
  void place(const std::vector<Eigen::Isometry3d>& T_base_body) {
    capsule_queries_.forget();
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      const AttachedPoint& point = model_.points[k];
      positions_[k] =
          to_vec4(T_base_body[static_cast<std::size_t>(point.body)] * to_vector3(point.local));
    }
    if (model_.blocks.empty()) return;
    for (std::size_t b = 0; b < own_frames_.size(); ++b) own_frames_[b] = to_frame(T_base_body[b]);
    frames_ = own_frames_.data();
  }
  /// Or where they are by other means.
  void place(std::size_t point, const Vec4& position) {
    capsule_queries_.forget();
    positions_[point] = position;
  }
  void place_frame(int body, const Frame& frame) {
    capsule_queries_.forget();
    const auto b = static_cast<std::size_t>(body);
    if (b < own_frames_.size()) own_frames_[b] = frame;
  }

  /// Leave out pairs that may touch and are not too deep in each other. Outlives it; null for none.
  void allow(const AllowedContact* contact) { allowed_contact_ = contact; }

  /// The pairs that may touch when the semi-major axis of hull h is grown by grow(h), without a
  /// square root: none if there are no obstacles. More than there is room for are left out: so many
  /// leave no doubt that the robot touches something.
  /// Of hulls with capsules, and where by_distance(hull) says so, those that may be within that
  /// distance.
  template <class Grow>
  void find_near(const ObstacleView& obstacles, Grow&& grow) {
    find_near(obstacles, grow, [](const Hull& hull) { return hull.has_capsules(); });
  }
  template <class Grow, class ByDistance>
  void find_near(const ObstacleView& obstacles, Grow&& grow, ByDistance&& by_distance) {
    near_count_ = 0;
    if (obstacles->count() == 0) return;
    for (std::size_t h = 0; h < queries_.size(); ++h)
      set_query(h, obstacles, grow(h), by_distance(hulls_[h]));
    CullCursor at;
    near_count_ = kernels_.cull(obstacles->arrays(), queries_.data(),
                                static_cast<int>(queries_.size()), pairs_.data(), capacity(), at);
    near_count_ = without_allowed(obstacles, near_count_);
  }

  /// The pairs that may be within a distance grow(h) of each other, ordered by hull, some at a
  /// time: visit(const NearPair* begin, const NearPair* end) returns false to stop. grow(h) is
  /// asked before each search for more, and may be negative: then pairs that reach deeper than that
  /// count. Changes the near pairs. @returns Whether nobody stopped it.
  template <class Grow, class Visit>
  bool visit_near(const ObstacleView& obstacles, Grow&& grow, Visit&& visit) {
    return visit_hulls(0, queries_.size(), obstacles, grow, visit);
  }
  /// Of hull h alone.
  template <class Grow, class Visit>
  bool visit_near_of(std::size_t h, const ObstacleView& obstacles, Grow&& grow, Visit&& visit) {
    return visit_hulls(h, h + 1, obstacles, grow, visit);
  }
  /// A hint that what is visited next of a hull lies where a plane at this distance from its centre
  /// touches it [m]; 0 for nobody knows where.
  void expect_at(std::size_t h, double support) { supports_[h] = support; }
  void expect_anywhere() { std::fill(supports_.begin(), supports_.end(), 0.0); }

  /// Whether `test` holds for any pair that may touch. Hulls are asked one after the other, the one
  /// that answered yes last time first, and of each hull's pairs first those that `surely` holds
  /// for, a cheaper test. Changes the near pairs.
  template <class Surely, class Test>
  bool any_near(const ObstacleView& obstacles, Surely&& surely, Test&& test) {
    for (std::size_t k = 0; k < queries_.size(); ++k) {
      const std::size_t h = k == 0 ? first_asked_ : k - (k <= first_asked_ ? 1 : 0);
      const auto none_of = [&](const NearPair* begin, const NearPair* end) {
        return !std::any_of(begin, end, surely) && !std::any_of(begin, end, test);
      };
      const bool none = visit_hulls(h, h + 1, obstacles, [](std::size_t) { return 0.0; }, none_of);
      if (none) continue;
      first_asked_ = h;
      return true;
    }
    return false;
  }

  /// At most the distances of kLanes obstacles, from `first` on, from what hull h stands for, less
  /// their radii as they are in the set [m]: of capsules to single precision, of a spheroid by
  /// planes. False, and nothing, of a spheroid that is none.
  bool bound_distances(std::size_t h, const ObstacleView& obstacles, int first,
                       float (&bounds)[kLanes]) {
    const Hull& hull = hulls_[h];
    auto [centre, half, semi_major] = around(hull);
    centre -= obstacles->origin();
    if (hull.has_capsules()) {
      const auto blocks = static_cast<std::size_t>(hull.blocks);
      const std::span<const CapsuleQuery> capsules =
          capsule_queries_.of(h, {model_.capsules(hull), blocks}, frame(hull), obstacles->origin());
      kernels_.capsule_gaps(obstacles->arrays(), first, capsules.data(),
                            static_cast<int>(capsules.size()), bounds);
    } else {
      if (!(dot3(half, half) < kThickEnough * semi_major * semi_major)) return false;
      kernels_.bound_distances(obstacles->arrays(), first, query_of(centre, half, semi_major),
                               bounds);
    }
    // Rounding, and radii that are less than they are in the set.
    const double far = std::abs(centre[0]) + std::abs(centre[1]) + std::abs(centre[2]);
    const double slack = 4e-6 * (obstacles->extent() + semi_major + far);
    for (float& bound : bounds) bound -= static_cast<float>(slack);
    return true;
  }

  /// How deep a point lies in a hull's capsules.
  Depth depth_in_capsules(const Hull& hull, const Vec4& o) const {
    return depth_in(model_.capsules(hull), hull.blocks, to_local(frame(hull), o));
  }
  /// Of a point from a hull's pieces: see LinkPieces::distance, but for the base frame.
  SolidDistance distance_to_pieces(const Hull& hull, const Vec4& o, double than) const {
    const Frame& at = frame(hull);
    SolidDistance found = model_.pieces->distance(model_.pieces_of(hull), to_local(at, o), than);
    found.gradient = rotate(at, found.gradient);
    return found;
  }
  const CapsuleBlock& block(const Hull& hull, int k) const { return model_.capsules(hull)[k]; }
  /// Of the body that a hull's capsules move with.
  const Frame& frame(const Hull& hull) const { return frames_[hull.body]; }
  const Frame* frames() const { return frames_; }

  int near_count() const { return near_count_; }
  const NearPair& near(int k) const { return pairs_[static_cast<std::size_t>(k)]; }
  const Vec4* positions() const { return positions_.data(); }
  const Vec4& position(int point) const { return positions_[static_cast<std::size_t>(point)]; }
  const std::vector<Hull>& hulls() const { return hulls_; }
  const Hull& hull(const NearPair& pair) const {
    return hulls_[static_cast<std::size_t>(pair.hull)];
  }
  /// Where what a hull stands for is looked for: about here.
  Vec4 centre_of(const Hull& hull) const { return around(hull).centre; }
  /// Between foci at `centre` less `half` and more.
  struct Around {
    Vec4 centre, half;
    double semi_major;
  };
  /// What holds all of it: its own spheroid, or that about its capsules.
  Around around(const Hull& hull) const {
    if (!hull.has_capsules()) return spheroid_of(hull);
    const Frame& at = frame(hull);
    return {transform(at, hull.middle), rotate(at, hull.half), hull.around};
  }
  int body_of_point(int point) const { return model_.points[static_cast<std::size_t>(point)].body; }
  void use_baseline() { kernels_ = baseline_coarse(); }

 private:
  Around spheroid_of(const Hull& hull) const {
    const Vec4 &a = position(hull.a), &b = position(hull.b);
    return {broadcast(0.5) * (a + b), broadcast(0.5) * (b - a), hull.semi_major};
  }
  static HullQuery query_of(const Vec4& centre, const Vec4& half, double semi_major) {
    HullQuery query{};
    for (int i = 0; i < 3; ++i) {
      query.centre[i] = static_cast<float>(centre[i]);
      query.half[i] = static_cast<float>(half[i]);
    }
    query.semi_major = static_cast<float>(semi_major);
    return query;
  }
  int capacity() const { return static_cast<int>(pairs_.size()); }

  template <class Grow, class Visit>
  bool visit_hulls(std::size_t first, std::size_t end, const ObstacleView& obstacles, Grow&& grow,
                   Visit&& visit) {
    near_count_ = 0;
    if (obstacles->count() == 0) return true;
    CullCursor at{static_cast<int>(first), 0};
    const int room = std::min(kFewPairs, capacity());
    while (at.hull < static_cast<int>(end)) {
      for (auto h = static_cast<std::size_t>(at.hull); h < end; ++h)
        set_query(h, obstacles, grow(h), true);
      const int found = kernels_.cull(obstacles->arrays(), queries_.data(), static_cast<int>(end),
                                      pairs_.data(), room, at);
      const int count = without_allowed(obstacles, found);
      if (count > 0 && !visit(pairs_.data(), pairs_.data() + count)) return false;
    }
    return true;
  }

  /// Take pairs that are let touch out of the first ones. @returns How many are left.
  int without_allowed(const ObstacleView& obstacles, int count) {
    const bool allows = allowed_contact_ != nullptr && allowed_contact_->wanted();
    if (!allows && obstacles.own == nullptr) return count;
    const auto is_let = [&](const NearPair& pair) {
      const Hull& hull = this->hull(pair);
      const Vec4 o = obstacles.of(hull.source, pair.obstacle);
      if (std::isinf(o[3])) return true;
      return allows && allowed_contact_->lets(hull.source, o) &&
             point_depth(hull, o) <= allowed_contact_->depth();
    };
    const auto begin = pairs_.begin(), end = begin + count;
    return static_cast<int>(std::remove_if(begin, end, is_let) - begin);
  }
  /// How deep a point, whatever its radius, lies in what a hull stands for [m].
  double point_depth(const Hull& hull, const Vec4& o) const {
    if (hull.has_capsules()) {
      const double depth = depth_in_capsules(hull, o).depth;
      if (depth <= 0.0 || !hull.has_pieces()) return depth;
      return std::min(depth, -distance_to_pieces(hull, o, depth).distance);
    }
    return -spheroid_distance(to_vector3(o), to_vector3(position(hull.a)),
                              to_vector3(position(hull.b)), hull.semi_major)
                .distance;
  }

  /// @param by_distance  Whether what lies within a distance `grow` is meant, not half a sum of
  /// distances that is larger by as much.
  void set_query(std::size_t h, const ObstacleView& obstacles, double grow, bool by_distance) {
    const Hull& hull = hulls_[h];
    auto [centre, half, semi_major] = by_distance ? around(hull) : spheroid_of(hull);
    centre -= obstacles->origin();
    double margin = std::max(obstacles.margin_of(hull.source), 0.0);
    if (by_distance) grow += std::exchange(margin, 0.0);
    if (grow < 0.0) [[unlikely]] {
      const Core core = core_of(semi_major, dot3(half, half), -grow);
      half *= broadcast(core.foci);
      semi_major -= core.depth;
    } else if (by_distance && grow > 0.0 && grow < obstacles->extent() &&
               obstacles->in_order()) {  // of few it saves little
      const Offset offset = offset_of(semi_major, dot3(half, half), grow, supports_[h]);
      half *= broadcast(offset.foci);
      semi_major = offset.semi_major;
    } else {
      semi_major += grow;
    }
    // What lets points in is seen to by who measures: the coarse test takes hulls as they are.
    const double A = semi_major + margin, extent = obstacles->extent();
    double grown = A + coarse_slack(A, dot3(half, half), extent);
    if (!(grown < extent)) [[unlikely]]
      grown = bounded(grown, centre, half, extent);
    queries_[h] = query_of(centre, half, grown);
  }

  /// What reaches beyond everything, or is not known, takes in all obstacles and no padding.
  static double bounded(double grown, const Vec4& centre, const Vec4& half, double extent) {
    double farthest = extent;
    for (int i = 0; i < 3; ++i) farthest += std::abs(centre[i]) + std::abs(half[i]);
    const double everything = std::min(kLargestQuery, 4.0 * farthest);
    return grown < everything ? grown : everything;
  }

  /// Pairs are visited so many at a time: what is learnt from some may spare most of the others.
  static constexpr int kFewPairs = 16 * kLanes;
  /// Of the squared ratio of half the foci's distance to the semi-major axis: beyond it a spheroid
  /// is too thin for single precision.
  static constexpr double kThickEnough = 0.999;
  static constexpr double kLargestQuery = 1e14;  ///< padding lies ten times as far away [m]

  const HullModel& model_;
  const std::vector<Hull>& hulls_;
  std::vector<Vec4> positions_;
  std::vector<Frame> own_frames_;  ///< of those bodies that have capsules
  const Frame* frames_;
  std::vector<HullQuery> queries_;
  CapsuleQueries capsule_queries_;
  std::vector<double> supports_;
  std::vector<NearPair> pairs_;
  int near_count_ = 0;
  std::size_t first_asked_ = 0;
  const AllowedContact* allowed_contact_ = nullptr;
  CoarseKernels kernels_ = best_coarse();
};

}  // namespace pdoik::detail
