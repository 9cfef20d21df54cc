"""How the joints moved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from pdoik.descriptions import robot_facts
from pdoik.recordings import FloatArray

from ..motion import Motion, Prepared

_PEAK = 0.999  # quantile that stands for the greatest, so that one row does not
_STANDS = 0.3  # numerics: at rest for so long is a pose that it stands in [s]
_APART = 0.02  # numerics: between two poses [rad or m]
_MOST_POSES = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class JointCheck:
    """The motion of one joint, over all recordings."""

    name: str
    unit: str  # rad or m
    lower: float  # of the positions
    upper: float
    speed: float  # the greatest [unit/s]
    acceleration: float  # the greatest [unit/s^2]
    moving: float  # share of the time
    reversals: int  # changes of direction
    stands: tuple[float, ...]  # positions at which it rests for a third of a second, rising
    judged: bool  # whether it moves enough, in the recordings to fit, for what needs its motion


def joint_checks(prepared: Prepared) -> tuple[JointCheck, ...]:
    """How each joint of the study moved, in the study's order."""
    study = prepared.study
    facts = None if study.robot is None else robot_facts(study.robot)
    motions = [*prepared.fit.motions, *(prepared.validate.motions if prepared.validate else ())]
    found = []
    for j, name in enumerate(study.joints):
        slides = facts is not None and facts.joints[name].type == "prismatic"
        q = np.concatenate([m.q[:, j] for m in motions])
        found.append(
            JointCheck(
                name=name,
                unit="m" if slides else "rad",
                lower=float(q.min()),
                upper=float(q.max()),
                speed=_peak([m.dq[:, j] for m in motions]),
                acceleration=_peak([m.ddq[:, j] for m in motions]),
                moving=float(np.mean(np.concatenate([~m.still[:, j] for m in motions]))),
                reversals=sum(reversals(m, j) for m in motions),
                stands=_poses(motions, j),
                judged=bool(prepared.fit.excited[j]),
            )
        )
    return tuple(found)


def reversals(motion: Motion, j: int) -> int:
    """Changes of direction of joint j, rests apart."""
    sign = np.sign(motion.dq[~motion.still[:, j], j])
    return int(np.count_nonzero(np.diff(sign)))


def _peak(values: Sequence[FloatArray]) -> float:
    return float(np.quantile(np.abs(np.concatenate(values)), _PEAK))


def _poses(motions: Sequence[Motion], j: int) -> tuple[float, ...]:
    """Positions of joint j's rests, those that are alike once."""
    found: list[float] = []
    for motion in motions:
        still = np.concatenate([[False], motion.still[:, j], [False]])
        for first, last in pairwise(np.flatnonzero(np.diff(still.astype(int)))):
            if still[first + 1] and (last - first) * motion.period >= _STANDS:
                found.append(float(np.mean(motion.q[first:last, j])))
    poses: list[float] = []
    for position in sorted(found):
        if not poses or position - poses[-1] > _APART:
            poses.append(position)
    return tuple(poses[:_MOST_POSES])
