"""Ways of a tool: points and turns in a frame of their own, and stations spread evenly on them.

In a curve's frame z goes into the work, as the tool's does; x and y are along it. Sizes are those
for a Panda.
"""

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from bench.common.arrays import FloatArray

METRES_PER_RADIAN = 0.2  # what a turn counts where stations are spread [m]
FINE = 0.001  # of straight pieces [m]
GLYPHS: Mapping[str, list[tuple[float, float]]] = {  # strokes without a lift, in a unit square
    "M": [(0, 0), (0, 1), (0.5, 0.3), (1, 1), (1, 0)],
    "N": [(0, 0), (0, 1), (1, 0), (1, 1)],
    "W": [(0, 1), (0.25, 0), (0.5, 0.7), (0.75, 0), (1, 1)],
    "Z": [(0, 1), (1, 1), (0, 0), (1, 0)],
    "L": [(0, 1), (0, 0), (0.7, 0)],
    "V": [(0, 1), (0.5, 0), (1, 1)],
    "5": [(1, 1), (0, 1), (0, 0.5), (1, 0.5), (1, 0), (0, 0)],
    "4": [(0.8, 0), (0.8, 1), (0, 0.4), (1, 0.4)],
    "7": [(0, 1), (1, 1), (0.3, 0)],
}
Curve = tuple[FloatArray, FloatArray]  # points (M, 3) and rotation matrices (M, 3, 3)


def flat(points: FloatArray) -> Curve:
    """Curve of points (M, 2) or (M, 3), with the tool straight."""
    P = np.zeros((len(points), 3))
    P[:, : points.shape[1]] = points
    return P, np.tile(np.eye(3), (len(P), 1, 1))


def circle(rng: np.random.Generator, size: float) -> Curve:
    """All round; every other one with the tool leaning outwards."""
    t = np.linspace(0.0, 2 * np.pi, 721) + rng.uniform(0, 2 * np.pi)
    P, R = flat(size * rng.uniform(0.05, 0.14) * np.stack([np.cos(t), np.sin(t)], axis=1))
    lean = rng.choice([0.0, rng.uniform(0.1, 0.35)])
    across = np.stack([-np.sin(t), np.cos(t), 0 * t], axis=1)
    return P, Rotation.from_rotvec(lean * across).as_matrix() @ R


def square(rng: np.random.Generator, size: float) -> Curve:
    """With sharp corners."""
    return flat(polyline(_square(rng, size)))


def rounded_square(rng: np.random.Generator, size: float) -> Curve:
    """With corners of a radius: of a square and the disc that goes round it."""
    corners = _square(rng, size)
    radius = float(rng.uniform(0.15, 0.3) * np.linalg.norm(corners[1] - corners[0]))
    inner = corners * (1 - 2 * radius / np.linalg.norm(corners[1] - corners[0]))
    points = []
    for k in range(4):
        t = np.linspace(0.0, np.pi / 2, 30) + np.pi / 2 * k + np.arctan2(*corners[0][::-1])
        t -= np.pi / 4
        points.append(inner[k] + radius * np.stack([np.cos(t), np.sin(t)], axis=1))
    return flat(polyline(np.concatenate([*points, points[0][:1]])))


def letter(rng: np.random.Generator, size: float) -> Curve:
    """One of nine."""
    strokes = np.array(GLYPHS[str(rng.choice(list(GLYPHS)))]) - 0.5
    return flat(polyline(strokes * size * rng.uniform([0.08, 0.1], [0.2, 0.25])))


def s_curve(rng: np.random.Generator, size: float) -> Curve:
    """Two arcs; the tool leans along the way."""
    t = np.linspace(-np.pi, np.pi, 721)
    P, R = flat(np.stack([t / np.pi, np.sin(t)], axis=1) * size * rng.uniform(0.06, 0.15, 2))
    lean = rng.uniform(-0.3, 0.3) * np.sin(t + rng.uniform(0, 6))
    return P, Rotation.from_rotvec(lean[:, None] * [1.0, 0.0, 0.0]).as_matrix() @ R


