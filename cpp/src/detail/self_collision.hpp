#pragma once

#include <limits>
#include <vector>

#include "detail/hull_model.hpp"

namespace pdoik::detail {

/// Where two segments come closest: each given by its middle c and half v, its points c + t v with
/// -1 <= t <= 1; v = 0 is a point.
struct SegmentDistance {
  double distance;
  double t1, t2;  ///< of the nearest points
  Vec4 gap;       ///< from the nearest point of the second segment to that of the first
};

/// Exact for all segments, parallel and degenerate ones included (Ericson, "Real-Time Collision
/// Detection", 5.1.9, with the lines' nearest points from cross products, which lose no digits when
/// the segments are nearly parallel). Of parallel segments it takes the middle of where they lie
/// side by side.
SegmentDistance segment_distance(const Vec4& c1, const Vec4& v1, const Vec4& c2, const Vec4& v2);

/// A hull as self-collision sees it: all points within `radius` of the segment middle +- half.
///
/// A spheroid with semi-axes A > B lies in the capsule of radius B around -(A - B) to +(A - B) on
/// its axis, and touches it at its tips and its waist. Proof, at x >= 0 along the axis, where the
/// spheroid reaches out to y^2 = B^2 (1 - x^2 / A^2). Beside the segment, x <= A - B, the distance
/// from it is y <= B. Beyond its end it is (t^2 + y^2)^(1/2) with t = x - (A - B) > 0, which is at
/// most B if t <= B x / A; and B x / A - t = (A - B)(1 - x / A) >= 0 since x <= A.
struct Capsule {
  Vec4 middle{}, half{};
  double radius = 0.0;
};

/// Distances between the robot's own hulls, each held in a capsule (the paper leaves this open:
/// "constraining distances between points attached on the robot").
///
/// A spheroid's capsule has its middle at m = (a + b) / 2 and half s g, where g = (b - a) / 2 is
/// half of what joins the foci, h = |g|, B = (A^2 - h^2)^(1/2) and s = (A - B) / h = h / (A + B).
/// Foci that are rigid to each other leave s and B constant. Otherwise dB/dh = -h / B and
/// ds/dh = A / (B (A + B)); where such foci are farther apart than 2 A the hull holds nothing and
/// its pairs are nowhere near.
///
/// The state of one thread. Allocates at construction only.
class SelfCollision {
 public:
  /// Two hulls that may touch.
  struct Pair {
    int source[2];      ///< their places in the occupancy: spheres first, then spheroids
    int link[2];        ///< the links they sit on; of a hull that spans two links, the first
    int hull[2];        ///< their places among the model's moving hulls, then fixed ones
    double semi_major;  ///< the sum of both
  };

  /// Pairs of hulls on links that are neither the same, nor rigidly connected, nor adjacent (joined
  /// by one moving joint, through any number of fixed ones), nor in robot.ignored_pairs(). Hulls
  /// that stay where they are relative to each other are rigidly connected, whatever links they
  /// were given on; a hull whose foci are rigid to each other sits on one link, even if they were
  /// given on two (between two joints' axes it does). One that spans two links has the neighbours
  /// and the ignored pairs of both.
  /// @param margin  Added to c, which thus asks for that much distance [m].
  SelfCollision(const Robot& robot, const HullModel& hulls, double margin);

  int pair_count() const { return static_cast<int>(pairs_.size()); }
  const Pair& pair(int k) const { return pairs_[static_cast<std::size_t>(k)]; }

  /// Take the attached points from where a rollout or judge has put them, in the order of
  /// HullModel::points.
  void place(const Vec4* positions);

  /// A pair's constraint c <= 0 and its derivatives with respect to the attached points.
  struct Near {
    int pair;
    double c;             ///< radii + margin - distance of the segments [m]
    int point[4];         ///< foci of the first hull, then of the second; -1 is unused
    Vec4 dc_dpoint[4]{};  ///< a point may be there twice: the sum counts
  };

  /// Find the pairs with c > -reach(pair).
  template <class Reach>
  void find_near(Reach&& reach) {
    near_count_ = 0;
    for (int k = 0; k < pair_count(); ++k) {
      const Pair& p = pair(k);
      const double within = reach(k);
      // A capsule lies within semi_major of its middle.
      if (middles_within(p, p.semi_major + margin_ + within)) add_if_near(k, within);
    }
  }
  int near_count() const { return near_count_; }
  const Near& near(int k) const { return near_[static_cast<std::size_t>(k)]; }

  /// Distance between a pair's capsules where they are placed, without margin [m]; negative by how
  /// much of their radii overlap, infinite if one holds nothing.
  double distance(int pair) const;

  struct Least {
    double distance = std::numeric_limits<double>::infinity();
    int pair = -1;
  };
  /// The least of all pairs' distances, and whose it is.
  Least least() const;

 private:
  struct PlacedHull {
    int a, b;
    double semi_major;
    bool rigid;           // its foci to each other: the rest is then constant
    double minor, shape;  // B and s = h / (A + B)
    Vec4 between{};       // g
    Capsule capsule;
  };

  const PlacedHull& hull(int k) const { return hulls_[static_cast<std::size_t>(k)]; }
  /// False for hulls that hold nothing: their middle is not a number.
  bool middles_within(const Pair& pair, double bound) const {
    const Vec4 apart = hull(pair.hull[0]).capsule.middle - hull(pair.hull[1]).capsule.middle;
    return bound > 0.0 && dot3(apart, apart) < bound * bound;
  }
  SegmentDistance measure(const Pair& pair) const;
  void add_if_near(int pair, double within);
  /// Add to a near pair how it changes with one hull, from dc/d(nearest point of its segment).
  void pull(Near& near, int side, const PlacedHull& hull, double t, const Vec4& force) const;

  std::vector<PlacedHull> hulls_;
  std::vector<Pair> pairs_;
  std::vector<Near> near_;
  int near_count_ = 0;
  double margin_;
};

}  // namespace pdoik::detail
