// The coarse test for one instruction set: included by cull_*.cpp with Lanes defined there.
// Lanes: kWidth, load, set, max, and less(a, b) as a bit mask.

/// A hull in every lane.
struct WideHull {
  decltype(Lanes::set(0.0F)) cx, cy, cz, hx, hy, hz, semi_major, half_squared, zero;
};

static inline WideHull widen(const HullQuery& hull) {
  return {Lanes::set(hull.centre[0]),
          Lanes::set(hull.centre[1]),
          Lanes::set(hull.centre[2]),
          Lanes::set(hull.half[0]),
          Lanes::set(hull.half[1]),
          Lanes::set(hull.half[2]),
          Lanes::set(hull.semi_major),
          Lanes::set(hull.half[0] * hull.half[0] + hull.half[1] * hull.half[1] +
                     hull.half[2] * hull.half[2]),
          Lanes::set(0.0F)};
}

/// Which of the points from j on lie inside.
static inline unsigned points_inside(const ObstacleArrays& o, int j, const WideHull& hull) {
  const auto dx = Lanes::load(o.x + j) - hull.cx, dy = Lanes::load(o.y + j) - hull.cy,
             dz = Lanes::load(o.z + j) - hull.cz;
  const auto A = hull.semi_major + Lanes::load(o.radius + j);
  const auto A2 = A * A;
  const auto d2 = dx * dx + dy * dy + dz * dz;
  const auto dh = dx * hull.hx + dy * hull.hy + dz * hull.hz;
  // Within A of the centre, which padding is not; and foci farther apart than 2 A leave nothing
  // inside.
  return Lanes::less((d2 - A2 + hull.half_squared) * A2, dh * dh) & Lanes::less(d2, A2) &
         Lanes::less(hull.half_squared, A2);
}

/// Which of the boxes from j on come within semi_major of the centre: all that hold a point inside
/// do, since each step rounds the same way or nearer.
static inline unsigned boxes_near(const BoxArrays& boxes, int j, const WideHull& hull) {
  const auto off = [&](int axis, const auto& c) {
    return Lanes::max(
        Lanes::max(Lanes::load(boxes.low[axis] + j) - c, c - Lanes::load(boxes.high[axis] + j)),
        hull.zero);
  };
  const auto dx = off(0, hull.cx), dy = off(1, hull.cy), dz = off(2, hull.cz);
  const auto A = hull.semi_major + Lanes::load(boxes.radius + j);
  return Lanes::less(dx * dx + dy * dy + dz * dz, A * A);
}

/// The pairs of one hull, and where there was no room for more of them.
struct PairList {
  NearPair* pairs;
  int count, last_start, hull;

  /// Add those of the points from `first` on that lie inside. Returns where the room ended, or end.
  inline int test(const ObstacleArrays& o, int first, int end, const WideHull& wide) {
    for (int j = first; j < end; j += Lanes::kWidth) {
      unsigned mask = points_inside(o, j, wide);
      if (mask == 0) continue;
      if (count > last_start) return j;
      while (mask != 0) {
        pairs[count++] = {hull, j + __builtin_ctz(mask)};
        mask &= mask - 1;
      }
    }
    return end;
  }
};

/// The same through groups and blocks, which pass by what is far.
static int test_in_order(const ObstacleArrays& o, int first_point, const WideHull& hull,
                         PairList& list) {
  const int first_block = first_point / kLanes, first_group = first_block / kLanes;
  for (int g0 = first_group / Lanes::kWidth * Lanes::kWidth; g0 < o.groups.padded_count;
       g0 += Lanes::kWidth) {
    for (unsigned groups = boxes_near(o.groups, g0, hull); groups != 0; groups &= groups - 1) {
      const int g = g0 + __builtin_ctz(groups);
      if (g < first_group) continue;
      for (int b0 = g * kLanes; b0 < (g + 1) * kLanes; b0 += Lanes::kWidth) {
        for (unsigned blocks = boxes_near(o.blocks, b0, hull); blocks != 0; blocks &= blocks - 1) {
          const int b = b0 + __builtin_ctz(blocks);
          if (b < first_block) continue;
          const int first = b == first_block ? first_point : b * kLanes, end = (b + 1) * kLanes;
          const int reached = list.test(o, first, end, hull);
          if (reached < end) return reached;
        }
      }
    }
  }
  return o.padded_count;
}

static inline int cull_with_lanes(const ObstacleArrays& o, const HullQuery* hulls, int hull_count,
                                  NearPair* pairs, int capacity, CullCursor& at) {
  const ObstacleArrays points = o;  // which no pair written can change
  PairList list{pairs, 0, capacity - Lanes::kWidth, at.hull};
  for (int first = at.point; list.hull < hull_count; ++list.hull, first = 0) {
    const WideHull wide = widen(hulls[list.hull]);
    const int reached = points.groups.padded_count == 0
                            ? list.test(points, first, points.padded_count, wide)
                            : test_in_order(points, first, wide, list);
    if (reached < points.padded_count) {
      at = {list.hull, reached};
      return list.count;
    }
  }
  at = {hull_count, 0};
  return list.count;
}
