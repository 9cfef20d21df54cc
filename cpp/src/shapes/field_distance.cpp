#include "shapes/field_distance.hpp"

#include <array>
#include <cmath>

#include "common/infinity.hpp"

namespace pdoik::detail {
namespace {

/// A segment's least distance is found to this [m].
constexpr double kCellPrecision = 1e-6;

using Cell = std::array<int, 3>;
using Corners = std::array<double, 8>;  ///< of a cell: x slowest, z fastest

double mix(double a, double b, double t) { return a + t * (b - a); }

/// The cell that is looked up for one of these, which may be beside the grid.
Cell looked_up(const FieldData& field, const Cell& cell) {
  Cell in;
  for (std::size_t a = 0; a < 3; ++a) in[a] = std::clamp(cell[a], 0, field.counts()[a] - 2);
  return in;
}

Corners corners_of(const FieldData& field, const Cell& cell) {
  const float* const v = field.at(cell[0], cell[1], cell[2]);
  const std::ptrdiff_t x = field.stride_x(), y = field.stride_y();
  return {static_cast<double>(v[0]),     static_cast<double>(v[1]),
          static_cast<double>(v[y]),     static_cast<double>(v[y + 1]),
          static_cast<double>(v[x]),     static_cast<double>(v[x + 1]),
          static_cast<double>(v[x + y]), static_cast<double>(v[x + y + 1])};
}

double interpolated(const Corners& c, double x, double y, double z) {
  return mix(mix(mix(c[0], c[1], z), mix(c[2], c[3], z), y),
             mix(mix(c[4], c[5], z), mix(c[6], c[7], z), y), x);
}

/// The gradient per cell.
Vec4 slope_of(const Corners& c, const Vec4& at) {
  const double x = at[0], y = at[1], z = at[2];
  const auto face = [&](double a, double b, double d, double e, double s, double t) {
    return mix(mix(a, b, t), mix(d, e, t), s);
  };
  return Vec4{face(c[4] - c[0], c[5] - c[1], c[6] - c[2], c[7] - c[3], y, z),
              face(c[2] - c[0], c[3] - c[1], c[6] - c[4], c[7] - c[5], x, z),
              face(c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6], x, y), 0.0};
}

/// A place in cells, and the nearest one of the values' box.
struct Place {
  Place(const FieldData& field, const Vec4& at_in) : at(at_in), inside(at_in) {
    for (int a = 0; a < 3; ++a) {
      inside[a] = std::min(std::max(0.0, at[a]), field.last(a));  // of no number 0
      cell[static_cast<std::size_t>(a)] =
          std::min(static_cast<int>(inside[a]), field.counts()[static_cast<std::size_t>(a)] - 2);
    }
    within = inside - Vec4{static_cast<double>(cell[0]), static_cast<double>(cell[1]),
                           static_cast<double>(cell[2]), 0.0};
  }
  Vec4 at, inside;
  Cell cell;
  Vec4 within;  ///< the cell
};

/// What is so far from the box, at a value where it is nearest; see DistanceField.
double beside(double value, double off) {
  return value > 0.0 ? std::sqrt(value * value + off * off) : value + off;
}

double value_at(const FieldData& field, const Vec4& at) {
  const Place place(field, at);
  const double value = interpolated(corners_of(field, place.cell), place.within[0], place.within[1],
                                    place.within[2]);
  const Vec4 off = place.at - place.inside;
  const double off2 = dot3(off, off);  // or no number
  return off2 > 0.0 ? beside(value, field.cell() * std::sqrt(off2)) : value + off2;
}

Vec4 to_cells(const FieldData& field, const Vec4& p) {
  return broadcast(1.0 / field.cell()) * p - Vec4{0.5, 0.5, 0.5, 0.0};
}

SolidDistance at_place(const FieldData& field, const Vec4& at) {
  const Place place(field, at);
  const Corners corners = corners_of(field, place.cell);
  const double value = interpolated(corners, place.within[0], place.within[1], place.within[2]);
  Vec4 gradient = broadcast(1.0 / field.cell()) * slope_of(corners, place.within);
  const Vec4 off = broadcast(field.cell()) * (place.at - place.inside);
  const double off2 = dot3(off, off);
  if (!(off2 > 0.0)) return {value + off2, gradient};
  for (int a = 0; a < 3; ++a) {
    if (off[a] != 0.0) gradient[a] = 0.0;
  }
  const double length = std::sqrt(off2), distance = beside(value, length);
  gradient = value > 0.0 ? broadcast(1.0 / distance) * (broadcast(value) * gradient + off)
                         : gradient + broadcast(1.0 / length) * off;
  return {distance, gradient};
}

/// A cubic on [0, 1] by its Bernstein coefficients, which it lies between.
struct Cubic {
  /// Of a cell's values from one place in it to another.
  Cubic(const Corners& c, const Vec4& from, const Vec4& to) {
    const auto value = [&](const Vec4& x, const Vec4& y, const Vec4& z) {
      return interpolated(c, x[0], y[1], z[2]);
    };
    b[0] = value(from, from, from);
    b[1] = (value(to, from, from) + value(from, to, from) + value(from, from, to)) / 3.0;
    b[2] = (value(from, to, to) + value(to, from, to) + value(to, to, from)) / 3.0;
    b[3] = value(to, to, to);
  }
  double floor() const { return std::min(std::min(b[0], b[1]), std::min(b[2], b[3])); }
  double operator()(double t) const {
    const double s = 1.0 - t;
    return s * s * (s * b[0] + 3.0 * t * b[1]) + t * t * (3.0 * s * b[2] + t * b[3]);
  }
  double slope(double t) const {
    const double s = 1.0 - t;
    return 3.0 * (s * s * (b[1] - b[0]) + 2.0 * s * t * (b[2] - b[1]) + t * t * (b[3] - b[2]));
  }
  /// Where it is least.
  double lowest() const {
    double best = b[3] < b[0] ? 1.0 : 0.0, least = std::min(b[0], b[3]);
    if (!(std::min(b[1], b[2]) < least)) return best;
    // Its slope's roots, from the one that does not cancel.
    const double d0 = b[1] - b[0], d1 = b[2] - b[1], d2 = b[3] - b[2];
    const double A = d0 - 2.0 * d1 + d2, B = d1 - d0, square = B * B - A * d0;
    if (square < 0.0) return best;
    const double q = -(B + std::copysign(std::sqrt(square), B));
    for (const double t : {A != 0.0 ? q / A : -1.0, q != 0.0 ? d0 / q : -1.0}) {
      if (!(t > 0.0 && t < 1.0) || !((*this)(t) < least)) continue;
      least = (*this)(t);
      best = t;
    }
    return best;
  }
  double b[4];
};

/// A walk along a segment from cell to cell, by what may be nearer than the nearest so far.
class Walk {
 public:
  Walk(const FieldData& field, const Vec4& middle, const Vec4& half, double than)
      : field_(field),
        middle_(middle),
        half_(half),
        than_(than),
        speed_((is_within(at(-1.0)) && is_within(at(1.0)) ? field.steepest()
                                                          : std::hypot(field.steepest(), 1.0)) *
               field.cell() * std::sqrt(dot3(half, half))) {}

