#include "shapes/convex_field_distance.hpp"

#include <array>
#include <cmath>

#include "common/infinity.hpp"
#include "shapes/field_distance.hpp"

namespace pdoik::detail {
namespace {

/// What is less by no more than this is as good [m].
constexpr double kDescentPrecision = 1e-6;

/// The solid in the field's frame, and the search for its point of the least value.
class Search {
 public:
  Search(const Solid& moving, const Frame& T_base_body, const Solid& field, double than)
      : moving_(moving),
        T_(to_local(field.frame(), T_base_body)),
        field_(field.field()),
        // Beside the box what is solid may come nearer as fast again.
        speed_(std::hypot(field.steepest(), 1.0)),
        steepest_(field.steepest()),
        than_(than) {}

  void run() {
    descend_to_corner();
    if (best_ >= than_ && bound_of_ball() >= than_) return;
    Vec4 low{}, high{};
    for (int a = 0; a < 3; ++a) {
      Vec4 axis{};
      axis[a] = 1.0;
      high[a] = support(axis)[a] / field_.cell() - 0.5;
      low[a] = support(-axis)[a] / field_.cell() - 0.5;
    }
    low_ = low;
    high_ = high;
    // The whole in a cube whose halves, and theirs, end with the field's bricks and cells.
    Cube cube{{}, FieldData::kBrick};
    for (std::size_t a = 0; a < 3; ++a) {
      const int i = static_cast<int>(a);
      cube.first[a] = FieldData::kBrick * static_cast<int>(std::floor(low[i] / FieldData::kBrick));
      while (cube.first[a] + cube.size < high[i] && cube.size < kLargest) cube.size *= 2;
    }
    look(cube);
  }

  double least() const { return best_; }
  const Vec4& point() const { return point_; }
  const Vec4& gradient() const { return gradient_; }

 private:
  /// Cells from `first` on along each axis.
  struct Cube {
    std::array<int, 3> first;
    int size;
  };
  static constexpr int kLargest = 1 << 28;

  double bound() const { return std::min(best_ - kDescentPrecision, than_); }
  Vec4 support(const Vec4& direction) const {
    const Vec4 local{dot3(T_.x, direction), dot3(T_.y, direction), dot3(T_.z, direction), 0.0};
    return transform(T_, moving_.support(local));
  }
  /// The signed distance of a place from the solid [m].
  SolidDistance from_solid(const Vec4& p) const {
    SolidDistance found = moving_.distance(to_local(T_, p));
    found.gradient = rotate(T_, found.gradient);
    return found;
  }
  double bound_of_ball() const {
    return field_distance(field_, transform(T_, moving_.centre())).distance -
           speed_ * moving_.radius();
  }

  /// @returns Whether it is less than all so far.
  bool note(const Vec4& p) {
    const SolidDistance found = field_distance(field_, p);
    if (!(found.distance < best_)) return false;
    best_ = found.distance;
    point_ = p;
    gradient_ = found.gradient;
    return true;
  }

  /// From corner to corner, each the farthest of the solid down the slope at the one before.
  void descend_to_corner() {
    note(transform(T_, moving_.centre()));
    constexpr int kMostCorners = 8;
    for (int n = 0; n < kMostCorners; ++n) {
      if (!(dot3(gradient_, gradient_) > 0.0) || !note(support(-gradient_))) break;
    }
    descend();
  }

  /// Down the slope from the point of the least value so far, within the solid.
  void descend() {
    constexpr int kMostDescents = 60;
    double step = field_.cell();
    const double shortest = 1e-4 * field_.cell();
    for (int n = 0; n < kMostDescents && step > shortest; ++n) {
      const double slope = std::sqrt(dot3(gradient_, gradient_));
      if (!(slope > 0.0)) return;
      step =
          note(pulled_in(point_ - broadcast(step / slope) * gradient_)) ? 1.5 * step : 0.4 * step;
    }
  }

  Vec4 pulled_in(const Vec4& p) const {
    const SolidDistance off = from_solid(p);
    return off.distance > 0.0 ? p - broadcast(off.distance) * off.gradient : p;
  }

