#include "shapes/convex_distance.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "shapes/convex_field_distance.hpp"

namespace pdoik::detail {
namespace {

using Eigen::Vector3d;

/// A point of the difference of two solids, and the point of the moving one that it comes from.
struct Corner {
  Vector3d w, a;
};

/// The difference of two solids' insides: all a - b.
class Difference {
 public:
  Difference(const Solid& moving, const Frame& T, const Solid& still, int piece)
      : moving_(moving), T_(T), still_(still), piece_(piece) {}

  Corner support(const Vector3d& direction) const {
    const Vec4 d = to_vec4(direction);
    const Vec4 local{dot3(T_.x, d), dot3(T_.y, d), dot3(T_.z, d), 0.0};
    const Vector3d a = to_vector3(transform(T_, moving_.support(local)));
    return {a - to_vector3(still_.support_of(piece_, -d)), a};
  }
  Vector3d middle() const { return to_vector3(transform(T_, moving_.centre()) - still_.centre()); }
  double size() const { return moving_.radius() + still_.radius(); }

 private:
  const Solid& moving_;
  const Frame& T_;
  const Solid& still_;
  int piece_;
};

/// A tetrahedron whose volume is less than this of what its edges' lengths allow is flat.
constexpr double kFlat = 1e-9;

/// One to four corners, and the point of what they span that is nearest to the origin.
class Simplex {
 public:
  void add(const Corner& corner) { corners_[static_cast<std::size_t>(count_++)] = corner; }
  int count() const { return count_; }
  const Corner& operator[](int k) const { return corners_[static_cast<std::size_t>(k)]; }
  bool holds(const Vector3d& w) const {
    return std::any_of(corners_.begin(), corners_.begin() + count_,
                       [&](const Corner& corner) { return corner.w == w; });
  }

  /// Keep the corners that the nearest point needs. @returns That point.
  Vector3d reduce() {
    Best best;
    // The nearest point of a simplex is that of one of its parts whose weights are all positive.
    for (unsigned part = 1; part < 1U << static_cast<unsigned>(count_); ++part)
      try_part(part, best);
    std::array<Corner, 4> kept;
    int count = 0;
    for (int k = 0; k < count_; ++k) {
      if ((best.part >> static_cast<unsigned>(k) & 1U) == 0) continue;
      weights_[static_cast<std::size_t>(count)] = best.weights[static_cast<std::size_t>(k)];
      kept[static_cast<std::size_t>(count++)] = (*this)[k];
    }
    corners_ = kept;
    count_ = count;
    return best.nearest;
  }
  /// The point of the moving solid that the nearest point comes from.
  Vector3d on_moving() const {
    Vector3d sum = Vector3d::Zero();
    for (int k = 0; k < count_; ++k) sum += weights_[static_cast<std::size_t>(k)] * (*this)[k].a;
    return sum;
  }

 private:
  struct Best {
    unsigned part = 1;
    std::array<double, 4> weights{1.0, 0.0, 0.0, 0.0};
    Vector3d nearest = Vector3d::Zero();
    double square = std::numeric_limits<double>::infinity();
  };

