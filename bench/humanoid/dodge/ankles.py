"""What a motion asks of the ankles, before it is made."""

from __future__ import annotations

import mujoco
import numpy as np

from bench.common.arrays import FloatArray
from bench.humanoid.world.controller import GRAVITY
from bench.humanoid.world.model import World
from pdoik.view.h1_shapes import JOINT_NAMES, SOLE_HEEL, SOLE_TOE


class AnkleMoment:
    """The moment about the ankles' common axis that a motion takes, from momentum alone.

    With both feet held, all that can turn the robot about the line through its ankles is the sum of
    the two ankles' torques and gravity:

        tau_left + tau_right = d/dt H_x + m g (c_y - a_y)

    with H_x the angular momentum about the line (world x) and c - a the centre of mass from it.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self._data = mujoco.MjData(world.model)
        self._mass = float(world.model.body_subtreemass[world.root])

    def along(self, path: FloatArray, dt: float) -> FloatArray:
        """Moment and ground force at the inner samples of a path (K, 19) with time step dt [s].

        Returns:
            Shape (2, K - 4): the moment [N m] and the vertical force [N].
        """
        states = [self._state(q) for q in path]
        momentum, level, fall = [], [], []
        model, data, root = self._world.model, self._data, self._world.root
        ankles = self._world.setup.T_world_base[:3, 3]
        for before, at, after in zip(states[:-2], states[1:-1], states[2:], strict=True):
            data.qpos[:] = at
            mujoco.mj_differentiatePos(model, data.qvel, 2 * dt, before, after)
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_subtreeVel(model, data)
            arm = data.subtree_com[root] - ankles
            spin = data.subtree_angmom[root] + self._mass * np.cross(arm, data.subtree_linvel[root])
            momentum.append(spin[0])
            level.append(self._mass * GRAVITY * arm[1])
            fall.append(self._mass * data.subtree_linvel[root, 2])
        moment = (np.array(momentum[2:]) - momentum[:-2]) / (2 * dt) + level[1:-1]
        force = (np.array(fall[2:]) - fall[:-2]) / (2 * dt) + self._mass * GRAVITY
        return np.array([moment, force])

    def limits(self, force: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What the two ankles together may turn the robot with, least and most, [N m].

        Both motors' effort; and for feet that are free what keeps the centre of pressure on the
        soles, which the heels bound first: the ground's force times where the sole ends, 23 N m at
        rest.

        Args:
            force: The ground's vertical force, (K,) [N].

        Returns:
            Lower and upper limits, (K,) each.
        """
        effort = 2 * self._world.effort[JOINT_NAMES.index("left_ankle_joint")]
        if self._world.setup.feet == "weld and ball":
            effort /= 2  # a foot on a ball takes no moment
        if self._world.setup.feet != "floor":
            return np.full(len(force), -effort), np.full(len(force), effort)
        return np.maximum(-effort, -SOLE_TOE * force), np.minimum(effort, -SOLE_HEEL * force)

    def _state(self, q: FloatArray) -> FloatArray:
        """MuJoCo's qpos with the left foot where the set-up has it and the joints at q."""
        self._world.place(self._data, q)
        return np.array(self._data.qpos)
