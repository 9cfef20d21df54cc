"""What effects add to the balances, and what the physics changes, for tests of the effects."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from pdoik.sim2real.effects import CATALOGUE
from pdoik.sim2real.motion import Motion, Place, RigidBody

STEP = 1e-4  # of central differences


def added(
    effect: str, motion: Motion, place: Place, shape: tuple[float, ...] = (), **values: float
) -> dict[Any, np.ndarray]:
    """What an effect with these parameters adds to each balance, (T,) by key."""
    shape, beta = CATALOGUE[effect].coefficients(values, shape)
    columns = CATALOGUE[effect].columns(motion, place, shape)
    return {key: column @ beta for key, column in columns.items()}


def torque(motion: Motion, **changes: np.ndarray) -> np.ndarray:
    """Of the rigid body along the motion with other positions, speeds or accelerations."""
    state = {"q": motion.q, "dq": motion.dq, "ddq": motion.ddq} | changes
    assert motion.body is not None
    return motion.body.torque(**state)


def torques(columns: dict[Any, np.ndarray], n: int) -> np.ndarray:
    """Of all joints, (T, n)."""
    return np.stack([columns["torque", j] for j in range(n)], axis=1)


def tips(columns: dict[Any, np.ndarray]) -> np.ndarray:
    """All six axes, (T, 6)."""
    return np.stack([columns["tip", axis] for axis in range(6)], axis=1)


def tip_change(motion: Motion, body: RigidBody, q: np.ndarray) -> np.ndarray:
    """From the tip's pose along the motion to that of another body or motion, (T, 6)."""
    assert motion.body is not None
    here, _ = motion.body.poses_and_jacobians(motion.q, motion.body.frame("tool"))
    there, _ = body.poses_and_jacobians(q, body.frame("tool"))
    turned = Rotation.from_matrix(there[:, :3, :3] @ np.transpose(here[:, :3, :3], (0, 2, 1)))
    return np.hstack([there[:, :3, 3] - here[:, :3, 3], turned.as_rotvec()])
