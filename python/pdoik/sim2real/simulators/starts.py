"""States that a run may begin with: followers in place, filters and delays settled."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from pdoik.recordings import FloatArray

from .user_model import UserModel


def follow(model: Any, data: Any) -> None:
    """Put joints that an equality ties to others where these make them be."""
    kind = int(mujoco.mjtEq.mjEQ_JOINT)
    for k in range(model.neq):
        if int(model.eq_type[k]) != kind or not model.eq_active0[k]:
            continue
        one, two = int(model.eq_obj1id[k]), int(model.eq_obj2id[k])
        at = int(model.jnt_qposadr[one])
        x = 0.0
        slope = model.eq_data[k, 1:5]
        speed = 0.0
        if two >= 0:
            there = int(model.jnt_qposadr[two])
            x = float(data.qpos[there] - model.qpos0[there])
            speed = float(data.qvel[int(model.jnt_dofadr[two])])
        powers = x ** np.arange(1, 5)
        data.qpos[at] = model.qpos0[at] + model.eq_data[k, 0] + float(slope @ powers)
        rates = np.arange(1, 5) * x ** np.arange(4)
        data.qvel[int(model.jnt_dofadr[one])] = float(slope @ rates) * speed


def settle_actuators(user: UserModel, data: Any, command: FloatArray) -> None:
    """Filters and delays of the model's own begin with the command of the run's start."""
    model = user.model
    for k, actuator in enumerate(user.actuators):
        count = int(model.actuator_actnum[actuator])
        if count:
            at = int(model.actuator_actadr[actuator])
            data.act[at : at + count] = command[k]
        if hasattr(model, "actuator_history") and int(model.actuator_history[actuator, 0]) > 0:
            size = int(model.actuator_history[actuator, 0])
            mujoco.mj_initCtrlHistory(model, data, actuator, None, np.full((size, 1), command[k]))