  /// @returns t of the nearest point.
  double nearest() {
    if (note(0.0) - speed_ >= than_) return best_t_;
    note(1.0);
    double t = -1.0, value = note(t);
    start(t);
    while (t < 1.0) {
      // A cell and more may be passed over by how fast values change.
      const double skip = (value - least()) / speed_;
      if (skip > 1.0 / std::sqrt(dot3(half_, half_))) {
        t += skip;
        if (t >= 1.0) break;
        start(t);
        value = note(t);
        continue;
      }
      if (const double end = end_of_brick(t); end > t) {
        t = end;
        if (t >= 1.0) break;
        start(t);
        value = note(t);
        continue;
      }
      const double end = std::min(next_[nearest_plane()], 1.0);
      if (end > t) {
        value = look_at_cell(t, end);
        t = end;
      }
      step();
    }
    return best_t_;
  }

 private:
  double least() const { return std::min(best_, than_); }
  Vec4 at(double t) const { return middle_ + broadcast(t) * half_; }
  bool is_within(const Vec4& place) const {
    for (int a = 0; a < 3; ++a) {
      if (!(place[a] >= 0.0 && place[a] <= field_.last(a))) return false;
    }
    return true;
  }
  double note(double t) {
    const double value = value_at(field_, at(t));
    note(t, value);
    return value;
  }
  void note(double t, double value) {
    if (!(value < best_)) return;
    best_ = value;
    best_t_ = t;
  }

