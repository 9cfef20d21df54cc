"""Many configurations for one target, by damped least squares on Pinocchio: knows no obstacles.

It makes the problem sets and finds what can be reached at all, so it must not be the solver that
is measured.
"""

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio

from bench.common.arrays import FloatArray
from bench.ik.problems.judge import Judge

STEPS = 60
TOLERANCE = 1e-9  # of position [m] and rotation [rad]
LONGEST = 0.5  # of one step, any joint [rad]


def configurations(
    judge: Judge, targets: Mapping[str, FloatArray], rng: np.random.Generator, tries: int
) -> Iterator[FloatArray]:
    """Configurations within the limits that meet the targets, each from a random start.

    Many of the `tries` lead nowhere. The kinematics are the judge's.
    """
    for _ in range(tries):
        q = _descend(judge, targets, judge.random(rng))
        if q is not None:
            yield q


def _descend(judge: Judge, targets: Mapping[str, FloatArray], q: FloatArray) -> FloatArray | None:
    damping = 1e-3
    for _ in range(STEPS):
        gaps, rows = [], []
        for tip, T in targets.items():
            gap = pinocchio.SE3(np.linalg.inv(judge.fk(q, tip)) @ T)
            gaps.append(pinocchio.log6(gap).vector)
            rows.append(judge.jacobian(q, tip))
        e, J = np.concatenate(gaps), np.concatenate(rows)
        if np.abs(e).max() < TOLERANCE:
            return q
        step = J.T @ np.linalg.solve(J @ J.T + damping * min(1.0, float(e @ e)) * np.eye(len(e)), e)
        step *= min(1.0, LONGEST / max(np.abs(step).max(), 1e-12))
        moved = q + step
        q = np.where(judge.endless, moved, np.clip(moved, judge.lower, judge.upper))
    return None
