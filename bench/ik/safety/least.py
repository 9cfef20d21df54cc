"""How near to a goal an arm can come: SciPy's least squares on Pinocchio's kinematics.

The joints' limits are bounds. What is not to be touched is held off by a penalty so stiff that a
tenth of a millimetre is all that is left of it; answers deeper than that do not count.
"""

from collections.abc import Iterable

import numpy as np
import pinocchio as pin
from scipy.optimize import least_squares, lsq_linear

from bench.common.arrays import BoolArray, FloatArray
from bench.ik.safety.world import Box, World, distances, to_box
from bench.ik.soak.hulls import capsules
from bench.ik.soak.judge import Asked, Goals, Judge

ROTATION_WEIGHT = 0.3  # what a radian counts [m]
STIFF = 100.0  # of the penalty, metres per metre
SOFT = 10.0  # the same for a first descent
LOOSE, TIGHT = 1e-5, 1e-8  # relative changes that end a first descent, and the second
GRAZE = 1e-4  # how deep an answer may be [m]
ROWS = 64  # contacts that count at once, the deepest
INSET = 1e-9  # of starts off the limits [rad]
PIECE = 0.03  # a joint's way in one step of a continuous descent [rad]
PIECES = 200
REACH = 0.03  # what may be met in one step is nearer [m]
ATTEMPTS = 6
FINEST = 1e-5  # a step that is none [rad]
WORTH = 1e-7  # of a cost: a decrease by less is none
POLISHED = 4  # of many descents the best, which are finished


