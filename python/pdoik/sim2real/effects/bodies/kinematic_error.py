"""A joint that is not where the model puts it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, Motion, Place, RigidBody, Shape
from ...simulation import Part, Placement
from ..effect import Effect, Example, Parameter
from ..site import Site


class KinematicError(Effect):
    """One joint's placement: translation in its parent's axes, rotation after it in its own."""

    id = "kinematic_error"
    family = "geometry"
    on = "link"
    equation = "origin = origin_model + (dx, dy, dz); R = R_model exp(rx, ry, rz)"
    parameters = (
        *(Parameter(name, "m", lower=-0.3, upper=0.3) for name in ("dx", "dy", "dz")),
        *(Parameter(name, "rad", lower=-0.5, upper=0.5) for name in ("rx", "ry", "rz")),
    )
    confused_with = ("joint_offset", "joint_elasticity")
    decided_by = "the tip's pose measured in thirty spread poses"
    source = "Hollerbach et al., Springer Handbook of Robotics, Model Identification"
    example = Example(
        values={"dx": 0.01, "dy": -0.01, "dz": 5e-3, "rx": 0.02, "ry": -0.01, "rz": 0.02},
    )
    complexity = 6
    per_joint_moving = False
    refined = False

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """How the tip, where it is measured, and the torques change with the joint's frame."""
        (j,) = place.joints
        if motion.body is None:
            return {}
        torque = _torques(motion, motion.body, j)
        columns = motion.on_rows(torque)
        return columns if motion.tip_jacobian is None else columns | _tip(motion, motion.body, j)

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Only with tip poses."""
        return [()] if any(m.tip_jacobian is not None for m in motions) else []

    def exactly(self, motion: Motion, place: Place, values: Mapping[str, float]) -> Columns | None:
        """The tip's pose with the joint placed so."""
        (j,) = place.joints
        if motion.tip_jacobian is None or motion.body is None:
            return None
        shift, turn = (np.array([values[f"{of}{axis}"] for axis in "xyz"]) for of in "dr")
        moved = motion.body.displaced(j, shift, turn)
        change = motion.tip_moved(motion.q, moved)
        return {("tip", axis): change[:, axis, None] for axis in range(6)}

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        shift = (site.get("dx"), site.get("dy"), site.get("dz"))
        turn = (site.get("rx"), site.get("ry"), site.get("rz"))
        return site.each(lambda j: Placement(joint=j, shift=shift, rotation=turn))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        shift = 1e3 * np.linalg.norm([values["dx"], values["dy"], values["dz"]])
        turn = np.degrees(np.linalg.norm([values["rx"], values["ry"], values["rz"]]))
        return f"{where} is not where the model puts it: {shift:.2g} mm and {turn:.2g} degrees off."

    def regime(self, where: str) -> str:
        """When it shows."""
        return "the tip's pose, in every pose of the arm"


def _tip(motion: Motion, body: RigidBody, j: int) -> Columns:
    """Change of the tip's pose per metre and radian."""
    if "joint_poses" not in motion.cache:
        motion.cache["joint_poses"] = body.joint_poses(motion.q)
    frame = motion.cache["joint_poses"][:, j]
    # The placement's frame is the joint's before it turned: turn back about its own axis.
    before = _turned_back(motion, j, frame)
    lever = motion.tip_position() - frame[:, :3, 3]
    parent = before @ body.placement_rotation(j).T
    turning = np.cross(np.transpose(before, (0, 2, 1)), lever[:, None, :])  # (T, 3 axes, 3)
    columns: Columns = {}
    for axis in range(3):
        columns["tip", axis] = np.hstack([parent[:, axis, :], turning[:, :, axis]])
        columns["tip", 3 + axis] = np.hstack([np.zeros_like(lever), before[:, axis, :]])
    return columns


_STEP = 1e-4  # of the finite differences [m, rad]


def _torques(motion: Motion, body: RigidBody, j: int) -> FloatArray:
    """Change of the rigid body's torques per metre and radian, (T, n, 6)."""
    name = f"placement {j}"
    if name not in motion.cache:
        here = body.torque(motion.q, motion.dq, motion.ddq)
        steps = _STEP * np.eye(6)
        moved = [body.displaced(j, step[:3], step[3:]) for step in steps]
        each = [(m.torque(motion.q, motion.dq, motion.ddq) - here) / _STEP for m in moved]
        motion.cache[name] = np.stack(each, axis=2)
    return motion.cache[name]


def _turned_back(motion: Motion, j: int, frame: FloatArray) -> FloatArray:
    """Rotations (T, 3, 3) of joint j's frame at its zero position."""
    from scipy.spatial.transform import Rotation

    assert motion.body is not None
    axis = motion.body.axis(j)
    if axis is None:  # a sliding joint does not turn its frame
        return np.asarray(frame[:, :3, :3], dtype=np.float64)
    back = Rotation.from_rotvec(-motion.q[:, j, None] * axis).as_matrix()
    return np.asarray(frame[:, :3, :3] @ back, dtype=np.float64)
