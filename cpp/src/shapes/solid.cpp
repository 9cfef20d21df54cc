#include "shapes/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapes/field_distance.hpp"
#include "shapes/segment_distance.hpp"

namespace pdoik::detail {
namespace {

/// The signed distance of a point from all whose coordinates' excess over bounds is `over`, at most
/// 0 in each: by how much each is beyond, where none is the least that it is within.
SolidDistance beyond(const Vec4& over, int count, const Vec4* directions) {
  double square = 0.0, deepest = -std::numeric_limits<double>::infinity();
  int nearest = 0;
  Vec4 sum{};
  for (int i = 0; i < count; ++i) {
    if (over[i] > 0.0) {
      square += over[i] * over[i];
      sum += broadcast(over[i]) * directions[i];
    }
    if (over[i] > deepest) {
      deepest = over[i];
      nearest = i;
    }
  }
  if (!(square > 0.0)) return {deepest, directions[nearest]};
  const double distance = std::sqrt(square);
  return {distance, broadcast(1.0 / distance) * sum};
}

Vec4 unit(const Vec4& v, const Vec4& otherwise) {
  const double length = std::sqrt(dot3(v, v));
  return length > 1e-12 ? broadcast(1.0 / length) * v : otherwise;
}

/// The convex function of t is at its minimum to this [m].
constexpr double kPrecise = 1e-10;
constexpr int kMostTurns = 60;

/// Beside a face that looks at a point the nearest one may look this much away, as a share of the
/// mesh's radius.
constexpr double kUneven = 2.5e-4;

}  // namespace

Solid::Solid(const Shape& shape) : kind_(shape.kind), T_(to_frame(shape.T_base_shape)) {
  centre_ = T_.p;
  switch (kind_) {
    case Shape::Kind::Sphere:
      half_[0] = radius_ = shape.size[0];
      break;
    case Shape::Kind::Box:
      half_ = broadcast(0.5) * to_vec4(shape.size);
      radius_ = 0.5 * shape.size.norm();
      break;
    case Shape::Kind::Cylinder:
    case Shape::Kind::Capsule:
      half_[0] = shape.size[0];
      half_[1] = 0.5 * shape.size[1];
      radius_ =
          kind_ == Shape::Kind::Capsule ? half_[0] + half_[1] : std::hypot(half_[0], half_[1]);
      break;
    case Shape::Kind::HalfSpace:
      radius_ = std::numeric_limits<double>::infinity();
      break;
    case Shape::Kind::ConvexMesh: {
      T_ = to_frame(Eigen::Isometry3d::Identity());
      std::vector<Eigen::Vector3d> vertices;
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3d& vertex : shape.vertices) {
        vertices.emplace_back(shape.T_base_shape * vertex);
        box.extend(vertices.back());
      }
      centre_ = to_vec4(box.center());
      for (const Eigen::Vector3d& vertex : vertices) vertices_.push_back(to_vec4(vertex));
      for (const Eigen::Vector3d& vertex : vertices)
        radius_ = std::max(radius_, (vertex - box.center()).norm());
      for (const auto& [i, j, k] : shape.triangles) {
        const auto at = [&](int n) { return vertices[static_cast<std::size_t>(n)]; };
        const double area2 = (at(j) - at(i)).cross(at(k) - at(i)).norm();
        if (area2 > 1e-12 * radius_ * radius_) faces_.emplace_back(at(i), at(j), at(k));
      }
      break;
    }
    case Shape::Kind::DistanceField: {
      field_ = shape.field->data_;
      steepest_ = field_->steepest();
      // Beside its box a point that is off from what is deep inside is nearer than the box is.
      Vec4 middle{};
      for (int a = 0; a < 3; ++a) {
        half_[a] = 0.5 * field_->cell() * field_->last(a) + field_->deepest();
        middle[a] = 0.5 * field_->cell() * (field_->last(a) + 1.0);
      }
      centre_ = transform(T_, middle);
      radius_ = std::sqrt(dot3(half_, half_));
      break;
    }
    case Shape::Kind::Mesh:
    case Shape::Kind::Boxes:
      break;
  }
}

Solid::Solid(std::vector<Triangle> triangles, bool is_closed)
    : kind_(Shape::Kind::Mesh),
      T_(to_frame(Eigen::Isometry3d::Identity())),
      faces_(std::move(triangles)),
      is_closed_(is_closed) {
  Vec4 low = faces_[0].a, high = low;
  const auto for_corners = [&](auto&& visit) {
    for (const Triangle& face : faces_) {
      for (const Vec4& corner : {face.a, face.a + face.ab, face.a + face.ac}) visit(corner);
    }
  };
  for_corners([&](const Vec4& corner) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], corner[i]);
      high[i] = std::max(high[i], corner[i]);
    }
  });
  centre_ = broadcast(0.5) * (low + high);
  double square = 0.0;
  for_corners([&](const Vec4& corner) {
    const Vec4 from = corner - centre_;
    square = std::max(square, dot3(from, from));
  });
  radius_ = std::sqrt(square);
}