class Errand:
    """One arm, what is around it, and a pose for its tip."""

    def __init__(self, judge: Judge, world: World, T: FloatArray) -> None:
        kinematics = judge.kinematics
        self._judge, self._world, self._T = judge, world, T
        self.lower, self.upper = kinematics.lower, kinematics.upper
        self._model, self._data = kinematics.model, kinematics.model.createData()
        joints = [self._model.getJointId(name) for name in kinematics.names]
        self._at_q = [self._model.joints[joint].idx_q for joint in joints]
        self._at_v = [self._model.joints[joint].idx_v for joint in joints]
        assert all(self._model.joints[joint].nq == 1 for joint in joints)
        assert not any(joint.follows for joint in kinematics.joints.values())
        self._moves = np.array(
            [[j in set(above) for j in joints] for above in self._model.supports]
        )
        self._tip = kinematics.seat(kinematics.spec.tip_links[0])
        self._seats = np.array([kinematics.seat(link)[0] for link, _ in judge.links])
        q = np.clip(np.zeros(len(joints)), self.lower, self.upper)
        a, b = judge.hulls(kinematics.place(q[None]))
        p, r, radii = (each[0] for each in capsules(a, b, judge.A, judge.swept))
        self._radii = radii
        R, t = self._place(q)
        self._p, self._q = (
            np.einsum("kji,kj->ki", R[self._seats], end - t[self._seats]) for end in (p, r)
        )

    def _place(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rotations and positions of all joints; sets the Jacobian of q."""
        whole = pin.neutral(self._model)
        whole[self._at_q] = q
        pin.computeJointJacobians(self._model, self._data, whole)
        self._J = self._data.J[:, self._at_v]
        return (
            np.array([T.rotation for T in self._data.oMi]),
            np.array([T.translation for T in self._data.oMi]),
        )

    def _rates(self, joints: FloatArray, points: FloatArray) -> FloatArray:
        """How points (K, 3) on joints move with q, (K, 3, n)."""
        turning = np.cross(self._J[3:].T[None], points[:, None])  # (K, n, 3)
        rates = (self._J[:3].T[None] + turning) * self._moves[joints][..., None]
        return np.asarray(rates.swapaxes(1, 2))

    def goal(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What is left of it, (6,), a radian as ROTATION_WEIGHT metres, and its Jacobian."""
        self._place(q)
        joint, R_seat, p_seat = self._tip
        T = self._data.oMi[joint]
        R_tip, p_tip = T.rotation @ R_seat, T.translation + T.rotation @ p_seat
        E = self._T[:3, :3].T @ R_tip
        turn = self._J[3:] * self._moves[joint]
        r = np.concatenate([p_tip - self._T[:3, 3], ROTATION_WEIGHT * pin.log3(E)])
        along = self._rates(np.array([joint]), p_tip[None])[0]
        return r, np.vstack([along, ROTATION_WEIGHT * pin.Jlog3(E) @ R_tip.T @ turn])

    def rows(self, q: FloatArray, stiffness: float) -> tuple[FloatArray, FloatArray]:
        """Residuals of the goal and of what is in something, (6 + ROWS,), and their Jacobian."""
        r, J = np.zeros(6 + ROWS), np.zeros((6 + ROWS, len(q)))
        r[:6], J[:6] = self.goal(q)
        gaps, rates = self.contacts(q, 0.0)
        if len(gaps) > ROWS:
            deepest = np.argsort(gaps)[:ROWS]
            gaps, rates = gaps[deepest], rates[deepest]
        r[6 : 6 + len(gaps)], J[6 : 6 + len(gaps)] = stiffness * gaps, stiffness * rates
        return r, J

    def contacts(self, q: FloatArray, reach: float) -> tuple[FloatArray, FloatArray]:
        """Gaps of all that are nearer than `reach` [m], (C,), and their gradients, (C, n)."""
        R, t = self._place(q)
        seats = self._seats
        p, q = (np.einsum("kij,kj->ki", R[seats], end) + t[seats] for end in (self._p, self._q))
        middle, half = 0.5 * (p + q), 0.5 * np.linalg.norm(q - p, axis=1)
        found: list[tuple[FloatArray, FloatArray]] = []
        if len(balls := self._world.balls):
            apart = np.linalg.norm(middle[:, None] - balls[:, :3], axis=-1) - balls[:, 3]
            k, n = np.nonzero(apart < (half + self._radii)[:, None] + reach)
            near = _nearest(balls[n, :3], p[k], q[k])
            found.append(self._met(seats[k], near, balls[n, :3], self._radii[k] + balls[n, 3]))
        for box in self._world.boxes:
            close = np.flatnonzero(_may_touch(p, q, self._radii + reach, box))
            gaps, points, normals = to_box(p[close], q[close], self._radii[close], box)
            some = gaps < reach
            rates = self._rates(seats[close[some]], points[some])
            found.append((gaps[some], -np.einsum("ci,cij->cj", normals[some], rates)))
        i, j = self._judge.pairs.T
        whole = half + self._radii
        apart = np.linalg.norm(middle[i] - middle[j], axis=-1)
        near = apart < whole[i] + whole[j] + reach
        i, j = i[near], j[near]
        x, y = _nearest_two(p[i], q[i], p[j], q[j])
        found.append(self._met(seats[i], x, y, self._radii[i] + self._radii[j], seats[j]))
        gaps = np.concatenate([gap for gap, _ in found])
        rates = np.concatenate([rate for _, rate in found])
        return gaps[gaps < reach], rates[gaps < reach]

    def _met(
        self,
        seats: FloatArray,
        x: FloatArray,
        y: FloatArray,
        radii: FloatArray,
        others: FloatArray | None = None,
    ) -> tuple[FloatArray, FloatArray]:
        """Gaps between points x of the robot and y, less radii, and their gradients."""
        off = x - y
        distance = np.linalg.norm(off, axis=-1)
        rates = self._rates(seats, x)
        if others is not None:
            rates = rates - self._rates(others, y)
        normal = off / np.maximum(distance, 1e-12)[:, None]
        return distance - radii, np.einsum("ci,cij->cj", normal, rates)

    def errors(self, Q: FloatArray) -> FloatArray:
        """Errors of configurations, (B,) [m], infinite if deeper in anything than a graze."""
        tip = self._judge.kinematics.spec.tip_links[0]
        goals = Goals(tip=tip, T=np.broadcast_to(self._T, (len(Q), 4, 4)))
        verdicts = self._judge([goals], Q, Asked())
        error = np.hypot(verdicts.position_error, ROTATION_WEIGHT * verdicts.rotation_error)
        clear, own = distances(self._judge, Q, self._world)
        return np.where(np.minimum(clear, own) >= -GRAZE, error, np.inf)

    def least(self, starts: Iterable[FloatArray]) -> tuple[float, FloatArray]:
        """The best of descents that may go through things on their way, and where it is."""
        ends = [self._descend(q, SOFT, 30) for q in starts]
        ends.sort(key=lambda end: end[0])
        Q = np.array([self._descend(q, STIFF, 100)[1] for _, q in ends[:POLISHED]])
        errors = self.errors(Q)
        best = int(errors.argmin())
        return float(errors[best]), Q[best]

    def _descend(self, q: FloatArray, stiffness: float, looks: int) -> tuple[float, FloatArray]:
        kept: dict[bytes, tuple[FloatArray, FloatArray]] = {}

        def both(x: FloatArray) -> tuple[FloatArray, FloatArray]:
            if x.tobytes() not in kept:
                kept.clear()
                kept[x.tobytes()] = self.rows(x, stiffness)
            return kept[x.tobytes()]

        def residuals(x: FloatArray) -> FloatArray:
            return both(x)[0]

        def jacobian(x: FloatArray) -> FloatArray:
            return both(x)[1]

        inside = np.clip(q, self.lower + INSET, self.upper - INSET)
        found = least_squares(
            residuals,
            inside,
            jacobian,
            bounds=(self.lower, self.upper),
            max_nfev=looks,
            ftol=LOOSE if stiffness == SOFT else TIGHT,
            xtol=LOOSE if stiffness == SOFT else TIGHT,
        )
        return float(found.cost), np.asarray(found.x)

    def creep(self, q: FloatArray) -> tuple[float, FloatArray]:
        """Where steps of at most PIECE a joint lead that all go downhill and stay clear."""
        piece = PIECE
        r, J = self.goal(q)
        gaps, G = self.contacts(q, REACH)
        cost = _cost(r, gaps)
        for _ in range(PIECES):
            low, high = np.maximum(self.lower - q, -piece), np.minimum(self.upper - q, piece)
            bounds = np.minimum(low, -1e-15), np.maximum(high, 1e-15)
            there = np.clip(q + _step(r, J, gaps, G, bounds), self.lower, self.upper)
            ahead, near = self.goal(there), self.contacts(there, REACH)
            gain = cost - _cost(ahead[0], near[0])
            if gain > 0.0:
                q, (r, J), (gaps, G), cost = there, ahead, near, cost - gain
                piece = min(PIECE, 2.0 * piece)
            if gain < WORTH * cost:
                piece /= 4.0
                if piece < FINEST:
                    break
        return float(self.errors(q[None])[0]), q


def _cost(r: FloatArray, gaps: FloatArray) -> float:
    return float(r @ r + STIFF**2 * np.sum(np.minimum(gaps, 0.0) ** 2))


def _step(
    r: FloatArray,
    J: FloatArray,
    gaps: FloatArray,
    G: FloatArray,
    bounds: tuple[FloatArray, FloatArray],
) -> FloatArray:
    """Step of least squares, with a row more for what the last attempt would have gone into."""
    held = gaps < 0.0
    for _ in range(ATTEMPTS):
        A, b = np.vstack([J, STIFF * G[held]]), -np.concatenate([r, STIFF * gaps[held]])
        step = lsq_linear(A, b, bounds).x
        more = ~held & (gaps + G @ step < 0.0)
        if not more.any():
            break
        held |= more
    return np.asarray(step)


def _may_touch(p: FloatArray, q: FloatArray, radii: FloatArray, box: Box) -> BoolArray:
    """Whether capsules reach into the box along each of its axes, (H,)."""
    ends = np.array([(end - box.T[:3, 3]) @ box.T[:3, :3] for end in (p, q)])
    low, high = ends.min(axis=0) - radii[:, None], ends.max(axis=0) + radii[:, None]
    return np.asarray(((low < box.size / 2) & (high > -box.size / 2)).all(axis=1))


def _nearest(point: FloatArray, p: FloatArray, q: FloatArray) -> FloatArray:
    """Nearest points of segments pq to points, (..., 3)."""
    u = q - p
    square = np.einsum("...i,...i", u, u)
    along = np.einsum("...i,...i", point - p, u) / np.where(square > 0.0, square, 1.0)
    return np.asarray(p + np.clip(along, 0.0, 1.0)[..., None] * u)


def _nearest_two(
    p: FloatArray, q: FloatArray, r: FloatArray, s: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Nearest points of segments pq and rs, (C, 3): at an end, or at the common perpendicular."""
    u, v, w = q - p, s - r, r - p
    uu, uv, vv = (np.einsum("ci,ci->c", *pair) for pair in ((u, u), (u, v), (v, v)))
    uw, vw = (np.einsum("ci,ci->c", each, w) for each in (u, v))
    square = uu * vv - uv * uv
    divisor = np.where(square > 1e-12 * uu * vv, square, np.inf)
    k, m = (uw * vv - uv * vw) / divisor, (uw * uv - vw * uu) / divisor
    x = np.stack([p, q, _nearest(r, p, q), _nearest(s, p, q), p + k[:, None] * u])
    y = np.stack([_nearest(p, r, s), _nearest(q, r, s), r, s, r + m[:, None] * v])
    distance = np.linalg.norm(x - y, axis=-1)
    distance[4, (k <= 0.0) | (k >= 1.0) | (m <= 0.0) | (m >= 1.0)] = np.inf
    best, row = distance.argmin(axis=0), np.arange(len(p))
    return x[best, row], y[best, row]