  /// The point of the plane (line, corner) of some corners that is nearest, if it is between them.
  void try_part(unsigned part, Best& best) const {
    std::array<int, 4> which{};
    int n = 0;
    for (int k = 0; k < count_; ++k)
      if ((part >> static_cast<unsigned>(k) & 1U) != 0) which[static_cast<std::size_t>(n++)] = k;
    const auto at = [&](int k) -> const Vector3d& {
      return (*this)[which[static_cast<std::size_t>(k)]].w;
    };
    const Vector3d& first = at(0);
    // By Cramer's rule, of the Gram matrix of the edges from the first.
    std::array<double, 3> shares{};
    if (n == 2) {
      const Vector3d u = at(1) - first;
      shares[0] = -u.dot(first) / u.squaredNorm();
    } else if (n == 3) {
      const Vector3d u = at(1) - first, v = at(2) - first;
      const double uu = u.squaredNorm(), uv = u.dot(v), vv = v.squaredNorm(), pu = -u.dot(first),
                   pv = -v.dot(first), size = uu * vv - uv * uv;
      shares[0] = (vv * pu - uv * pv) / size;
      shares[1] = (uu * pv - uv * pu) / size;
    } else if (n == 4) {
      const Vector3d u = at(1) - first, v = at(2) - first, w = at(3) - first, vw = v.cross(w);
      const double volume = u.dot(vw);
      // What is nearly flat holds nothing: rounding would say that it holds the origin.
      if (!(std::abs(volume) > kFlat * u.norm() * v.norm() * w.norm())) return;
      shares[0] = -first.dot(vw) / volume;
      shares[1] = -first.dot(w.cross(u)) / volume;
      shares[2] = -first.dot(u.cross(v)) / volume;
    }
    std::array<double, 4> weights{};
    double rest = 1.0;
    for (int k = 1; k < n; ++k) {
      const double share = shares[static_cast<std::size_t>(k - 1)];
      weights[static_cast<std::size_t>(which[static_cast<std::size_t>(k)])] = share;
      rest -= share;
    }
    weights[static_cast<std::size_t>(which[0])] = rest;
    Vector3d nearest = Vector3d::Zero();
    for (int k = 0; k < n; ++k) {
      const int corner = which[static_cast<std::size_t>(k)];
      const double weight = weights[static_cast<std::size_t>(corner)];
      if (!(weight >= 0.0)) return;  // not between them, or of no extent
      nearest += weight * (*this)[corner].w;
    }
    const double square = nearest.squaredNorm();
    if (square < best.square) best = {part, weights, nearest, square};
  }

  std::array<Corner, 4> corners_;
  std::array<double, 4> weights_{};
  int count_ = 0;
};

/// What is outside a face by less than this, as a share of the solids' size, lies in its plane.
constexpr double kInPlane = 1e-12;

/// A polytope within a difference that holds the origin, grown until its nearest face is a face of
/// the difference.
class Polytope {
 public:
  struct Face {
    std::array<int, 3> corners;
    Vector3d normal;
    double offset;
  };

  /// @returns False if the difference is flat.
  bool begin(const Difference& difference, const Simplex& simplex) {
    for (int k = 0; k < simplex.count(); ++k) corners_[static_cast<std::size_t>(k)] = simplex[k];
    corner_count_ = simplex.count();
    const double thin = 1e-9 * difference.size();
    in_plane_ = kInPlane * difference.size();
    // Up to a tetrahedron: along axes, then across what is there.
    while (corner_count_ < 4) {
      if (!add_apart(difference, thin)) return false;
    }
    Vector3d inside = Vector3d::Zero();
    for (int k = 0; k < 4; ++k) inside += 0.25 * at(k).w;
    inside_ = inside;
    for (const auto& [i, j, k] : {std::array{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}})
      if (!add_face(i, j, k)) return false;
    return true;
  }

  /// The nearest face of the difference.
  const Face& grow(const Difference& difference) {
    const double precise = 1e-9 * difference.size();
    while (true) {
      const Face& nearest = *std::min_element(
          faces_.begin(), faces_.begin() + face_count_,
          [](const Face& one, const Face& other) { return one.offset < other.offset; });
      const Corner corner = difference.support(nearest.normal);
      if (nearest.normal.dot(corner.w) - nearest.offset <= precise || corner_count_ == kCorners ||
          !replace_faces_seen_from(corner))
        return last_ = nearest;
    }
  }
  const Corner& at(int k) const { return corners_[static_cast<std::size_t>(k)]; }

 private:
  static constexpr int kCorners = 100, kFaces = 2 * kCorners;

