"""What a controller that samples does to a motion: its torques are held from tick to tick.

A model's actuators follow the state continuously, or at the model's own step. A real controller
reads the state, gives a torque and holds it for a period, while physics goes on.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np

from pdoik.recordings import FloatArray

from .user_model import UserModel

_RECORDED = 1e-3  # longest time between two states that are kept [s]
_PHYSICS = 2.5e-4  # longest step of physics [s]
_STATE = int(mujoco.mjtState.mjSTATE_FULLPHYSICS)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sampled:
    """A model whose drives are silent, and the law that moves it instead."""

    user: UserModel  # whose step is that of the states kept
    model: Any  # mujoco.MjModel with the physics' own step
    substeps: int  # of physics between two states
    states: int  # between two ticks
    kp: FloatArray  # (n,)
    kv: FloatArray
    limit: FloatArray  # (n,) [N m]

    @classmethod
    def of(cls, user: UserModel, candidate: Any) -> Sampled:
        """A sampled candidate under the study's law, whose period must be known."""
        assert user.law is not None
        assert user.law.period is not None
        period = user.law.period
        states = max(1, int(np.ceil(period / _RECORDED - 1e-9)))
        substeps = max(1, int(np.ceil(period / states / _PHYSICS - 1e-9)))
        kept, model = copy.copy(candidate), copy.copy(candidate)
        kept.opt.timestep = period / states
        model.opt.timestep = period / states / substeps
        actuators, ids = list(user.actuators), list(user.joint_ids)
        gear = candidate.actuator_gear[actuators, 0]
        limit = np.where(
            candidate.jnt_actfrclimited[ids], candidate.jnt_actfrcrange[ids, 1], np.inf
        )
        at_motor = candidate.actuator_forcerange[actuators, 1] * np.abs(gear)
        limited = candidate.actuator_forcelimited[actuators].astype(bool)
        model.actuator_gainprm[actuators] = 0.0
        model.actuator_biasprm[actuators] = 0.0
        return cls(
            user=replace(user, model=kept),
            model=model,
            substeps=substeps,
            states=states,
            kp=-candidate.actuator_biasprm[actuators, 1] * gear**2,
            kv=-candidate.actuator_biasprm[actuators, 2] * gear**2,
            limit=np.where(limited, np.minimum(limit, at_motor), limit),
        )

    def run(
        self, start: FloatArray, commands: FloatArray, forward: FloatArray | None
    ) -> tuple[FloatArray, FloatArray]:
        """Physics states (K, nstate) after each kept step, and the held torques (K, n).

        Args:
            start: state at the first tick.
            commands: (K, n) positions asked for at the kept steps; those at ticks are used.
            forward: (K, n) torques added outside the law, or None.
        """
        model, data, user = self.model, mujoco.MjData(self.model), self.user
        mujoco.mj_setState(model, data, start, _STATE)
        qpos, dof, torque = list(user.qpos), list(user.dof), np.zeros(len(user.joints))
        states, held = np.empty((len(commands), len(start))), np.empty(commands.shape)
        for k, command in enumerate(commands):
            if k % self.states == 0:
                torque = self.kp * (command - data.qpos[qpos]) - self.kv * data.qvel[dof]
                torque = np.clip(torque, -self.limit, self.limit)
                data.qfrc_applied[dof] = torque if forward is None else torque + forward[k]
            mujoco.mj_step(model, data, self.substeps)
            mujoco.mj_getState(model, data, states[k], _STATE)
            held[k] = torque
        return states, held
