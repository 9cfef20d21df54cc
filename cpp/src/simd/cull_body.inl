// The coarse test for one instruction set: included by cull_*.cpp with Lanes defined there.
// Lanes: kWidth, load, set, and less(a, b) as a bit mask.

static inline int cull_with_lanes(const ObstacleArrays& o, const HullQuery* hulls, int hull_count,
                                  NearPair* pairs) {
  int count = 0;
  for (int h = 0; h < hull_count; ++h) {
    const HullQuery& hull = hulls[h];
    const auto cx = Lanes::set(hull.centre[0]), cy = Lanes::set(hull.centre[1]),
               cz = Lanes::set(hull.centre[2]);
    const auto hx = Lanes::set(hull.half[0]), hy = Lanes::set(hull.half[1]),
               hz = Lanes::set(hull.half[2]);
    const auto semi_major = Lanes::set(hull.semi_major);
    const auto half_squared = Lanes::set(hull.half[0] * hull.half[0] + hull.half[1] * hull.half[1] +
                                         hull.half[2] * hull.half[2]);
    for (int j = 0; j < o.padded_count; j += Lanes::kWidth) {
      const auto dx = Lanes::load(o.x + j) - cx, dy = Lanes::load(o.y + j) - cy,
                 dz = Lanes::load(o.z + j) - cz;
      const auto A = semi_major + Lanes::load(o.radius + j);
      const auto A2 = A * A;
      const auto d2 = dx * dx + dy * dy + dz * dz;
      const auto dh = dx * hx + dy * hy + dz * hz;
      // Within A of the centre, which padding is not; and foci farther apart than 2 A leave nothing
      // inside.
      unsigned mask = Lanes::less((d2 - A2 + half_squared) * A2, dh * dh) & Lanes::less(d2, A2) &
                      Lanes::less(half_squared, A2);
      while (mask != 0) {
        pairs[count++] = {h, j + __builtin_ctz(mask)};
        mask &= mask - 1;
      }
    }
  }
  return count;
}
