#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "pdoik/robot.hpp"
#include "shapes/solid.hpp"

namespace pdoik::detail {

/// The convex pieces that links are made of, each in the frame of its link's body: those of the
/// occupancy and, where it has any, the capsules of links that have none, which are what these are.
class LinkPieces {
 public:
  /// None.
  LinkPieces() = default;
  explicit LinkPieces(const Robot& robot);

  int count() const { return static_cast<int>(pieces_.size()); }
  const Solid& solid(int k) const { return piece(k).solid; }
  int link(int k) const { return piece(k).link; }

  /// The signed distance of a point from some of them together: from the one that it is nearest to,
  /// or deepest in; `than`, and no gradient, if none is nearer than that.
  /// @param p  In the body's frame.
  SolidDistance distance(std::span<const int> some, const Vec4& p, double than) const;

 private:
  /// Four faces' planes, side by side: those through padding lie infinitely far off.
  struct Planes {
    Vec4 x{}, y{}, z{}, offset = broadcast(std::numeric_limits<double>::infinity());
    std::array<int, 4> face{};
  };
  struct Piece {
    Piece(const Robot& robot, const ConvexPiece& piece);
    Piece(const Robot& robot, const Capsule& capsule);

    Solid solid;
    int link;
    std::vector<Planes> planes;  ///< each once; none of a capsule
  };
  const Piece& piece(int k) const { return pieces_[static_cast<std::size_t>(k)]; }

  std::vector<Piece> pieces_;
};

}  // namespace pdoik::detail