  /// A corner away from what the others span.
  bool add_apart(const Difference& difference, double thin) {
    std::array<Vector3d, 6> directions;
    int count = 0;
    const auto add = [&](const Vector3d& direction) {
      directions[static_cast<std::size_t>(count++)] = direction;
      directions[static_cast<std::size_t>(count++)] = -direction;
    };
    if (corner_count_ == 3) {
      add((at(1).w - at(0).w).cross(at(2).w - at(0).w));
    } else if (corner_count_ == 2) {
      const Vector3d along = at(1).w - at(0).w;
      const Vector3d across = along.unitOrthogonal();
      add(across);
      add(along.cross(across));
    } else {
      for (int i = 0; i < 3; ++i) add(Vector3d::Unit(i));
    }
    for (int k = 0; k < count; ++k) {
      const Vector3d& direction = directions[static_cast<std::size_t>(k)];
      const double length = direction.norm();
      if (!(length > 0.0)) continue;
      const Corner corner = difference.support(direction);
      if (direction.dot(corner.w - at(0).w) <= thin * length) continue;
      corners_[static_cast<std::size_t>(corner_count_++)] = corner;
      return true;
    }
    return false;
  }

  bool add_face(int i, int j, int k) {
    if (face_count_ == kFaces) return false;
    Vector3d normal = (at(j).w - at(i).w).cross(at(k).w - at(i).w);
    const double length = normal.norm();
    if (!(length > 0.0)) return false;
    normal /= length;
    double offset = normal.dot(at(i).w);
    if (normal.dot(inside_) > offset) {
      normal = -normal;
      offset = -offset;
      std::swap(j, k);
    }
    faces_[static_cast<std::size_t>(face_count_++)] = {{i, j, k}, normal, offset};
    return true;
  }

  bool replace_faces_seen_from(const Corner& corner) {
    const int added = corner_count_++;
    corners_[static_cast<std::size_t>(added)] = corner;
    // An edge of the hole borders one face that is seen, in that face's sense.
    std::array<std::array<int, 2>, 3 * static_cast<std::size_t>(kFaces)> edges;
    std::size_t edge_count = 0;
    int kept = 0;
    for (int f = 0; f < face_count_; ++f) {
      const Face& face = faces_[static_cast<std::size_t>(f)];
      // A face in whose plane the corner lies goes, too: a new one beside it could have no extent.
      if (face.normal.dot(corner.w) <= face.offset - in_plane_) {
        faces_[static_cast<std::size_t>(kept++)] = face;
        continue;
      }
      for (std::size_t e = 0; e < 3; ++e) {
        const std::array<int, 2> edge{face.corners[e], face.corners[(e + 1) % 3]};
        const auto end = edges.begin() + static_cast<std::ptrdiff_t>(edge_count);
        const auto back = std::find(edges.begin(), end, std::array<int, 2>{edge[1], edge[0]});
        if (back == end) {
          edges[edge_count++] = edge;
        } else {
          *back = edges[--edge_count];
        }
      }
    }
    face_count_ = kept;
    for (std::size_t e = 0; e < edge_count; ++e)
      if (!add_face(edges[e][0], edges[e][1], added)) return false;
    return edge_count > 0;
  }

