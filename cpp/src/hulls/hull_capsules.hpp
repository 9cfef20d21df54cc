#pragma once

#include <limits>
#include <span>
#include <vector>

#include "hulls/allowed_contact.hpp"
#include "hulls/hull_model.hpp"
#include "hulls/point_gradients.hpp"

namespace pdoik::detail {

/// What lies within `radius` of the segment middle +- half, where the robot is.
struct PlacedCapsule {
  Vec4 middle{}, half{};
  double radius = 0.0;
  double reach = 0.0;  ///< nothing of it is farther than this from its middle [m]
  int source = -1;     ///< the hull's or capsule's place in the occupancy
  /// By how much it stands out of its link at most; infinite where nobody knows [m].
  double overhang = std::numeric_limits<double>::infinity();
};

/// The robot's hulls as capsules: those that a hull has, or else the one that holds it.
///
/// A spheroid with semi-axes A > B lies in the capsule of radius B around -(A - B) to +(A - B) on
/// its axis, and touches it at its tips and its waist. Proof, at x >= 0 along the axis, where the
/// spheroid reaches out to y^2 = B^2 (1 - x^2 / A^2). Beside the segment, x <= A - B, the distance
/// from it is y <= B. Beyond its end it is (t^2 + y^2)^(1/2) with t = x - (A - B) > 0, which is at
/// most B if t <= B x / A; and B x / A - t = (A - B)(1 - x / A) >= 0 since x <= A. It stands out by
/// B (1 - (2 B / (A + B))^(1/2)) at most: 0.18 B of A = 2 B, 0.42 B of A = 5 B.
///
/// That capsule has its middle at m = (a + b) / 2 and half s g, where g = (b - a) / 2 is half of
/// what joins the foci, h = |g|, B = (A^2 - h^2)^(1/2) and s = (A - B) / h = h / (A + B). Foci that
/// are rigid to each other leave s and B constant. Otherwise dB/dh = -h / B and ds/dh = A / (B (A +
/// B)); where such foci are farther apart than 2 A the hull holds nothing: its middle is not a
/// number.
///
/// The state of one thread. Allocates at construction only.
class HullCapsules {
 public:
  /// @param exact_below  Where capsules come nearer to something than this, links' own pieces say
  /// how near they are [m].
  HullCapsules(const Robot& robot, const HullModel& model, const std::vector<Hull>& hulls,
               double exact_below);

  /// Take the attached points, in the order of HullModel::points, and the bodies' frames from where
  /// a rollout or judge has put them. Both are read until they are placed again.
  void place(const Vec4* positions, const Frame* frames);

  /// What may touch obstacles at the target. Outlives it; null for none.
  void allow(const AllowedContact* contact) { allowed_contact_ = contact; }
  const AllowedContact* allowed_contact() const { return allowed_contact_; }

  int count() const { return static_cast<int>(hulls_.size()); }
  /// The most capsules that a hull is.
  std::size_t most() const;
  /// The place in the occupancy of what a hull is, all of which sits on the same link or links.
  int source(int k) const {
    const PlacedHull& own = hull(k);
    return own.count > 0 ? capsules_[static_cast<std::size_t>(own.first)].source
                         : own.around.source;
  }
  /// The capsule that holds a hull, but for its excess.
  const PlacedCapsule& around(int k) const { return hull(k).around; }
  /// Their middles, of all hulls.
  const Vec4* middles() const { return middles_.data(); }
  /// By how much what the hull is may stand beyond that [m].
  double excess(int k) const { return hull(k).excess; }
  /// What a hull is: placed when first asked for.
  std::span<const PlacedCapsule> of(int k);
  /// No part of a hull is farther than this from the middle of `around` [m].
  double semi_major(int k) const { return hull(k).semi_major + hull(k).excess; }

  /// Add how a constraint changes with one hull, from dc/d(point middle + t half of one of its
  /// capsules), -1 <= t <= 1.
  void add_gradient(int k, const PlacedCapsule& capsule, double t, const Vec4& force,
                    PointGradients& gradients) const;

  /// The pieces of the link that a hull's capsules hold; none where they are not asked about what
  /// is this far from its capsules.
  std::span<const int> pieces_at(int k, double distance) const {
    if (!(distance < exact_below_)) return {};
    return {piece_ids_.data() + hull(k).first_piece, static_cast<std::size_t>(hull(k).pieces)};
  }
  const Solid& piece(int piece) const { return pieces_->solid(piece); }
  /// Of hull k's body, which its pieces move with.
  const Frame& frame(int k) const { return frames_[hull(k).body]; }
  /// Add how a constraint changes with one hull, from dc/d(a point of its pieces).
  void add_piece_gradient(int k, const Vec4& point, const Vec4& force,
                          PointGradients& gradients) const {
    gradients.add(hull(k).body, point, force);
  }

 private:
  struct PlacedHull {
    int a, b;
    double semi_major;
    bool rigid;           // its foci to each other: the rest is then constant
    double minor, shape;  // B and s = h / (A + B)
    Vec4 between{};       // g
    PlacedCapsule around;
    int body, first_block;  // of its capsules
    double excess;
    int first_piece, pieces;
    int first = 0, count = 0;  // of them where they are placed
    bool is_placed = false;    // since the bodies were
  };
  const PlacedHull& hull(int k) const { return hulls_[static_cast<std::size_t>(k)]; }

  const AllowedContact* allowed_contact_ = nullptr;
  const Vec4* positions_ = nullptr;
  const Frame* frames_ = nullptr;
  std::vector<int> body_of_point_;
  double exact_below_;
  std::vector<CapsuleBlock> blocks_;
  std::shared_ptr<const LinkPieces> pieces_;
  std::vector<int> piece_ids_;
  std::vector<PlacedCapsule> capsules_;
  std::vector<PlacedHull> hulls_;
  std::vector<Vec4> middles_;  ///< of the capsules around them, which most questions need alone
};

}  // namespace pdoik::detail