  /// Which cell the segment goes on in from t, and when it leaves it along each axis. Before the
  /// first value along an axis, and after the last, is one cell each.
  void start(double t) {
    const Vec4 place = at(t);
    for (std::size_t a = 0; a < 3; ++a) {
      const int i = static_cast<int>(a);
      const double h = half_[i], last = field_.last(i);
      const double inside = std::clamp(place[i], -1.0, last + 1.0);
      cell_[a] =
          std::clamp(static_cast<int>(h < 0.0 ? std::ceil(inside) - 1.0 : std::floor(inside)), -1,
                     field_.counts()[a] - 1);
      next_[a] = plane(a);
      // Rounding: it is there already.
      while (next_[a] <= t) {
        cell_[a] += h < 0.0 ? -1 : 1;
        next_[a] = plane(a);
      }
    }
  }
  /// When it leaves its cell along an axis.
  double plane(std::size_t a) const {
    const int i = static_cast<int>(a);
    const double h = half_[i];
    if (h > 0.0 && cell_[a] < field_.counts()[a] - 1) return (cell_[a] + 1 - middle_[i]) / h;
    if (h < 0.0 && cell_[a] >= 0) return (cell_[a] - middle_[i]) / h;
    return kInfinity;
  }
  std::size_t nearest_plane() const {
    const std::size_t one = next_[1] < next_[0] ? 1 : 0;
    return next_[2] < next_[one] ? 2 : one;
  }
  void step() {
    const std::size_t a = nearest_plane();
    if (next_[a] == kInfinity) return;
    cell_[a] += half_[static_cast<int>(a)] < 0.0 ? -1 : 1;
    next_[a] = plane(a);
  }
  bool is_inside() const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (cell_[a] < 0 || cell_[a] > field_.counts()[a] - 2) return false;
    }
    return true;
  }

  /// When it leaves the brick that it is in, if nothing of it in there may be nearer; else t.
  double end_of_brick(double t) {
    if (!is_inside()) return t;
    constexpr int kBrick = FieldData::kBrick;
    const Cell first{cell_[0] / kBrick * kBrick, cell_[1] / kBrick * kBrick,
                     cell_[2] / kBrick * kBrick};
    if (first == told_) return t;
    const Brick& brick = field_.brick_of(cell_[0], cell_[1], cell_[2]);
    double end = 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      const int i = static_cast<int>(a);
      const double h = half_[i];
      if (h == 0.0) continue;
      const int side = h > 0.0 ? std::min(first[a] + kBrick, field_.counts()[a] - 1) : first[a];
      end = std::min(end, (side - middle_[i]) / h);
    }
    const double off = static_cast<double>(brick.off) + least() - kCellPrecision;
    if (static_cast<double>(brick.least) >= least() ||
        (FieldData::evenly(brick, first, at(t)) >= off &&
         FieldData::evenly(brick, first, at(end)) >= off))
      return std::max(end, t);
    told_ = first;
    return t;
  }

  /// The least between two t of one cell. @returns The value at the end.
  double look_at_cell(double from, double to) {
    const Cell cell = looked_up(field_, cell_);
    const Corners corners = corners_of(field_, cell);
    const Vec4 first{static_cast<double>(cell[0]), static_cast<double>(cell[1]),
                     static_cast<double>(cell[2]), 0.0};
    Vec4 begin = at(from), end = at(to), off_begin{}, off_end{};
    for (int a = 0; a < 3; ++a) {
      const std::size_t axis = static_cast<std::size_t>(a);
      const double in_begin = std::clamp(begin[a], first[a], first[a] + 1.0),
                   in_end = std::clamp(end[a], first[a], first[a] + 1.0);
      if (cell[axis] != cell_[axis]) {
        off_begin[a] = begin[a] - in_begin;
        off_end[a] = end[a] - in_end;
      }
      begin[a] = in_begin;
      end[a] = in_end;
    }
    const Cubic cubic(corners, begin - first, end - first);
    double t = 0.0, value = cubic.b[3];
    if (is_inside()) {
      if (cubic.floor() < least()) {
        t = cubic.lowest();
        note(mix(from, to, t), cubic(t));
      }
      return value;
    }
    const Vec4 along = off_end - off_begin;
    const double h = field_.cell();
    const auto off = [&](double s) {
      const Vec4 v = off_begin + broadcast(s) * along;
      return h * std::sqrt(dot3(v, v));
    };
    const auto distance = [&](double s) { return beside(cubic(s), off(s)); };
    value = distance(1.0);
    const double along2 = dot3(along, along);
    const double nearest =
        along2 > 0.0 ? std::clamp(-dot3(off_begin, along) / along2, 0.0, 1.0) : 0.0;
    if (!(beside(cubic.floor(), off(nearest)) < least())) return value;
    const auto falls = [&](double s) {
      const double v = cubic(s), o = off(s), dv = cubic.slope(s);
      const Vec4 place = off_begin + broadcast(s) * along;
      const double oo = h * h * dot3(place, along);  // half the change of o^2
      return v > 0.0 ? v * dv + oo < 0.0 : o > 0.0 ? dv + oo / o < 0.0 : dv < 0.0;
    };
    double low = 0.0, high = 1.0;
    if (!falls(low)) {
      t = 0.0;
    } else if (falls(high)) {
      t = 1.0;
    } else {
      constexpr int kHalvings = 40;
      for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (low + high);
        (falls(middle) ? low : high) = middle;
      }
      t = low;
    }
    for (const double s : {0.0, t, 1.0}) note(mix(from, to, s), distance(s));
    return value;
  }

  const FieldData& field_;
  Vec4 middle_, half_;
  double than_;
  double speed_;  ///< what the distance changes by at most, per t
  double best_ = kInfinity, best_t_ = 0.0;
  Cell cell_{}, told_{-1, -1, -1};
  std::array<double, 3> next_{};
};

}  // namespace