  /// Whether all of it is in the box of the field's values.
  bool is_within(const Cube& cube) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (cube.first[a] < 0 || cube.first[a] + cube.size > field_.counts()[a] - 1) return false;
    }
    return true;
  }

  /// Whether nothing of the solid in a brick is nearer than the nearest, by what its values are
  /// about.
  bool is_above(const Cube& cube) const {
    const Brick& brick = field_.brick_of(cube.first[0], cube.first[1], cube.first[2]);
    if (static_cast<double>(brick.least) >= bound()) return true;
    const Vec4 slope{static_cast<double>(brick.slope[0]), static_cast<double>(brick.slope[1]),
                     static_cast<double>(brick.slope[2]), 0.0};
    if (!(dot3(slope, slope) > 0.0)) return false;
    const Vec4 lowest = broadcast(1.0 / field_.cell()) * support(-slope) - Vec4{0.5, 0.5, 0.5, 0.0};
    return FieldData::evenly(brick, cube.first, lowest) - static_cast<double>(brick.off) >= bound();
  }

  /// A cell's least value is that of a corner: from each of less, as near as the solid comes to it,
  /// and from where it comes nearest to the middle.
  void look_at_cell(const Cube& cube, bool within) {
    const auto [i, j, k] = cube.first;
    const auto try_place = [&](const Vec4& place) {
      if (note(pulled_in(broadcast(field_.cell()) * place))) descend();
    };
    for (int n = 0; within && n < 8; ++n) {
      const int x = n >> 2 & 1, y = n >> 1 & 1, z = n & 1;
      if (static_cast<double>(*field_.at(i + x, j + y, k + z)) < bound())
        try_place(Vec4{i + x + 0.5, j + y + 0.5, k + z + 0.5, 0.0});
    }
    try_place(Vec4{i + 1.0, j + 1.0, k + 1.0, 0.0});
  }

  void look(const Cube& cube) {
    Vec4 middle{};
    for (std::size_t a = 0; a < 3; ++a) {
      const int i = static_cast<int>(a);
      if (cube.first[a] > high_[i] || cube.first[a] + cube.size < low_[i]) return;
      middle[i] = field_.cell() * (cube.first[a] + 0.5 * cube.size + 0.5);
    }
    const double radius = 0.5 * std::sqrt(3.0) * field_.cell() * cube.size;
    const bool within = is_within(cube);
    if (within && cube.size == FieldData::kBrick && is_above(cube)) return;
    const double speed = within ? steepest_ : speed_;
    if (field_distance(field_, middle).distance - speed * radius >= bound()) return;
    const SolidDistance off = from_solid(middle);
    if (off.distance > radius) return;
    if (cube.size == 1) {
      look_at_cell(cube, within);
      return;
    }
    const int half = cube.size / 2;
    for (int n = 0; n < 8; ++n) {
      Cube part{cube.first, half};
      for (std::size_t a = 0; a < 3; ++a)
        part.first[a] += (static_cast<unsigned>(n) >> a & 1U) != 0 ? half : 0;
      look(part);
    }
  }

  const Solid& moving_;
  Frame T_;
  const FieldData& field_;
  double speed_, steepest_, than_;
  double best_ = kInfinity;
  Vec4 point_{}, gradient_{}, low_{}, high_{};
};

}  // namespace

ConvexDistance convex_field_distance(const Solid& moving, const Frame& T_base_body,
                                     const Solid& field, double than) {
  if (moving.rounding() > 0.0) {
    const SegmentSolidDistance found =
        field.distance(transform(T_base_body, moving.centre()),
                       rotate(T_base_body, moving.half_axis()), than + moving.rounding());
    return {found.distance - moving.rounding(), found.point, found.gradient};
  }
  Search search(moving, T_base_body, field, than);
  search.run();
  const Frame& T = field.frame();
  return {search.least(), transform(T, search.point()), rotate(T, search.gradient())};
}

}  // namespace pdoik::detail
