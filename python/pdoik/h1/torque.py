"""Can the motors hold a posture? Gravity against least-norm foot wrenches, at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.h1.controller import Controller
from pdoik.h1.model import World
from pdoik.h1.robot import JOINT_NAMES, FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class StaticTorque:
    """What holding a posture takes."""

    tau: FloatArray  # (19,) in the order of JOINT_NAMES [N m]
    effort: FloatArray  # (19,), what the motors have [N m]

    @property
    def share(self) -> FloatArray:
        """|tau| / effort, (19,)."""
        return np.asarray(np.abs(self.tau) / self.effort)

    @property
    def exceeded(self) -> dict[str, float]:
        """Joints that need more than they have, and their torques [N m]."""
        over = np.flatnonzero(self.share > 1)
        return {JOINT_NAMES[k]: float(self.tau[k]) for k in over}

    @property
    def holds(self) -> bool:
        """No joint needs more than it has."""
        return not self.exceeded


def static_torque(world: World, q: FloatArray) -> StaticTorque:
    """Torques that hold posture q (19,) on its feet where the world's set-up has them.

    The same feed-forward as the controller's. Other shares between the feet are possible, so a
    torque over the limit need not be: the ankles' shares are equal for a symmetric stance.
    """
    controller = Controller(world)
    tau = controller.gravity_torque(world.standing_data(q))
    return StaticTorque(tau=tau, effort=controller.effort)