SolidDistance field_distance(const FieldData& field, const Vec4& p) {
  return at_place(field, to_cells(field, p));
}

SegmentSolidDistance field_distance(const FieldData& field, const Vec4& middle, const Vec4& half,
                                    double than) {
  const Vec4 m = to_cells(field, middle), h = broadcast(1.0 / field.cell()) * half;
  const double length = std::sqrt(dot3(h, h));
  if (!(length > 0.0)) {
    const SolidDistance found = at_place(field, m);
    return {found.distance, middle, found.gradient};
  }
  const double t = Walk(field, m, h, than).nearest();
  SolidDistance found = at_place(field, m + broadcast(t) * h);
  // On the border of two cells the gradient is either's: the least changes by that mean of both
  // along which it is level.
  const double aside = 1e-7 / length;
  if (t - aside > -1.0 && t + aside < 1.0) {
    const Vec4 before = at_place(field, m + broadcast(t - aside) * h).gradient,
               after = at_place(field, m + broadcast(t + aside) * h).gradient;
    const double falls = dot3(before, half), rises = dot3(after, half);
    if (falls < 0.0 && rises > 0.0) {
      const double share = rises / (rises - falls);
      found.gradient = broadcast(share) * before + broadcast(1.0 - share) * after;
    }
  }
  return {found.distance, middle + broadcast(t) * half, found.gradient};
}

}  // namespace pdoik::detail
