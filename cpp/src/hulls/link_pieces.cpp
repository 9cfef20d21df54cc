#include "hulls/link_pieces.hpp"

#include <cmath>
#include <set>
#include <string>

namespace pdoik::detail {
namespace {

/// Planes that differ by less are one: of normals by component, of offsets as a share of the
/// piece's radius.
constexpr double kSamePlane = 1e-9;

Solid in_body(const Robot& robot, const ConvexPiece& piece) {
  return Solid(Shape::convex_mesh(piece.link, robot.T_body_link(robot.link_index(piece.link)),
                                  piece.vertices, piece.triangles));
}

Solid in_body(const Robot& robot, const Capsule& capsule) {
  const Eigen::Isometry3d& T = robot.T_body_link(robot.link_index(capsule.link));
  const Eigen::Vector3d along = capsule.b - capsule.a, middle = 0.5 * (capsule.a + capsule.b);
  if (along.isZero(0.0)) return Solid(Shape::sphere(capsule.link, T * middle, capsule.radius));
  const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), along);
  return Solid(Shape::capsule(capsule.link, T * Eigen::Translation3d(middle) * turn, capsule.radius,
                              along.norm()));
}

}  // namespace

LinkPieces::Piece::Piece(const Robot& robot, const Capsule& capsule)
    : solid(in_body(robot, capsule)), link(robot.link_index(capsule.link)) {}

LinkPieces::Piece::Piece(const Robot& robot, const ConvexPiece& piece)
    : solid(in_body(robot, piece)), link(robot.link_index(piece.link)) {
  std::size_t count = 0;
  const auto is_known = [&](const Triangle& face) {
    for (std::size_t k = 0; k < count; ++k) {
      const Planes& four = planes[k / 4];
      const std::size_t i = k % 4;
      const Vec4 off = face.normal - Vec4{four.x[i], four.y[i], four.z[i], 0.0};
      if (dot3(off, off) < kSamePlane * kSamePlane &&
          std::abs(face.offset - four.offset[i]) < kSamePlane * solid.radius())
        return true;
    }
    return false;
  };
  for (std::size_t f = 0; f < solid.faces().size(); ++f) {
    const Triangle& face = solid.faces()[f];
    if (is_known(face)) continue;
    if (count % 4 == 0) planes.emplace_back();
    Planes& four = planes.back();
    const std::size_t i = count++ % 4;
    four.x[i] = face.normal[0], four.y[i] = face.normal[1], four.z[i] = face.normal[2];
    four.offset[i] = face.offset;
    four.face[i] = static_cast<int>(f);
  }
}

LinkPieces::LinkPieces(const Robot& robot) {
  const Occupancy& occupancy = robot.occupancy();
  if (occupancy.pieces.empty()) return;
  std::set<std::string> in_pieces;
  for (const ConvexPiece& piece : occupancy.pieces) {
    pieces_.emplace_back(robot, piece);
    in_pieces.insert(piece.link);
  }
  for (const Capsule& capsule : occupancy.capsules)
    if (!in_pieces.contains(capsule.link)) pieces_.emplace_back(robot, capsule);
}

SolidDistance LinkPieces::distance(std::span<const int> some, const Vec4& p, double than) const {
  SolidDistance nearest{than, Vec4{}};
  const Vec4 x = broadcast(p[0]), y = broadcast(p[1]), z = broadcast(p[2]);
  for (const int k : some) {
    const Piece& piece = this->piece(k);
    if (piece.solid.bound(p, 0.0) >= nearest.distance) continue;
    if (piece.planes.empty()) {
      const SolidDistance found = piece.solid.distance(p);
      if (found.distance < nearest.distance) nearest = found;
      continue;
    }
    // No point of a convex solid is nearer than the plane of any face that looks at it.
    double above = -std::numeric_limits<double>::infinity();
    int face = 0;
    for (const Planes& four : piece.planes) {
      const Vec4 each = x * four.x + y * four.y + z * four.z - four.offset;
      for (std::size_t i = 0; i < 4; ++i) {
        if (!(each[i] > above)) continue;
        above = each[i];
        face = four.face[i];
      }
      if (above >= nearest.distance) break;
    }
    if (above >= nearest.distance) continue;
    const Triangle& highest = piece.solid.faces()[static_cast<std::size_t>(face)];
    if (above <= 0.0 || highest.is_below(p)) {
      nearest = {above, highest.normal};
      continue;
    }
    const SolidDistance found = piece.solid.distance(p);
    if (found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

}  // namespace pdoik::detail
