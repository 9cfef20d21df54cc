"""A tool brought to poses by Newton's steps, with Pinocchio's kinematics."""

import numpy as np
import pinocchio as pin

from bench.common.arrays import FloatArray
from bench.ik.paths.arms import judge_of
from bench.ik.paths.problem import Problem

EXACT = 3e-6  # [m] and [rad]
DAMPING = 1e-5


class Chain:
    """Errors and Jacobians of a problem's tool, by Pinocchio."""

    def __init__(self, problem: Problem) -> None:
        kinematics = judge_of(problem.arm).kinematics
        self.lower, self.upper = kinematics.lower, kinematics.upper
        self._model, self._data = kinematics.model, kinematics.model.createData()
        tip = self._model.getFrameId(problem.robot.tip_links[0])
        frame = self._model.frames[tip]
        self._joint = frame.parentJoint
        self._local = frame.placement * pin.SE3(problem.tool)
        places = [self._model.joints[self._model.getJointId(n)] for n in kinematics.names]
        self._at = [joint.idx_q for joint in places]
        self._columns = [joint.idx_v for joint in places]
        self._whole = kinematics.neutral.copy()
        self._free = problem.free

    def error(self, q: FloatArray, T: FloatArray) -> tuple[FloatArray, FloatArray]:
        """What is left to T in the tool's frame, (6,) or (5,), and its Jacobian."""
        self._whole[self._at] = q
        pin.computeJointJacobians(self._model, self._data, self._whole)
        at = self._data.oMi[self._joint] * self._local
        J = pin.getJointJacobian(self._model, self._data, self._joint, pin.ReferenceFrame.WORLD)
        J = at.toActionMatrixInverse() @ J[:, self._columns]
        left = np.empty(6)
        left[:3] = at.rotation.T @ (T[:3, 3] - at.translation)
        turn = at.rotation.T @ T[:3, :3]
        if self._free:
            z = turn[:, 2]
            sine = np.hypot(z[0], z[1])
            left[3:] = np.array([-z[1], z[0], 0.0]) * (np.arctan2(sine, z[2]) / max(sine, 1e-12))
            return left[:5], J[:5]
        left[3:] = pin.log3(turn)
        return left, J

    def meet(
        self, q: FloatArray, T: FloatArray, steps: int, largest: float
    ) -> tuple[FloatArray, FloatArray] | None:
        """Newton's steps to T inside limits, and the inverse of the last; None if they fail."""
        q = q.copy()
        for _ in range(steps):
            left, J = self.error(q, T)
            inverse = J.T @ np.linalg.inv(J @ J.T + DAMPING * (left @ left) * np.eye(len(J)))
            if np.abs(left).max() < EXACT:
                return q, np.eye(len(q)) - inverse @ J
            dq = inverse @ left
            dq *= min(1.0, largest / np.abs(dq).max())
            q = np.clip(q + dq, self.lower, self.upper)
        return None