def turns(rng: np.random.Generator, size: float) -> Curve:
    """In place, about two axes."""
    del size
    t = np.linspace(0.0, 2 * np.pi, 721)
    wide = rng.uniform(0.2, 0.6, 2)
    angles = np.stack([wide[0] * np.sin(t), wide[1] * np.sin(2 * t)], axis=1)
    return np.zeros((len(t), 3)), Rotation.from_euler("XY", angles).as_matrix()


def box_seam(rng: np.random.Generator, size: float) -> Curve:
    """Over the top of a box, round its edge, and down the side, normal to it."""
    top, side = size * rng.uniform(0.08, 0.18), size * rng.uniform(0.05, 0.14)
    radius = rng.uniform(0.015, 0.04)
    t = np.linspace(0.0, np.pi / 2, 91)
    round_ = np.stack([radius * np.sin(t), 0 * t, radius * (1 - np.cos(t))], axis=1)
    down = round_[-1] + [[0, 0, 0], [0, 0, side]]
    P = polyline(np.concatenate([[[-top, 0, 0]], round_, down[1:]]))
    angle = np.interp(P[:, 0], [0.0, radius], [0.0, np.pi / 2])
    inside = (P[:, 0] > 0) & (P[:, 0] < radius)
    angle[inside] = np.arcsin(P[inside, 0] / radius)
    P -= [0.0, 0.0, 0.5 * side]
    return P, Rotation.from_rotvec(-angle[:, None] * [0.0, 1.0, 0.0]).as_matrix()


def pipe_seam(rng: np.random.Generator, size: float) -> Curve:
    """Round a pipe that lies along y below it, every other one as a helix, normal to it."""
    radius, half = size * rng.uniform(0.04, 0.1), rng.uniform(0.8, 1.6)
    t = np.linspace(-half, half, 721)
    along = rng.choice([0.0, rng.uniform(0.05, 0.15)]) * t / half
    P = np.stack([radius * np.sin(t), along, radius * (1 - np.cos(t))], axis=1)
    return P, Rotation.from_rotvec(-t[:, None] * [0.0, 1.0, 0.0]).as_matrix()


CURVES: Mapping[str, Callable[[np.random.Generator, float], Curve]] = {
    "circle": circle,
    "square": square,
    "rounded": rounded_square,
    "letter": letter,
    "S": s_curve,
    "turns": turns,
    "box": box_seam,
    "pipe": pipe_seam,
}


def polyline(corners: FloatArray) -> FloatArray:
    """Points along it, near one another, the corners among them."""
    parts = [corners[:1]]
    for one, other in pairwise(corners):
        count = max(1, int(np.ceil(np.linalg.norm(other - one) / FINE)))
        parts.append(one + np.linspace(0.0, 1.0, count + 1)[1:, None] * (other - one))
    return np.concatenate(parts)


def stations(curve: Curve, count: int, *, closed: bool = False) -> FloatArray:
    """Evenly spread by distance and turn, (count, 4, 4); without the last where it is the first."""
    P, R = curve
    turned = Rotation.from_matrix(R[:-1].swapaxes(1, 2) @ R[1:]).magnitude()
    gone = np.linalg.norm(np.diff(P, axis=0), axis=1) + METRES_PER_RADIAN * turned
    way = np.concatenate([[0.0], np.cumsum(gone)])
    keep = np.concatenate([[True], gone > 0.0])
    way, P, R = way[keep], P[keep], R[keep]
    at = np.linspace(0.0, way[-1], count + closed)[:count]
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, 3] = np.column_stack([np.interp(at, way, axis) for axis in P.T])
    T[:, :3, :3] = Slerp(way, Rotation.from_matrix(R))(at).as_matrix()
    return T


def _square(rng: np.random.Generator, size: float) -> FloatArray:
    half = size * rng.uniform(0.04, 0.11)
    return half * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]])
