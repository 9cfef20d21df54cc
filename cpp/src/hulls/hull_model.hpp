#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "common/frame.hpp"
#include "hulls/capsule_block.hpp"
#include "hulls/link_pieces.hpp"
#include "pdoik/robot.hpp"

namespace pdoik::detail {

/// A point of the robot that distances are measured from: u_i of the paper, or any further one.
struct AttachedPoint {
  int body;
  Vec4 local;  ///< in the body's frame
};

/// A sphere (a == b, semi_major its radius) or a spheroid with foci at two attached points. One
/// that has capsules only says where to look: they, and not it, are what the link fills.
struct Hull {
  int a, b;
  double semi_major;
  int source;  ///< its place in the occupancy, or that of its first capsule if it was made for them
  int body = 0, first_block = 0, blocks = 0;  ///< its capsules, which move with a body
  int first_piece = 0, pieces = 0;            ///< of the link itself, that reach into its capsules
  double excess = 0.0;                        ///< how much it must grow to hold them all [m]
  bool rigid = true;                          ///< its foci to each other
  /// A spheroid that holds its capsules tightly, in their body's frame: its middle, half of what
  /// joins its foci, and its semi-major axis [m].
  Vec4 middle{}, half{};
  double around = 0.0;

  bool is_sphere() const { return a == b; }
  bool has_capsules() const { return blocks > 0; }
  bool has_pieces() const { return pieces > 0; }
  /// No part of it is farther from its middle than this [m].
  double farthest() const { return has_capsules() ? around : semi_major; }
};

/// Whether a point moves with a body: its link's and, as long as it lies on the axis of a body's
/// joint, the body before. HullModel has settled it on the last of them.
bool moves_with(const Robot& robot, int link, int settled, int body);

/// Whether a point stays where it is to a body: that which it is settled on, or one behind joints
/// on whose axes it lies.
bool is_carried_by(const Robot& robot, const AttachedPoint& point, int body);

/// Whether a body is another or comes after it and before no tip but its own: a hand with its
/// fingers.
bool ends_with(const Robot& robot, int body, int first);

struct HullModel;
/// Whether all of a hull moves with a body.
bool moves_with(const Robot& robot, const HullModel& model, const Hull& hull, int body);
/// The links that a hull's foci are given on.
std::pair<int, int> links_of(const Robot& robot, const Hull& hull);
/// The links that what a hull is sits on: its capsules' or, without any, those of its foci.
std::pair<int, int> seat_of(const Robot& robot, const HullModel& model, const Hull& hull);
/// The same of a place in the occupancy: twice the same but for a spheroid between two links.
std::pair<int, int> links_of_source(const Robot& robot, int source);

/// The robot's hulls on their attached points, each point once. Points on a joint's own axis belong
/// to the body before it, since that joint does not move them; hulls that no joint moves are kept
/// apart.
struct HullModel {
  /// @param with_fixed  Whether hulls that no joint moves are any.
  /// @param pieces  Of the robot's links, which decide where capsules touch; may be none.
  HullModel(const Robot& robot, bool with_fixed, std::shared_ptr<const LinkPieces> pieces);
  /// With all hulls, and pieces of its own.
  explicit HullModel(const Robot& robot);
  /// None.
  HullModel() = default;

  /// The moving ones first.
  std::vector<Hull> all() const {
    std::vector<Hull> hulls = moving;
    hulls.insert(hulls.end(), fixed.begin(), fixed.end());
    return hulls;
  }

  const CapsuleBlock* capsules(const Hull& hull) const { return blocks.data() + hull.first_block; }
  std::span<const int> pieces_of(const Hull& hull) const {
    return {piece_ids.data() + hull.first_piece, static_cast<std::size_t>(hull.pieces)};
  }
  /// Calls visit(body, a bound on how far what a hull fills is from the body's origin).
  template <class Visit>
  void for_each_arm(const Hull& hull, Visit&& visit) const {
    for (const int k : {hull.a, hull.b}) {
      const AttachedPoint& point = points[static_cast<std::size_t>(k)];
      // A hull lies within twice its semi-major axis of each of its foci.
      visit(point.body, std::sqrt(dot3(point.local, point.local)) + 2.0 * hull.semi_major);
    }
    for (int k = 0; k < 4 * hull.blocks; ++k) {
      const double length = capsule_arm(capsules(hull)[k / 4], k % 4);
      if (length > 0.0) visit(hull.body, length);
    }
  }

  std::vector<AttachedPoint> points;
  std::vector<Hull> moving, fixed;
  std::vector<CapsuleBlock> blocks;
  std::shared_ptr<const LinkPieces> pieces = std::make_shared<LinkPieces>();  ///< never null
  std::vector<int> piece_ids;  ///< of hulls, one after the other
  /// No obstacle farther than this and twice its radius from `reach_centre` can touch a moving
  /// hull; infinite if unknown.
  Eigen::Vector3d reach_centre = Eigen::Vector3d::Zero();
  double reach = std::numeric_limits<double>::infinity();

 private:
  /// How far a capsule reaches from its body's origin; not positive for padding.
  static double capsule_arm(const CapsuleBlock& block, int lane) {
    const Vec4 a{block.ax[lane], block.ay[lane], block.az[lane], 0.0},
        b = a + Vec4{block.vx[lane], block.vy[lane], block.vz[lane], 0.0};
    return std::sqrt(std::max(dot3(a, a), dot3(b, b))) + block.radius[lane];
  }
  void give_capsules(const Robot& robot, std::vector<Hull>& hulls);
  void give_pieces(int link, Hull& hull);
};

}  // namespace pdoik::detail