SolidDistance Solid::distance(const Vec4& p) const {
  if (is_surface()) {
    const SegmentSolidDistance found =
        surface_distance(p, Vec4{}, std::numeric_limits<double>::infinity());
    return {found.distance, found.gradient};
  }
  if (kind_ == Shape::Kind::ConvexMesh) return mesh_distance(p);
  const Vec4 local = to_local(T_, p);
  SolidDistance result = is_field() ? field_distance(*field_, local) : local_distance(local);
  result.gradient = rotate(T_, result.gradient);
  return result;
}

Vec4 Solid::support(const Vec4& direction) const {
  if (kind_ == Shape::Kind::ConvexMesh) {
    const Vec4* farthest = vertices_.data();
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec4& vertex : vertices_) {
      const double along = dot3(vertex, direction);
      if (along <= most) continue;
      most = along;
      farthest = &vertex;
    }
    return *farthest;
  }
  if (is_surface()) {
    Vec4 farthest = support_of(0, direction);
    for (int piece = 1; piece < pieces(); ++piece) {
      const Vec4 other = support_of(piece, direction);
      if (dot3(other, direction) > dot3(farthest, direction)) farthest = other;
    }
    return farthest;
  }
  const Vec4 d{dot3(T_.x, direction), dot3(T_.y, direction), dot3(T_.z, direction), 0.0};
  const auto side = [](double along, double half) { return along < 0.0 ? -half : half; };
  Vec4 local{};
  switch (kind_) {
    case Shape::Kind::Box:
      for (int i = 0; i < 3; ++i) local[i] = side(d[i], half_[i]);
      break;
    case Shape::Kind::Cylinder: {
      const double aside = std::hypot(d[0], d[1]);
      if (aside > 0.0) local = broadcast(half_[0] / aside) * Vec4{d[0], d[1], 0.0, 0.0};
      local[2] = side(d[2], half_[1]);
      break;
    }
    case Shape::Kind::Capsule:
      local[2] = side(d[2], half_[1]);
      break;
    case Shape::Kind::DistanceField:
      for (int i = 0; i < 3; ++i) local[i] = side(d[i], half_[i]);
      return rotate(T_, local) + centre_;
    default:  // a sphere is its centre
      break;
  }
  return transform(T_, local);
}

Vec4 Solid::support_of(int piece, const Vec4& direction) const {
  if (!is_surface()) return support(direction);
  const Triangle& face = faces_[static_cast<std::size_t>(piece)];
  const double one = dot3(face.ab, direction), other = dot3(face.ac, direction);
  if (one <= 0.0 && other <= 0.0) return face.a;
  return face.a + (one > other ? face.ab : face.ac);
}

SolidDistance Solid::local_distance(const Vec4& p) const {
  const Vec4 x{1.0, 0.0, 0.0, 0.0}, y{0.0, 1.0, 0.0, 0.0}, z{0.0, 0.0, 1.0, 0.0};
  const auto side = [](double v) { return std::copysign(1.0, v); };
  switch (kind_) {
    case Shape::Kind::Sphere:
      return {std::sqrt(dot3(p, p)) - half_[0], unit(p, z)};
    case Shape::Kind::Box: {
      const Vec4 directions[] = {broadcast(side(p[0])) * x, broadcast(side(p[1])) * y,
                                 broadcast(side(p[2])) * z};
      const Vec4 over{std::abs(p[0]) - half_[0], std::abs(p[1]) - half_[1],
                      std::abs(p[2]) - half_[2], 0.0};
      return beyond(over, 3, directions);
    }
    case Shape::Kind::Cylinder: {
      const Vec4 aside{p[0], p[1], 0.0, 0.0};
      const Vec4 directions[] = {unit(aside, x), broadcast(side(p[2])) * z};
      const Vec4 over{std::sqrt(dot3(aside, aside)) - half_[0], std::abs(p[2]) - half_[1], 0.0,
                      0.0};
      return beyond(over, 2, directions);
    }
    case Shape::Kind::Capsule: {
      const Vec4 from{p[0], p[1], p[2] - std::clamp(p[2], -half_[1], half_[1]), 0.0};
      return {std::sqrt(dot3(from, from)) - half_[0], unit(from, x)};
    }
    default:
      break;
  }
  return {p[2], z};  // of a half-space
}

