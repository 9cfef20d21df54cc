#pragma once

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "hulls/hull_capsules.hpp"
#include "hulls/pair_margins.hpp"
#include "shapes/segment_distance.hpp"

namespace pdoik::detail {

/// A capsule, and how far it stands out along some direction [m].
struct Standing {
  const PlacedCapsule* capsule;
  double stands;
};

/// Distances between the robot's own hulls, each as its capsules or held in one (the paper leaves
/// this open: "constraining distances between points attached on the robot").
///
/// The state of one thread. Allocates at construction only.
class SelfCollision {
 public:
  /// Two hulls that may touch.
  struct Pair {
    int source[2];  ///< their places in the occupancy: spheres first, then spheroids
    int link[2];    ///< the links they sit on; of a hull that spans two links, the first
    int hull[2];    ///< their places among the model's moving hulls, then fixed ones
  };

  /// Pairs of hulls on links that are neither the same, nor rigidly connected, nor adjacent (joined
  /// by one moving joint, through any number of fixed ones), nor may touch by rules. Hulls
  /// that stay where they are relative to each other are rigidly connected, whatever links they
  /// were given on; a hull whose foci are rigid to each other sits on one link, even if they were
  /// given on two (between two joints' axes it does). One that spans two links has the neighbours
  /// and the rules of both.
  /// @param margin  Added to c, which thus asks for that much distance [m].
  /// @param margins  By how much more of a pair.
  SelfCollision(const Robot& robot, const HullModel& hulls, double margin,
                const PairMargins& margins);
  /// The same by robot.ignored_pairs() alone.
  SelfCollision(const Robot& robot, const HullModel& hulls, double margin)
      : SelfCollision(robot, hulls, margin, PairMargins(robot)) {}

  int pair_count() const { return static_cast<int>(pairs_.size()); }
  const Pair& pair(int k) const { return pairs_[static_cast<std::size_t>(k)]; }

  /// Take the attached points, in the order of HullModel::points, and the bodies' frames from where
  /// a rollout or judge has put them. Both are read until they are placed again.
  void place(const Vec4* positions, const Frame* frames);

  /// A pair's constraint c <= 0 and its derivatives.
  struct Near {
    int pair;
    double c;  ///< radii + margin of the pair - distance of the segments [m]
    PointGradients gradients;
  };

  /// Find the pairs with c > -reach(pair).
  template <class Reach>
  void find_near(Reach&& reach) {
    near_count_ = 0;
    const Vec4* const middles = capsules_.middles();
    for (int k = 0; k < pair_count(); ++k) {
      const double within = reach(k);
      if (glance(k).is_within(middles, margin_ + glance(k).margin + within)) add_if_near(k, within);
    }
  }
  int near_count() const { return near_count_; }
  /// Whether any pair's constraint is violated. What tells soonest is looked at first.
  bool any_touches();
  const Near& near(int k) const { return near_[static_cast<std::size_t>(k)]; }

  /// Distance between a pair's capsules where they are placed, without margin [m]; negative by how
  /// much of their radii overlap, infinite if one holds nothing.
  double distance(int pair);

  /// Whether a pair's capsules are nearer than this beyond what is wanted of them.
  bool is_nearer(int k, double than) {
    than += margin_ + glance(k).margin;
    return glance(k).is_within(capsules_.middles(), than) &&
           nearest(glance(k), than, Wanted::Any).one != nullptr;
  }

  /// How many pairs of pieces have been looked at.
  std::int64_t looks() const { return looks_; }

  struct Least {
    /// As if all pairs had the same margin: of one with more that much less.
    double distance = std::numeric_limits<double>::infinity();
    int pair = -1;
    int source[2] = {-1, -1};  ///< the places of both in the occupancy
  };
  /// The least of all pairs' distances, and whose it is.
  Least least();

 private:
  /// Of the pieces of two links: the nearest, or any two that are near enough.
  enum class Wanted { Nearest, Any };
  /// The nearest of two hulls' capsules.
  struct Nearest {
    double distance = std::numeric_limits<double>::infinity();  // less their radii
    SegmentDistance segments{};
    const PlacedCapsule *one = nullptr, *two = nullptr;
    bool by_pieces = false;  // of the links themselves: where, and the way of the first one out
    Vec4 point{}, away{};
  };

  /// What tells of most pairs that they are far apart.
  struct Glance {
    int a, b;           // hulls
    double semi_major;  // of both: nothing of a hull is farther than that from its middle
    double margin;      // of its own, beside that of all

    /// False for hulls that hold nothing: their middle is not a number.
    bool is_within(const Vec4* middles, double distance) const {
      const Vec4 apart = middles[a] - middles[b];
      const double bound = semi_major + distance;
      return bound > 0.0 && dot3(apart, apart) < bound * bound;
    }
  };
  const Glance& glance(int k) const { return glances_[static_cast<std::size_t>(k)]; }
  /// The nearest of a pair's capsules, or of its links' pieces, if nearer than `than`.
  Nearest nearest(const Glance& pair, double than, Wanted wanted = Wanted::Nearest) {
    Nearest found = nearest_of_capsules(pair, than);
    if (needs_pieces(pair, found)) look_at_pieces(pair, than, wanted, found);
    return found;
  }
  Nearest nearest_of_capsules(const Glance& pair, double than) {
    if (has_capsules_) return nearest_of_many(pair, than);
    const PlacedCapsule &a = capsules_.around(pair.a), &b = capsules_.around(pair.b);
    const SegmentDistance found = segment_distance(a.middle, a.half, b.middle, b.half);
    const double distance = found.distance - a.radius - b.radius;
    if (!(distance < than)) return {};
    return {distance, found, &a, &b};
  }
  Nearest nearest_of_many(const Glance& pair, double than);
  /// Whether capsules do not decide: they do where they overlap by more than they stand out of
  /// their links.
  bool needs_pieces(const Glance& pair, const Nearest& nearest) const;
  /// Of a hull's pieces the one that a point of its link is likeliest to be in or at.
  int piece_about(int hull, const Vec4& point, double distance) const;
  void look_at_pieces(const Glance& pair, double than, Wanted wanted, Nearest& nearest);
  void add_if_near(int pair, double within);

  HullCapsules capsules_;
  std::vector<Pair> pairs_;
  std::vector<Glance> glances_;
  std::vector<Near> near_;
  /// Pairs whose capsules touch by so much, and need not touch themselves.
  std::vector<std::pair<double, int>> unsure_;
  std::vector<Standing> standing_[2];  ///< of two hulls' capsules, those that may be the nearest
  int near_count_ = 0;
  std::int64_t looks_ = 0;
  double margin_;
  bool has_capsules_ = false;  ///< any hull
};

}  // namespace pdoik::detail
