// Searches in lanes for one instruction set: included by lanes_*.cpp, where kWidth, Row, Mask,
// root() and bits() are defined.

inline Row all(double v) { return v - Row{}; }
inline Row load(const double* p) { return *reinterpret_cast<const Row*>(p); }
inline void store(double* p, const Row& v) { *reinterpret_cast<Row*>(p) = v; }
inline Row choose(const Mask& m, const Row& a, const Row& b) { return m ? a : b; }
inline Row least(const Row& a, const Row& b) { return choose(a < b, a, b); }
inline Row most(const Row& a, const Row& b) { return choose(a > b, a, b); }
inline Row size_of(const Row& v) { return choose(v < all(0.0), -v, v); }
inline bool any(const Mask& m) { return bits(m) != 0; }

struct Rows3 {
  Row x, y, z;
};
inline Rows3 operator+(const Rows3& a, const Rows3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Rows3 operator-(const Rows3& a, const Rows3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Rows3 operator*(const Row& s, const Rows3& v) { return {s * v.x, s * v.y, s * v.z}; }
inline Row dot(const Rows3& a, const Rows3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Rows3 cross(const Rows3& a, const Rows3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Rows3 choose(const Mask& m, const Rows3& a, const Rows3& b) {
  return {choose(m, a.x, b.x), choose(m, a.y, b.y), choose(m, a.z, b.z)};
}
inline Rows3 load3(const double* p) { return {load(p), load(p + kWidth), load(p + 2 * kWidth)}; }
inline void store3(double* p, const Rows3& v) {
  store(p, v.x);
  store(p + kWidth, v.y);
  store(p + 2 * kWidth, v.z);
}

/// Axes and origin, 12 rows.
struct FrameRows {
  Rows3 x, y, z, p;
};
inline FrameRows load_frame(const double* rows) {
  return {load3(rows), load3(rows + 3 * kWidth), load3(rows + 6 * kWidth),
          load3(rows + 9 * kWidth)};
}
inline Rows3 rotate(const FrameRows& T, const Vec4& v) {
  return all(v[0]) * T.x + all(v[1]) * T.y + all(v[2]) * T.z;
}

/// Sines and cosines by fdlibm's polynomials, to one unit in the last place. Arguments are reduced
/// by pi/2 in three parts, which is exact enough up to kLargestAngle; beyond it each is the C
/// library's.
inline void sine_and_cosine(const Row& angle, Row& sine, Row& cosine) {
  constexpr double kLargestAngle = 1e6, kShift = 6755399441055744.0;  // 1.5 * 2^52
  const Row shifted = angle * all(0.63661977236758134308) + all(kShift),
            turns = shifted - all(kShift);
  const Mask quadrant = Mask(shifted);
  const Row r = ((angle - turns * all(1.57079632673412561417e+00)) -
                 turns * all(6.07710050630396597660e-11)) -
                turns * all(2.02226624879595063154e-21);
  const Row z = r * r;
  const Row s = r + r * z *
                        (all(-1.66666666666666324348e-01) +
                         z * (all(8.33333333332248946124e-03) +
                              z * (all(-1.98412698298579493134e-04) +
                                   z * (all(2.75573137070700676789e-06) +
                                        z * (all(-2.50507602534068634195e-08) +
                                             z * all(1.58969099521155010221e-10))))));
  const Row c = all(1.0) - all(0.5) * z +
                z * z *
                    (all(4.16666666666666019037e-02) +
                     z * (all(-1.38888888888741095749e-03) +
                          z * (all(2.48015872894767294178e-05) +
                               z * (all(-2.75573143513906633035e-07) +
                                    z * (all(2.08757232129817482790e-09) +
                                         z * all(-1.13596475577881948265e-11))))));
  const Mask odd = (quadrant & 1) != 0, sine_below = (quadrant & 2) != 0,
             cosine_below = ((quadrant + 1) & 2) != 0;
  sine = choose(odd, c, s);
  cosine = choose(odd, s, c);
  sine = choose(sine_below, -sine, sine);
  cosine = choose(cosine_below, -cosine, cosine);
  const Mask large = size_of(angle) > all(kLargestAngle);
  if (!any(large)) return;
  for (int k = 0; k < kWidth; ++k) {
    if (large[k] == 0) continue;
    sine[k] = __builtin_sin(angle[k]);
    cosine[k] = __builtin_cos(angle[k]);
  }
}

/// atan2(y, x) for y >= 0 by Cephes' rational approximation.
inline Row angle_of(const Row& y, const Row& x) {
  const Row side = size_of(x);
  const Mask steep = y > side;
  const Row upper = choose(steep, side, y), lower = choose(steep, y, side);
  const Mask beyond = upper > all(0.66) * lower;
  const Row t = choose(beyond, upper - lower, upper) / choose(beyond, upper + lower, lower);
  const Row z = t * t;
  const Row p = (((all(-8.750608600031904122785e-01) * z + all(-1.615753718733365076637e+01)) * z +
                  all(-7.500855792314704667340e+01)) *
                     z +
                 all(-1.228866684490136173410e+02)) *
                    z +
                all(-6.485021904942025371773e+01);
  const Row q =
      ((((z + all(2.485846490142306297962e+01)) * z + all(1.650270098316988542046e+02)) * z +
        all(4.328810604912902668951e+02)) *
           z +
       all(4.853903996359136964868e+02)) *
          z +
      all(1.945506571482613964425e+02);
  Row angle = t + t * (z * (p / q));
  angle = choose(beyond, angle + all(0.78539816339744830962), angle);
  angle = choose(steep, all(1.57079632679489661923) - angle, angle);
  return choose(x < all(0.0), all(3.14159265358979323846) - angle, angle);
}

/// The same where v may lie along one of T's axes, as in most tables of joints.
inline Rows3 rotate_onto(const FrameRows& T, const Vec4& v, int axis) {
  if (axis == 0) return rotate(T, v);
  const Rows3& along = axis == 1 || axis == -1 ? T.x : axis == 2 || axis == -2 ? T.y : T.z;
  if (axis > 0) return along;
  return {-along.x, -along.y, -along.z};
}

/// All bodies' frames from the trial configuration.
inline void roll_out(const LaneProblem& problem) {
  const Row one = all(1.0), zero = Row{};
  double* const frames = problem.frames;
  store3(frames, {one, zero, zero});
  store3(frames + 3 * kWidth, {zero, one, zero});
  store3(frames + 6 * kWidth, {zero, zero, one});
  store3(frames + 9 * kWidth, {zero, zero, zero});
  for (int b = 1; b < problem.bodies; ++b) {
    const RolloutJoint& joint = problem.joints[b];
    const FrameRows parent = load_frame(frames + 12 * kWidth * joint.parent);
    double* const at = frames + 12 * kWidth * b;
    Row q = load(problem.trial + kWidth * joint.dof);
    if (!joint.plain) q = all(joint.multiplier) * q + all(joint.offset);
    const signed char* const onto = problem.onto[b];
    const Rows3 x = rotate_onto(parent, joint.fixed.x, onto[0]);
    const Rows3 y = rotate_onto(parent, joint.fixed.y, onto[1]);
    const Rows3 z = rotate_onto(parent, joint.fixed.z, onto[2]);
    Rows3 p = parent.p;
    if (joint.fixed.p[0] != 0.0) p = p + all(joint.fixed.p[0]) * parent.x;
    if (joint.fixed.p[1] != 0.0) p = p + all(joint.fixed.p[1]) * parent.y;
    if (joint.fixed.p[2] != 0.0) p = p + all(joint.fixed.p[2]) * parent.z;
    store3(at + 6 * kWidth, z);
    if (joint.prismatic) {
      p = p + q * z;
      store3(at, x);
      store3(at + 3 * kWidth, y);
    } else {
      Row s, c;
      sine_and_cosine(q, s, c);
      store3(at, c * x + s * y);
      store3(at + 3 * kWidth, c * y - s * x);
    }
    store3(at + 9 * kWidth, p);
  }
}

/// The rotation vector, given twice its sine's vector and twice its cosine, and what to take at
/// half a turn, where the sine says nothing.
inline Rows3 rotation_vector(const Rows3& sine, const Row& cosine, const Row& small,
                             const Rows3& half_turn) {
  const Row norm = root(dot(sine, sine));
  const Mask plain = norm > all(1e-12);
  const Row scale = choose(plain, angle_of(norm, cosine) / choose(plain, norm, all(1.0)), small);
  const Rows3 result = scale * sine;
  const Mask half = (plain == 0) & (cosine <= all(0.0));
  if (!any(half)) return result;
  const Row length = root(dot(half_turn, half_turn));
  return choose(half, (all(3.14159265358979323846) / length) * half_turn, result);
}

/// Along a target's axes.
inline Rows3 along(const FrameRows& axes, const Rows3& v) {
  return {dot(axes.x, v), dot(axes.y, v), dot(axes.z, v)};
}
inline Rows3 from_axes(const FrameRows& axes, const Rows3& v) {
  return v.x * axes.x + v.y * axes.y + v.z * axes.z;
}
inline Row beyond_slack(const Row& v, const Row& slack) {
  // What is no number stays none.
  return choose(v > slack, v - slack, choose(v < -slack, v + slack, all(0.0) * v));
}
inline Rows3 beyond_slack(const FrameRows& axes, const Rows3& error, const Rows3& slack) {
  const Rows3 e = along(axes, error);
  return from_axes(
      axes, {beyond_slack(e.x, slack.x), beyond_slack(e.y, slack.y), beyond_slack(e.z, slack.z)});
}
/// How that changes when the error changes by d.
inline Rows3 beyond_slack_rate(const FrameRows& axes, const Rows3& d, const Rows3& error,
                               const Rows3& slack) {
  const Rows3 e = along(axes, error), rate = along(axes, d);
  const Row zero = Row{};
  return from_axes(axes, {choose(size_of(e.x) >= slack.x, rate.x, zero),
                          choose(size_of(e.y) >= slack.y, rate.y, zero),
                          choose(size_of(e.z) >= slack.z, rate.z, zero)});
}

/// How the rotation vector e changes when its rotation is followed by a small one w, see
/// rotation_vector_rate of GoalTerm. `k` is the coefficient of e x (e x w).
inline Rows3 rotation_rate(const Rows3& e, const Row& k, const Rows3& w) {
  const Rows3 once = cross(e, w);
  return w - all(0.5) * once + k * cross(e, once);
}
inline Row rotation_rate_coefficient(const Rows3& e) {
  const Row square = dot(e, e), angle = root(square);
  const Mask tiny = angle < all(1e-3);
  Row s, c;
  sine_and_cosine(all(0.5) * angle, s, c);
  const Row safe = choose(tiny, all(1.0), square);
  return choose(tiny, all(1.0 / 12.0) + square * all(1.0 / 720.0),
                (all(1.0) - all(0.5) * angle * c / choose(tiny, all(1.0), s)) / safe);
}

/// A goal's errors, less slack and in full, and where the tip is; its axis where by_axis.
struct GoalRows {
  Rows3 tip, position, rotation, position_full, rotation_full, axis;
};
static_assert(sizeof(GoalRows) == kGoalRows * sizeof(Row));
inline GoalRows load_goal(const double* rows) {
  return {load3(rows),
          load3(rows + 3 * kWidth),
          load3(rows + 6 * kWidth),
          load3(rows + 9 * kWidth),
          load3(rows + 12 * kWidth),
          load3(rows + 15 * kWidth)};
}
inline void store_goal(double* rows, const GoalRows& goal) {
  store3(rows, goal.tip);
  store3(rows + 3 * kWidth, goal.position);
  store3(rows + 6 * kWidth, goal.rotation);
  store3(rows + 9 * kWidth, goal.position_full);
  store3(rows + 12 * kWidth, goal.rotation_full);
  store3(rows + 15 * kWidth, goal.axis);
}

/// Where a goal's target is: carried by its body, if it has one.
inline FrameRows target_of(const LaneProblem& problem, const LaneGoal& goal) {
  if (goal.reference_chain_length == 0) return load_frame(goal.target);
  const FrameRows body = load_frame(problem.frames + 12 * kWidth * goal.reference_chain[0]);
  const FrameRows local = load_frame(goal.in_reference);
  const FrameRows target{from_axes(body, local.x), from_axes(body, local.y),
                         from_axes(body, local.z), from_axes(body, local.p) + body.p};
  store3(goal.target, target.x);
  store3(goal.target + 3 * kWidth, target.y);
  store3(goal.target + 6 * kWidth, target.z);
  store3(goal.target + 9 * kWidth, target.p);
  return target;
}

/// From a tip to what it looks at; how far that is, squared.
inline Rows3 sight_of(const Rows3& off, Row& distance2) {
  const Row d = most(root(dot(off, off)), all(1e-9));
  distance2 = d * d;
  return (all(-1.0) / d) * off;
}

inline GoalRows goal_errors(const LaneProblem& problem, const LaneGoal& goal,
                            const FrameRows& target) {
  const FrameRows body = load_frame(problem.frames + 12 * kWidth * goal.chain[0]);
  GoalRows g{};
  g.tip = rotate(body, goal.T_body_tip.p) + body.p;
  g.position_full = g.position = g.tip - target.p;
  if (goal.turns && !goal.by_axis) {
    const Rows3 x = rotate(body, goal.T_body_tip.x), y = rotate(body, goal.T_body_tip.y),
                z = rotate(body, goal.T_body_tip.z);
    const Rows3 sine = cross(target.x, x) + cross(target.y, y) + cross(target.z, z);
    const Row cosine = dot(target.x, x) + dot(target.y, y) + dot(target.z, z) - all(1.0);
    // At half a turn any target axis's mean with its image lies along the rotation's axis.
    Rows3 half = x + target.x;
    const Rows3 others[] = {y + target.y, z + target.z};
    for (const Rows3& sum : others) half = choose(dot(sum, sum) > dot(half, half), sum, half);
    g.rotation = rotation_vector(sine, cosine, all(0.5), half);
  } else if (goal.by_axis) {
    const Vec4 local = goal.T_body_tip.x * broadcast(goal.axis[0]) +
                       goal.T_body_tip.y * broadcast(goal.axis[1]) +
                       goal.T_body_tip.z * broadcast(goal.axis[2]);
    g.axis = rotate(body, local);
    Row distance2;
    const Rows3 wanted =
        goal.looks ? sight_of(g.position_full, distance2) : rotate(target, goal.axis);
    const Row ax = size_of(wanted.x), ay = size_of(wanted.y), az = size_of(wanted.z);
    const Mask x_least = (ax <= ay) & (ax <= az), y_least = ay <= az;
    const Row zero = Row{}, one = all(1.0);
    const Rows3 aside = choose(x_least, Rows3{one, zero, zero},
                               choose(y_least, Rows3{zero, one, zero}, Rows3{zero, zero, one}));
    g.rotation =
        rotation_vector(cross(wanted, g.axis), dot(wanted, g.axis), one, cross(wanted, aside));
  }
  g.rotation_full = g.rotation;
  if (goal.yields) g.rotation = load(goal.turning) * g.rotation;
  if (!goal.is_placed) g.position = Rows3{};
  if (!goal.has_slack) return g;
  if (goal.is_placed) g.position = beyond_slack(target, g.position_full, load3(goal.slack));
  const Rows3 slack = load3(goal.slack + 3 * kWidth);
  const Row counts = goal.yields ? load(goal.turning) : all(1.0);
  if (goal.turns && !goal.by_axis)
    g.rotation = counts * beyond_slack(target, g.rotation_full, slack);
  if (goal.by_axis) {
    const Row angle = root(dot(g.rotation_full, g.rotation_full));
    const Row allowed = most(most(slack.x, slack.y), slack.z);
    const Mask inside = angle <= allowed;
    const Row left = choose(inside, Row{}, all(1.0) - allowed / choose(inside, all(1.0), angle));
    g.rotation = counts * (left * g.rotation_full);
  }
  return g;
}

/// Add a goal's share to the gradient and the Gauss-Newton Hessian where the trial is taken; in
/// place of what they hold if it is the first.
inline void add_derivatives(const LaneProblem& problem, const LaneGoal& goal, const GoalRows& at,
                            const Mask& taken, bool is_first) {
  const FrameRows target = load_frame(goal.target);
  Row w = all(problem.rotation_weight);
  const Row scale = root(load(goal.weight));
  if (goal.yields) w = w * load(goal.turning);
  const auto add = [&](double* to, const Row& share) {
    const Row held = load(to);
    store(to, choose(taken, is_first ? share : held + share, held));
  };
  const bool leans = goal.has_slack && goal.turns && !goal.by_axis;
  const Row k = leans ? rotation_rate_coefficient(at.rotation_full) : Row{};
  for (int i = 0; i < goal.dof_count; ++i) {
    double* const column = problem.columns + 6 * kWidth * goal.dofs[i];
    for (int r = 0; r < 6; ++r) store(column + r * kWidth, Row{});
  }
  const int passes = goal.reference_chain_length > 0 ? 2 : 1;  // with the tip, and with its target
  for (int pass = 0; pass < passes; ++pass) {
    const int* const chain = pass == 0 ? goal.chain : goal.reference_chain;
    const int length = pass == 0 ? goal.chain_length : goal.reference_chain_length;
    for (int c = 0; c < length; ++c) {
      const int b = chain[c];
      const RolloutJoint& joint = problem.joints[b];
      const double* const frame = problem.frames + 12 * kWidth * b;
      double* const column = problem.columns + 6 * kWidth * joint.dof;
      Rows3 z = load3(frame + 6 * kWidth);
      if (!joint.plain) z = all(joint.multiplier) * z;
      if (pass == 1) z = all(-1.0) * z;
      Rows3 linear = joint.prismatic ? z : cross(z, at.tip - load3(frame + 9 * kWidth));
      if (goal.has_slack && goal.is_placed)
        linear = beyond_slack_rate(target, linear, at.position_full, load3(goal.slack));
      store3(column, load3(column) + scale * linear);
      if (!goal.turns || joint.prismatic) continue;
      Rows3 angular = z;
      // Turning about the constrained axis itself changes nothing.
      if (goal.by_axis) angular = z - dot(at.axis, z) * at.axis;
      if (leans) {
        angular = beyond_slack_rate(target, rotation_rate(at.rotation_full, k, angular),
                                    at.rotation_full, load3(goal.slack + 3 * kWidth));
      }
      store3(column + 3 * kWidth, load3(column + 3 * kWidth) + (scale * w) * angular);
    }
  }
  if (goal.looks) {
    // What is looked at goes by the other way.
    Row distance2;
    const Rows3 sight = sight_of(at.position_full, distance2);
    const Row share = w / root(distance2);
    for (int i = 0; i < goal.dof_count; ++i) {
      double* const column = problem.columns + 6 * kWidth * goal.dofs[i];
      store3(column + 3 * kWidth, load3(column + 3 * kWidth) + share * cross(sight, load3(column)));
      store3(column, Rows3{});
    }
  }
  const Rows3 p = scale * at.position, e = (scale * w) * at.rotation;
  for (int i = 0; i < goal.dof_count; ++i) {
    const int row = goal.dofs[i];
    const double* const column = problem.columns + 6 * kWidth * row;
    const Rows3 linear = load3(column), angular = load3(column + 3 * kWidth);
    add(problem.gradient + kWidth * row, dot(linear, p) + dot(angular, e));
    double* const h = problem.hessian + kWidth * (row * (row + 1) / 2);
    for (int j = 0; j <= i; ++j) {
      const int k2 = goal.dofs[j];
      const double* const other = problem.columns + 6 * kWidth * k2;
      add(h + kWidth * k2, dot(linear, load3(other)) + dot(angular, load3(other + 3 * kWidth)));
    }
  }
}

/// Solve (H + damping I) d = -g over the free variables by an L D L^T factorisation, d = 0
/// elsewhere. @returns  Where all pivots are positive.
inline Mask solve_damped(const LaneProblem& problem, const Row& damping) {
  const int n = problem.dof;
  double *const L = problem.factor, *const y = problem.step;
  const double* const free = problem.is_free;
  for (int i = 0; i < n; ++i) {
    const Row mine = load(free + kWidth * i);
    const double* const h = problem.hessian + kWidth * (i * (i + 1) / 2);
    for (int k = 0; k < i; ++k)
      store(L + kWidth * (k * n + i), load(h + kWidth * k) * (mine * load(free + kWidth * k)));
    store(L + kWidth * (i * n + i),
          choose(mine > all(0.5), load(h + kWidth * i) + damping, all(1.0)));
    store(y + kWidth * i, -mine * load(problem.gradient + kWidth * i));
  }
  Mask ok = Row{} == Row{};
  for (int k = 0; k < n; ++k) {
    const double* const column = L + kWidth * k * n;
    const Row pivot = load(column + kWidth * k);
    ok &= pivot > all(0.0);
    const Row inverse = all(1.0) / pivot, yk = load(y + kWidth * k);
    for (int j = k + 1; j < n; ++j) {
      const Row factor = load(column + kWidth * j) * inverse;
      double* const later = L + kWidth * j * n;
      for (int i = j; i < n; ++i)
        store(later + kWidth * i, load(later + kWidth * i) - factor * load(column + kWidth * i));
      store(y + kWidth * j, load(y + kWidth * j) - factor * yk);
    }
  }
  for (int k = n - 1; k >= 0; --k) {
    const double* const column = L + kWidth * k * n;
    Row sum = load(y + kWidth * k);
    for (int i = k + 1; i < n; ++i) sum -= load(column + kWidth * i) * load(y + kWidth * i);
    store(y + kWidth * k, sum / load(column + kWidth * k));
  }
  return ok;
}

inline Row state_row(LaneState state) { return all(static_cast<double>(state)); }

inline unsigned tick(const LaneProblem& problem) {
  const int n = problem.dof;
  const Row zero = Row{}, one = all(1.0);
  const Mask running = load(problem.state) == state_row(LaneState::Running);
  roll_out(problem);
  Row value = zero;
  Mask met = zero == zero;
  const Row w2 = all(problem.rotation_weight * problem.rotation_weight);
  for (int k = 0; k < problem.goal_count; ++k) {
    const LaneGoal& goal = problem.goals[k];
    const GoalRows at = goal_errors(problem, goal, target_of(problem, goal));
    const Row p2 = dot(at.position, at.position), r2 = dot(at.rotation, at.rotation);
    met &= (p2 < all(goal.position_tolerance2)) & (r2 < all(goal.rotation_tolerance2));
    value += load(goal.weight) * (p2 + w2 * r2);
    store_goal(problem.errors + k * kGoalRows * kWidth, at);
  }
  value = all(0.5) * value;
  store(problem.evaluations, load(problem.evaluations) + choose(running, one, zero));

  // What is better is kept.
  const Mask fresh = load(problem.fresh) > all(0.5);
  const Mask taken = running & (fresh | (value < load(problem.value)));
  const Row kept = choose(taken, value, load(problem.value));
  store(problem.value, kept);
  store(problem.fresh, zero);
  if (any(taken)) {
    const bool covers = problem.goal_count == 1 && problem.goals[0].dof_count == n;
    for (int i = 0; !covers && i < n; ++i)
      store(problem.gradient + kWidth * i,
            choose(taken, zero, load(problem.gradient + kWidth * i)));
    for (int i = 0; !covers && i < n * (n + 1) / 2; ++i)
      store(problem.hessian + kWidth * i, choose(taken, zero, load(problem.hessian + kWidth * i)));
    for (int k = 0; k < problem.goal_count; ++k) {
      add_derivatives(problem, problem.goals[k], load_goal(problem.errors + k * kGoalRows * kWidth),
                      taken, covers);
    }
  }
  Row largest = zero;
  for (int i = 0; i < n; ++i) {
    double* const x = problem.x + kWidth * i;
    store(x, choose(taken, load(problem.trial + kWidth * i), load(x)));
    const Row diagonal = load(problem.hessian + kWidth * (i * (i + 1) / 2 + i));
    largest = choose(diagonal > largest, diagonal, largest);
    largest = choose(diagonal == diagonal, largest, diagonal);  // what is no number stays none
  }
  const Row old_scale = load(problem.scale);
  Row damping = load(problem.damping);
  damping = choose(taken, most(damping * all(problem.damping_decrease), all(1e-12) * old_scale),
                   most(damping * all(problem.damping_increase), all(1e-9) * old_scale));
  damping = choose(fresh, all(problem.first_damping) * largest, damping);
  const Row scale = largest;
  store(problem.scale, scale);

  // What has ended.
  Row state = load(problem.state);
  const Mask done = taken & met;
  const Row since = load(problem.since_reference) + choose(taken & (fresh == 0), one, zero);
  const Mask window = taken & (since >= load(problem.stall_window));
  const Row reference = choose(fresh, kept, load(problem.reference));
  const Mask slow = window & (kept > load(problem.stall_ratio) * reference);
  store(problem.reference, choose(window, kept, reference));
  store(problem.since_reference, choose(fresh | window, zero, since));
  const Row iterations = load(problem.iterations);
  const Mask limit = taken & (iterations >= all(problem.max_iterations));
  const Mask flat = taken & (((scale > zero) & (scale < all(1e300))) == 0);
  Row free_count = zero;
  for (int i = 0; i < n; ++i) {
    const Row x = load(problem.x + kWidth * i), g = load(problem.gradient + kWidth * i);
    const Mask held = ((x <= load(problem.lower + kWidth * i)) & (g >= zero)) |
                      ((x >= load(problem.upper + kWidth * i)) & (g <= zero));
    const Row is_free = choose(held, zero, one);
    store(problem.is_free + kWidth * i, is_free);
    free_count += is_free;
  }
  const Mask stuck = (free_count < all(0.5)) | (damping > all(problem.max_damping) * scale);
  const Mask stalled = running & (slow | flat | stuck);
  state = choose(stalled, state_row(LaneState::Stalled), state);
  state = choose(limit, state_row(LaneState::IterationLimit), state);
  state = choose(done, state_row(LaneState::Done), state);
  store(problem.state, state);
  const Mask going = state == state_row(LaneState::Running);
  store(problem.iterations, iterations + choose(going & taken, one, zero));

  // The next step; where there is none, the trial stays and damping grows.
  const Mask ok = solve_damped(problem, damping) & going;
  for (int i = 0; i < n; ++i) {
    const Row x = load(problem.x + kWidth * i), d = load(problem.step + kWidth * i);
    const Mask fine = ok & (d - d == zero);
    const Row to =
        least(most(x + d, load(problem.lower + kWidth * i)), load(problem.upper + kWidth * i));
    store(problem.trial + kWidth * i, choose(fine, to, x));
  }
  store(problem.damping, damping);
  return bits(running & (going == 0));
}
