"""Joints that a recorded torque drives away from the recording, put back one by one."""

from __future__ import annotations

import mujoco
import numpy as np

from pdoik.recordings import FloatArray

from .segments import row_at
from .stepper import Stepper

TURNED, SHIFTED = 0.3, 0.1  # from the recording, at which a joint is put back [rad], [m]
LOOKED_EVERY = 4e-3  # [s]


class DriftReset:
    """Says which joints have strayed from a recording, and puts those back.

    A joint that is lighter in the model than in truth, or lacks its friction, runs off under a
    recorded torque within milliseconds. The others' motion is not lost for that.

    Args:
        stepper: Whose joints are put back.
        time: Of the recording, (T,) [s].
        q: Recorded positions, (T, n).
        dq: Recorded speeds, (T, n).
    """

    def __init__(self, stepper: Stepper, time: FloatArray, q: FloatArray, dq: FloatArray) -> None:
        self._stepper, self._time, self._q, self._dq = stepper, time, q, dq
        plant = stepper.plant
        kinds = np.array([plant.model.jnt_type[plant.model.dof_jntid[k]] for k in plant.dof])
        self._length = np.where(kinds == mujoco.mjtJoint.mjJNT_SLIDE, SHIFTED, TURNED)
        self._strayed = np.zeros(len(plant.dof), dtype=bool)
        self.count = np.zeros(len(plant.dof), dtype=int)  # how often each was put back

    def strays(self, t: float) -> bool:
        """Whether any joint is too far off at that time [s]."""
        off = self._stepper.q - row_at(t, self._time, self._q)
        self._strayed = ~(np.abs(off) <= self._length)
        return bool(self._strayed.any())

    def put_back(self, t: float) -> None:
        """Those that strayed, to where they were recorded at that time [s]."""
        q, dq = (row_at(t, self._time, each) for each in (self._q, self._dq))
        self._stepper.place(q, dq, np.flatnonzero(self._strayed).tolist())
        self.count += self._strayed
