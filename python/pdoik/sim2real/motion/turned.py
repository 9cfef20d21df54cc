"""The rigid body's torques where one joint stands elsewhere.

Of one joint's position, speeds and accelerations kept, inverse dynamics are a trigonometric
polynomial of degree two, or of a slider a plain one: a body's inertia is turned into other axes
once forth and once back. So a few positions of the joint say all others exactly.
"""

from __future__ import annotations

import numpy as np

from pdoik.recordings import FloatArray

from .motion import Motion

_ANGLES = 2.0 * np.pi / 5.0 * np.arange(1, 5)  # away from the motion's own [rad]
_STEPS = (-1.0, 1.0)  # of a slider [m]


def torque_turned(motion: Motion, j: int, by: float) -> FloatArray:
    """Torques (T, rows) of the rigid body alone where joint j stands `by` [rad or m] further."""
    assert motion.body is not None
    slides = motion.body.axis(j) is None
    here, others = motion.tau_without_rotor(), _elsewhere(motion, j, slides)
    if slides:
        own, each = 1.0 - by * by, [0.5 * by * (by + way) for way in _STEPS]
    else:
        own, each = _kernel(by), [_kernel(by - angle) for angle in _ANGLES]
    total = own * here
    for weight, torque in zip(each, others, strict=True):
        total += weight * torque
    return np.asarray(total)


def _kernel(angle: float) -> float:
    """Dirichlet's weights of degree two and five nodes: 1 at its own and 0 at the others."""
    return float((1.0 + 2.0 * np.cos(angle) + 2.0 * np.cos(2.0 * angle)) / 5.0)


def _elsewhere(motion: Motion, j: int, slides: bool) -> list[FloatArray]:
    """Torques at the other positions; those of the last joint that was asked for are kept."""
    name = f"turned {j}"
    if name not in motion.cache:
        for old in [key for key in motion.cache if key.startswith("turned ")]:
            del motion.cache[old]
        assert motion.body is not None
        found = []
        for by in _STEPS if slides else _ANGLES:
            q = motion.q.copy()
            q[:, j] += by
            found.append(motion.body.torque(q, motion.dq, motion.ddq))
        motion.cache[name] = np.stack(found)
    return list(motion.cache[name])
