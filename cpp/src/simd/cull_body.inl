// The coarse test for one instruction set: included by cull_*.cpp with Lanes defined there.
// Lanes: kWidth, load, set, max, root, and less(a, b) as a bit mask.

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

/// Which of the boxes from j on may hold a point inside: those that come within semi_major of the
/// centre, and the ball around which would, as a point of its radius, lie inside. (The half sum of
/// distances to the foci changes no faster than a point moves.) Each step rounds the same way as
/// for points, or nearer.
static inline unsigned boxes_near(const BoxArrays& boxes, int j, const WideHull& hull) {
  const auto lx = Lanes::load(boxes.low[0] + j), ly = Lanes::load(boxes.low[1] + j),
             lz = Lanes::load(boxes.low[2] + j), ux = Lanes::load(boxes.high[0] + j),
             uy = Lanes::load(boxes.high[1] + j), uz = Lanes::load(boxes.high[2] + j);
  const auto off = [&](const auto& low, const auto& high, const auto& c) {
    return Lanes::max(Lanes::max(low - c, c - high), hull.zero);
  };
  const auto ox = off(lx, ux, hull.cx), oy = off(ly, uy, hull.cy), oz = off(lz, uz, hull.cz);
  const auto A = hull.semi_major + Lanes::load(boxes.radius + j);
  const unsigned near = Lanes::less(ox * ox + oy * oy + oz * oz, A * A);
  if (near == 0) return 0;
  const auto half = Lanes::set(0.5F);
  const auto wx = half * (ux - lx), wy = half * (uy - ly), wz = half * (uz - lz);
  const auto dx = half * (ux + lx) - hull.cx, dy = half * (uy + ly) - hull.cy,
             dz = half * (uz + lz) - hull.cz;
  const auto ball =
      A + Lanes::set(1.0001F) * Lanes::root(wx * wx + wy * wy + wz * wz) + Lanes::set(1e-5F) * A;
  const auto ball2 = ball * ball, d2 = dx * dx + dy * dy + dz * dz;
  const auto dh = dx * hull.hx + dy * hull.hy + dz * hull.hz;
  return near & Lanes::less((d2 - ball2 + hull.half_squared) * ball2, dh * dh);
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

/// Calls visit(box) for each of the `count` boxes from `first` on, a multiple of kLanes, that come
/// near and are not before `from`, in order, as long as it returns true. @returns Whether it did.
template <class Visit>
static inline bool for_boxes_near(const BoxArrays& boxes, int first, int count, int from,
                                  const WideHull& hull, Visit&& visit) {
  const int before = from > first ? (from - first) / Lanes::kWidth * Lanes::kWidth : 0;
  for (int j = first + before; j < first + count; j += Lanes::kWidth) {
    for (unsigned near = boxes_near(boxes, j, hull); near != 0; near &= near - 1) {
      const int box = j + __builtin_ctz(near);
      if (box >= from && !visit(box)) return false;
    }
  }
  return true;
}

/// The same through districts, groups and blocks, which pass by what is far.
static int test_in_order(const ObstacleArrays& o, int first_point, const WideHull& hull,
                         PairList& list) {
  const int first_block = first_point / kLanes, first_group = first_block / kLanes;
  int reached = o.padded_count;
  const auto visit_block = [&](int b) {
    const int first = b == first_block ? first_point : b * kLanes, end = (b + 1) * kLanes;
    reached = list.test(o, first, end, hull);
    if (reached < end) return false;
    reached = o.padded_count;
    return true;
  };
  const auto visit_group = [&](int g) {
    return for_boxes_near(o.blocks, g * kLanes, kLanes, first_block, hull, visit_block);
  };
  const auto visit_district = [&](int d) {
    return for_boxes_near(o.groups, d * kLanes, kLanes, first_group, hull, visit_group);
  };
  if (o.groups.padded_count == kLanes)
    visit_district(0);
  else
    for_boxes_near(o.districts, 0, o.districts.padded_count, first_group / kLanes, hull,
                   visit_district);
  return reached;
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

static inline void bound_distances_with_lanes(const ObstacleArrays& o, int first,
                                              const HullQuery& hull, float* bounds) {
  const float hx = hull.half[0], hy = hull.half[1], hz = hull.half[2], A = hull.semi_major;
  const float h2 = hx * hx + hy * hy + hz * hz, A2 = A * A, B2 = A2 - h2;
  const float inverse_h2 = h2 > 0.0F ? 1.0F / h2 : 0.0F, inverse_A2 = 1.0F / A2,
              inverse_B2 = 1.0F / B2;
  for (int k = 0; k < kLanes; ++k) {
    const float dx = o.x[first + k] - hull.centre[0], dy = o.y[first + k] - hull.centre[1],
                dz = o.z[first + k] - hull.centre[2];
    const float d2 = dx * dx + dy * dy + dz * dz, on_half = dx * hx + dy * hy + dz * hz;
    const float along2 = on_half * on_half * inverse_h2;
    const float aside2 = d2 > along2 ? d2 - along2 : 0.0F;
    const float share2 = along2 * inverse_A2 + aside2 * inverse_B2;
    const float outside = share2 > 1.0F ? share2 : 1.0F;
    const float beyond = __builtin_sqrtf(B2 * d2) * (1.0F - 1.0F / __builtin_sqrtf(outside));
    const float a = 1.0F / (A2 + beyond), b = 1.0F / (B2 + beyond);
    // The normal's parts, times how far out the point is along each.
    const float na2 = along2 * a * a, nb2 = aside2 * b * b, length = __builtin_sqrtf(na2 + nb2);
    const float support = __builtin_sqrtf(A2 * na2 + B2 * nb2);
    const float gap = (along2 * a + aside2 * b - support) / (length > 0.0F ? length : 1.0F);
    bounds[k] = (length > 0.0F ? gap : -A) - o.radius[first + k];
  }
}

static inline void capsule_gaps_with_lanes(const ObstacleArrays& o, int first,
                                           const CapsuleQuery* capsules, int count, float* gaps) {
  float least[kLanes];
  for (int k = 0; k < kLanes; ++k) least[k] = 3e38F;
  for (const CapsuleQuery* capsule = capsules; capsule != capsules + count; ++capsule) {
    const CapsuleQuery c = *capsule;
    for (int k = 0; k < kLanes; ++k) {
      const float rx = o.x[first + k] - c.a[0], ry = o.y[first + k] - c.a[1],
                  rz = o.z[first + k] - c.a[2];
      const float along = (rx * c.v[0] + ry * c.v[1] + rz * c.v[2]) * c.inverse;
      const float above = along > 0.0F ? along : 0.0F, t = above < 1.0F ? above : 1.0F;
      const float gx = rx - t * c.v[0], gy = ry - t * c.v[1], gz = rz - t * c.v[2];
      const float gap = __builtin_sqrtf(gx * gx + gy * gy + gz * gz) - c.radius;
      least[k] = gap < least[k] ? gap : least[k];
    }
  }
  for (int k = 0; k < kLanes; ++k) gaps[k] = least[k] - o.radius[first + k];
}
