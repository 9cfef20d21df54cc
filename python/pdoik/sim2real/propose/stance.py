"""The user's robot on its feet in MuJoCo, moved by the study's own drives."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial import ConvexHull, QhullError

from pdoik.descriptions import quiet_mujoco
from pdoik.recordings import FloatArray

from ..simulation import build_plant, mjcf_text
from ..study import Study
from .path import STEP, Path

_DT = 1e-3  # of MuJoCo [s]
_SETTLE = 1.0  # it stands before the motion begins [s]
_LIGHT = 0.3  # of a foot's share of the weight, with less of which it hardly stands
_FRICTION = 0.7  # of feet on a floor of which the study says nothing
_STIFF = (4.0 * _DT, 1.0)  # time constant and damping of contacts
_LEVEL = np.cos(np.radians(30.0))  # a base that leans further falls


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rolled:
    """What a rollout gave, at the rows of its path."""

    q: FloatArray  # (T, n)
    dq: FloatArray
    tau: FloatArray  # of the drives [N m]
    base: FloatArray  # (T, 7) pose
    contact: FloatArray  # (T, feet) that presses each foot [N]


class Stance:
    """A compiled robot with a floating base, feet and floor."""

    @quiet_mujoco()
    def __init__(self, study: Study, rotor: FloatArray) -> None:
        """Compile.

        Raises:
            ValueError: gains are not known, or feet are soles whose size nobody says.
        """
        control, base = study.controller, study.base
        if control is None or not (control.kp > 0.0).all():
            raise ValueError(
                "no motion of a standing robot is proposed: whether it stays up depends on its"
                " drives, and the study says no gains (controller: kp, kd); hang the robot up"
                " and use --base hang"
            )
        assert base is not None
        assert study.robot is not None
        if not base.feet or any(foot.flat for foot in base.feet):
            raise ValueError(
                "no motion of a standing robot is proposed: it can be checked on feet that touch"
                " the ground at a point, and this one stands on flat soles, whose size the study"
                " does not say; hang the robot up and use --base hang"
            )
        spec = mujoco.MjSpec.from_string(mjcf_text(build_plant(study.robot, study.joints).model))
        spec.option.timestep = _DT
        spec.body(base.link).add_freejoint()
        floor = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[9.0, 9.0, 0.1])
        floor.pos = [0.0, 0.0, base.ground.height]
        friction = _FRICTION if base.ground.friction is None else base.ground.friction
        for foot in base.feet:
            ball = spec.body(foot.link).add_geom(
                name=f"foot {foot.link}", type=mujoco.mjtGeom.mjGEOM_SPHERE
            )
            ball.size, ball.pos, ball.mass = [foot.sole or 0.02, 0.0, 0.0], foot.at, 0.0
            ball.friction, ball.solref = [friction, 0.0, 0.0], _STIFF
        floor.friction, floor.solref = [friction, 0.0, 0.0], _STIFF
        n, lowest = len(study.joints), control.torque_limit
        for k, name in enumerate(study.joints):
            drive = spec.add_actuator(name=name, target=name)
            drive.trntype = mujoco.mjtTrn.mjTRN_JOINT
            drive.biastype = mujoco.mjtBias.mjBIAS_AFFINE
            drive.gainprm[0] = control.kp[k]
            drive.biasprm[1:3] = [-control.kp[k], -control.kd[k]]
            if lowest is not None:
                drive.forcelimited, drive.forcerange = True, [-lowest[k], lowest[k]]
        self.model = model = spec.compile()
        joints = [model.joint(name).id for name in study.joints]
        self._q, self._v = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        model.dof_armature[self._v] = np.where(rotor > 0.0, rotor, model.dof_armature[self._v])
        self._free = int(model.jnt_qposadr[model.body(base.link).jntadr[0]])
        self._base = model.body(base.link).id
        self._feet = {model.geom(f"foot {foot.link}").id: k for k, foot in enumerate(base.feet)}
        self._light = _LIGHT * 9.81 * float(model.body_subtreemass[self._base]) / len(base.feet)
        self._speeds = study.recordings[0].dq_des is not None
        self._lead = control.kd / control.kp
        self._compensated = control.gravity_compensation
        self._n = n

    def roll(self, path: Path, q: FloatArray, base: FloatArray) -> Rolled | None:
        """Run positions that are sent; None where the robot would not stay on its feet.

        Args:
            path: of the joints, as it is sent.
            q: (n,) where the joints stand at first.
            base: (7,) pose of the base there.
        """
        model, data = self.model, mujoco.MjData(self.model)
        data.qpos[self._free : self._free + 7], data.qpos[self._q] = base, q
        sent = path.q + (self._lead * path.dq if self._speeds else 0.0)
        count, each = len(sent), round(STEP / _DT)
        made = Rolled(
            q=np.empty((count, self._n)),
            dq=np.empty((count, self._n)),
            tau=np.empty((count, self._n)),
            base=np.empty((count, 7)),
            contact=np.zeros((count, len(self._feet))),
        )
        with quiet_mujoco():
            for row in range(-round(_SETTLE / STEP), count):
                data.ctrl[:] = sent[max(row, 0)]
                for _ in range(each):
                    if self._compensated:
                        data.qfrc_applied[self._v] = data.qfrc_bias[self._v]
                    mujoco.mj_step(model, data)
                if row < 0:
                    continue
                made.q[row], made.dq[row] = data.qpos[self._q], data.qvel[self._v]
                made.tau[row] = data.qfrc_actuator[self._v] + data.qfrc_applied[self._v]
                made.base[row] = data.qpos[self._free : self._free + 7]
                made.contact[row] = self._pressed(data)
                if not self._stays(data, made.contact[row]):
                    return None
        return made

    def _pressed(self, data: mujoco.MjData) -> FloatArray:
        """Force that presses each foot, (feet,) [N]."""
        found, force = np.zeros(len(self._feet)), np.zeros(6)
        for k in range(data.ncon):
            foot = self._feet.get(data.contact.geom[k][1], self._feet.get(data.contact.geom[k][0]))
            if foot is not None:
                mujoco.mj_contactForce(self.model, data, k, force)
                found[foot] += force[0]
        return found

    def _stays(self, data: mujoco.MjData, pressed: FloatArray) -> bool:
        """Whether all feet are loaded, the base is level, and its weight is over the feet."""
        if pressed.min() < self._light or data.xmat[self._base][8] < _LEVEL:
            return False
        if len(self._feet) < 3:
            return True
        spots = np.array([data.geom_xpos[g][:2] for g in self._feet])
        try:
            sides = ConvexHull(spots).equations
        except QhullError:
            return False
        com = data.subtree_com[self._base][:2]
        return bool(np.all(sides[:, :2] @ com + sides[:, 2] < 0.0))