SolidDistance Solid::mesh_distance(const Vec4& p) const {
  double deepest = -std::numeric_limits<double>::infinity();
  const Triangle* nearest = nullptr;
  for (const Triangle& face : faces_) {
    const double above = face.above(p);
    if (above <= deepest) continue;
    deepest = above;
    nearest = &face;
  }
  if (!(deepest > 0.0)) return {deepest, nearest->normal};
  // The nearest point lies on a face that looks at p (Ericson, "Real-Time Collision Detection",
  // 5.1.5, by the triangle's inside or the nearest of its edges).
  double least = std::numeric_limits<double>::infinity();
  Vec4 from{};
  const auto try_point = [&](const Vec4& q) {
    const Vec4 gap = p - q;
    const double square = dot3(gap, gap);
    if (square >= least) return;
    least = square;
    from = gap;
  };
  const auto try_edge = [&](const Vec4& a, const Vec4& ab, double ab2) {
    try_point(a + broadcast(std::clamp(dot3(p - a, ab) / ab2, 0.0, 1.0)) * ab);
  };
  for (const Triangle& face : faces_) {
    const double above = face.above(p);
    // Triangles of one flat face differ by rounding, those of a mesh that is not quite convex more.
    if (!(above > -kUneven * radius_) || above * std::abs(above) >= least) continue;
    if (face.is_below(p)) {
      try_point(p - broadcast(above) * face.normal);
      continue;
    }
    const Vec4 bc = face.ac - face.ab;
    try_edge(face.a, face.ab, face.ab2);
    try_edge(face.a, face.ac, face.ac2);
    try_edge(face.a + face.ab, bc, dot3(bc, bc));
  }
  const double distance = std::sqrt(least);
  return {distance, distance > 1e-12 ? broadcast(1.0 / distance) * from : nearest->normal};
}

SegmentSolidDistance Solid::surface_distance(const Vec4& middle, const Vec4& half,
                                             double than) const {
  SegmentSolidDistance nearest{std::numeric_limits<double>::infinity(), middle, {}};
  for (const Triangle& face : faces_) {
    if (distance_to_segment(face.centre, middle, half) - face.radius >= than) continue;
    const SegmentSolidDistance found = distance_to(face, middle, half, than);
    // Of triangles that share the nearest edge or corner the one that faces it most says which side
    // of the surface it is on.
    const double margin = kPrecise + 1e-9 * std::abs(found.distance);
    if (found.distance < nearest.distance - margin ||
        (found.distance < nearest.distance + margin &&
         std::abs(found.facing) > std::abs(nearest.facing))) {
      nearest = found;
      than = std::min(than, found.distance + margin);
    }
  }
  if (!is_closed_) nearest.facing = 1.0;
  return nearest;
}

SegmentSolidDistance Solid::distance(const Vec4& middle, const Vec4& half, double than) const {
  if (is_surface()) return surface_distance(middle, half, than);
  if (is_field()) {
    const Vec4 along{dot3(T_.x, half), dot3(T_.y, half), dot3(T_.z, half), 0.0};
    SegmentSolidDistance found = field_distance(*field_, to_local(T_, middle), along, than);
    found.point = transform(T_, found.point);
    found.gradient = rotate(T_, found.gradient);
    return found;
  }
  const auto at = [&](double t) { return middle + broadcast(t) * half; };
  const auto ending = [&](double t, const SolidDistance& found) -> SegmentSolidDistance {
    return {found.distance, at(t), found.gradient};
  };
  if (!(dot3(half, half) > 0.0)) return ending(0.0, distance(middle));
  if (kind_ == Shape::Kind::Sphere || kind_ == Shape::Kind::Capsule) {
    const SegmentDistance found = segment_distance(middle, half, T_.p, half_axis());
    const SolidDistance there = distance(at(found.t1));
    return {found.distance - half_[0], at(found.t1), there.gradient};
  }
  // The distance from a convex solid is convex along the segment: between two points that it falls
  // from and rises to it lies above both tangents, and the next look is where they meet.
  double low = -1.0, high = 1.0;
  SolidDistance below = distance(at(low)), above = distance(at(high));
  double falls = dot3(below.gradient, half), rises = dot3(above.gradient, half);
  if (falls >= 0.0) return ending(low, below);
  if (rises <= 0.0) return ending(high, above);
  for (int step = 0; step < kMostTurns; ++step) {
    const double meet =
        (above.distance - below.distance + falls * low - rises * high) / (falls - rises);
    const double floor = below.distance + falls * (meet - low);
    const double best = std::min(below.distance, above.distance);
    if (best - floor < kPrecise || floor >= than) break;
    // Tangents of what is curved meet nearer to one end than to the minimum: halve now and then.
    const double width = high - low;
    const double t = step % 3 == 2 ? 0.5 * (low + high)
                                   : std::clamp(meet, low + 1e-3 * width, high - 1e-3 * width);
    const SolidDistance found = distance(at(t));
    const double slope = dot3(found.gradient, half);
    if (slope == 0.0) return ending(t, found);
    if (slope < 0.0) {
      low = t;
      below = found;
      falls = slope;
    } else {
      high = t;
      above = found;
      rises = slope;
    }
  }
  // Where the distance has a kink the least changes by that mean of both sides' gradients along
  // which it is level.
  const double share = rises / (rises - falls);
  SegmentSolidDistance result =
      below.distance < above.distance ? ending(low, below) : ending(high, above);
  result.gradient = broadcast(share) * below.gradient + broadcast(1.0 - share) * above.gradient;
  return result;
}

}  // namespace pdoik::detail