  std::array<Corner, static_cast<std::size_t>(kCorners)> corners_;
  std::array<Face, static_cast<std::size_t>(kFaces)> faces_;
  Face last_{};
  Vector3d inside_ = Vector3d::Zero();
  double in_plane_ = 0.0;
  int corner_count_ = 0, face_count_ = 0;
};

ConvexDistance from_half_space(const Solid& moving, const Frame& T, const Solid& still) {
  const Vec4& normal = still.normal();
  const Vec4 down = -Vec4{dot3(T.x, normal), dot3(T.y, normal), dot3(T.z, normal), 0.0};
  const Vec4 lowest = transform(T, moving.support(down));
  return {still.distance(lowest).distance - moving.rounding(), lowest, normal};
}

/// Apart by less than this, as a share of their size, solids count as touching: the direction
/// between them is lost in rounding.
constexpr double kTouching = 1e-10;
constexpr int kMostSteps = 100;

ConvexDistance piece_distance(const Solid& moving, const Frame& T, const Solid& still, int piece,
                              double than, HowDeep how_deep) {
  const Difference difference(moving, T, still, piece);
  const double rounding = moving.rounding() + still.rounding(),
               touching = kTouching * difference.size(), far = std::max(than + rounding, 0.0);
  Vector3d v = difference.middle();
  if (!(v.squaredNorm() > 0.0)) v = Vector3d::UnitX();
  Simplex simplex;
  for (int step = 0; step < kMostSteps; ++step) {
    const Corner corner = difference.support(-v);
    const double square = v.squaredNorm(), along = v.dot(corner.w);
    if (along > 0.0 && along * along > far * far * square)
      return {std::sqrt(square) - rounding, to_vec4(corner.a), to_vec4(v.normalized())};
    // Nothing is nearer than the plane through the new corner across v.
    if (simplex.count() > 0 && (square - along <= 1e-12 * square || simplex.holds(corner.w))) break;
    simplex.add(corner);
    v = simplex.reduce();
    if (simplex.count() == 4 || v.norm() <= touching) break;
  }
  const double apart = v.norm();
  if (simplex.count() < 4 && apart > touching) {
    const Vector3d normal = v / apart;
    return {apart - rounding, to_vec4(simplex.on_moving()), to_vec4(normal)};
  }
  if (how_deep == HowDeep::Unknown && than >= 0.0) return {-rounding - touching, Vec4{}, Vec4{}};
  Polytope polytope;
  if (!polytope.begin(difference, simplex)) {
    // Of no thickness, and the origin within: across it is the way out.
    Vector3d normal = Vector3d::UnitZ();
    if (simplex.count() >= 3)
      normal = (simplex[1].w - simplex[0].w).cross(simplex[2].w - simplex[0].w).normalized();
    else if (simplex.count() == 2)
      normal = (simplex[1].w - simplex[0].w).unitOrthogonal();
    return {-rounding, to_vec4(simplex.on_moving()), to_vec4(normal)};
  }
  const Polytope::Face& face = polytope.grow(difference);
  // The origin's foot on the face, by its corners' weights.
  const auto& [i, j, k] = face.corners;
  Eigen::Matrix3d corners;
  corners << polytope.at(i).w, polytope.at(j).w, polytope.at(k).w;
  Eigen::Matrix<double, 4, 3> system;
  system << corners, Eigen::RowVector3d::Ones() * difference.size();
  Eigen::Vector4d wanted;
  wanted << face.offset * face.normal, difference.size();
  const Vector3d weights = system.colPivHouseholderQr().solve(wanted);
  const Vector3d on_moving =
      weights[0] * polytope.at(i).a + weights[1] * polytope.at(j).a + weights[2] * polytope.at(k).a;
  return {-std::max(face.offset, 0.0) - rounding, to_vec4(on_moving), to_vec4(-face.normal)};
}

}  // namespace

ConvexDistance convex_distance(const Solid& moving, const Frame& T, const Solid& still, double than,
                               HowDeep how_deep) {
  if (still.is_half_space()) return from_half_space(moving, T, still);
  if (still.is_field()) return convex_field_distance(moving, T, still, than);
  ConvexDistance nearest = piece_distance(moving, T, still, 0, than, how_deep);
  for (int piece = 1; piece < still.pieces(); ++piece) {
    const ConvexDistance found =
        piece_distance(moving, T, still, piece, std::min(than, nearest.distance), how_deep);
    if (found.distance < nearest.distance) nearest = found;
  }
  return nearest;
}

double separation(const Solid& moving, const Frame& T, const Solid& still, const Vec4& along) {
  const Vec4 back = -Vec4{dot3(T.x, along), dot3(T.y, along), dot3(T.z, along), 0.0};
  const Vec4 apart = transform(T, moving.support(back)) - still.support(along);
  return dot3(apart, along) - moving.rounding() - still.rounding();
}

}  // namespace pdoik::detail
