"""Where a robot's feet were, when they may have touched the ground, and what that may do."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray, Recording

from ..study import FloatingBase, Foot
from .base_motion import CarriedBody
from .place import Balance, Key
from .rigid_body import STANDARD_GRAVITY
from .signals import dilated, zero_phase

_LIGHT, _FIRM = 0.1, 0.3  # of the load of one that stands: may touch; surely stands
_ALONG_AXIS = np.cos(np.radians(1.0))
_SWITCH = 1.5  # numerics: sensors that say two things, and never more than this, say only whether


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FootMotion:
    """One foot along a recording. Axes and origin are the base's."""

    foot: Foot
    place: FloatArray  # (T, 3) of the spot that touches the ground [m]
    jacobian: FloatArray  # (T, 3, n) of the body's point that is there
    turning: FloatArray  # (T, 3, n) of the body's orientation
    wrench: FloatArray  # (T, rows, 3 or 6) torques per force [N], and moment [N m], on it
    may_touch: NDArray[np.bool_]  # (T,)
    stands: NDArray[np.bool_]  # (T,) surely, and not only just
    pressed: FloatArray | None  # (T,) its sensor's force [N]; None of a switch, or without one
    upright: FloatArray | None  # (T, 3) normal of its sole; None: not known, or it has none
    # Where the base's pose is known, see `foot_forces`:
    world: FloatArray | None = None  # (T, 3) that spot [m]
    height: FloatArray | None = None  # (T,) of its sole over the simulator's ground [m]
    tilt: FloatArray | None = None  # (T, 2) rise of its sole along the world's x and y
    rocks: tuple[bool, ...] = (False, False)  # while it stands, so that its tilt says nothing
    load: FloatArray | None = None  # (T, 3 or 6) likeliest force on it, and moment, in base axes
    normal: FloatArray | None = None  # (T,) force that presses it [N]
    grip: FloatArray | None = None  # (T,) tangential force beyond the simulator's friction [N]
    slips: NDArray[np.bool_] | None = None  # (T,)

    def of(self, balance: Balance) -> FloatArray | None:
        """What one of the feet's balances is of, (T, channels); None where it is unknown."""
        values = {"foot": self.height, "tilt": self.tilt, "grip": self.grip}[balance]
        return None if values is None else values.reshape(len(values), -1)

    def judged(self, key: Key) -> NDArray[np.bool_]:
        """Samples at which it shows where the ground is, (T,)."""
        balance, channel = key
        if balance == "tilt":
            return self.stands & (not self.rocks[channel % 2])
        return self.slips if balance == "grip" and self.slips is not None else self.stands

    @property
    def force(self) -> FloatArray | None:
        """The likeliest force on it, (T, 3) in the base's axes [N]."""
        return None if self.load is None else self.load[:, :3]


def feet_of(
    recording: Recording, floating: FloatingBase, body: CarriedBody, q: FloatArray, cutoff: float
) -> tuple[FootMotion, ...]:
    """Every foot along a recording.

    A foot without a sensor may touch at any time.

    Args:
        recording: with (T, feet) contacts, or None.
        floating: which links the feet are.
        body: whose feet they are.
        q: (T, n) smooth.
        cutoff: of what is made of it: a touch counts as far as filters smear it [Hz].
    """
    around = int(0.5 / (cutoff * recording.period)) + 1
    feet = []
    for k, foot in enumerate(floating.feet):
        poses, jacobians = body.poses_and_jacobians(q, body.frame(foot.link))
        offset = poses[:, :3, :3] @ np.array(foot.at) - (foot.sole or 0.0) * body.base.up
        place = poses[:, :3, 3] + offset
        jacobians[:, :3] -= np.cross(offset[:, :, None], jacobians[:, 3:], axis=1)
        sensed = None if recording.contact is None else recording.contact[:, k]
        sensor = None if sensed is None or not np.isfinite(sensed).any() else sensed
        touches = np.ones(len(q), dtype=np.bool_)
        stands = np.zeros(len(q), dtype=np.bool_)
        pressed = None
        if sensor is not None:
            said = np.unique(np.round(sensor, 6))
            switch = len(said) <= 2 and bool(np.abs(said).max() <= _SWITCH)
            load = 1.0 if switch else _load(body, len(floating.feet))
            smooth = zero_phase(sensor, 2.0 * cutoff, recording.period)
            touches = dilated(smooth > _LIGHT * load, around)
            stands = ~dilated(smooth < _FIRM * load, around)
            pressed = None if switch else sensor
        feet.append(
            FootMotion(
                foot=foot,
                place=np.ascontiguousarray(place),
                jacobian=np.ascontiguousarray(jacobians[:, :3]),
                turning=np.ascontiguousarray(jacobians[:, 3:]),
                wrench=_wrench(foot, place, jacobians, body.rows),
                may_touch=touches,
                stands=stands,
                pressed=pressed,
                upright=_upright(foot, body, poses, q.shape[1]),
            )
        )
    return tuple(feet)


def force_by_position(foot: FootMotion, force: FloatArray, depth: FloatArray) -> FloatArray:
    """How a constant force's part of the torques changes with the joints, (T, rows, n).

    By the kinematic Hessian: a joint nearer to the base turns what the others move.

    Args:
        foot: where it acts.
        force: (T, 3) in the base's axes [N].
        depth: (n,) joints from the base to each.
    """
    count, rows, _ = foot.wrench.shape
    n = foot.jacobian.shape[2]
    change = np.zeros((count, rows, n))
    moved = np.cross(foot.jacobian, force[:, :, None], axis=1)  # (T, 3, n) J x f
    # f . (z x J) = z . (J x f), z of the joint nearer to the base
    turned = np.einsum("tai,taj->tij", foot.turning, moved)
    nearer = depth[:, None] <= depth[None, :]
    there = np.any(foot.jacobian != 0.0, axis=1)  # joints of the leg
    change[:, :n] = np.where(nearer, turned, np.transpose(turned, (0, 2, 1)))
    change[:, :n] *= there[:, :, None] & there[:, None, :]
    if rows > n:
        change[:, n + 3 :] = moved
    return change


def _upright(foot: Foot, body: CarriedBody, poses: FloatArray, n: int) -> FloatArray | None:
    """Normal of a flat foot's sole, (T, 3) in the base's axes, where its link's axes show it.

    The sole is level where all joints are at 0 and the base is. One that is then along no axis of
    its link is of a robot whose zero is no stance.
    """
    if not foot.flat:
        return None
    zero = body.poses_and_jacobians(np.zeros((1, n)), body.frame(foot.link))[0]
    normal = zero[0, 2, :3]  # the base's z in the link's axes
    return poses[:, :3, :3] @ normal if np.abs(normal).max() > _ALONG_AXIS else None


def _load(body: CarriedBody, feet: int) -> float:
    """Force on each foot [N] of a robot that stands on all."""
    mass = float(np.sum(body.inertial_parameters()[:, 0]))
    return mass * STANDARD_GRAVITY / feet


def _wrench(foot: Foot, place: FloatArray, jacobians: FloatArray, rows: int) -> FloatArray:
    """What forces on a foot (and moments, of a flat one) do to the torques, (T, rows, 3 or 6)."""
    count, _, n = jacobians.shape
    size = 6 if foot.flat else 3
    wrench = np.zeros((count, rows, size))
    wrench[:, :n] = np.transpose(jacobians[:, :size], (0, 2, 1))
    if rows > n:
        x, y, z = place.T
        wrench[:, n : n + 3, :3] = np.eye(3)
        for row, column, values in (
            (3, 1, -z), (3, 2, y), (4, 0, z), (4, 2, -x), (5, 0, -y), (5, 1, x)
        ):  # fmt: skip
            wrench[:, n + row, column] = values
        if foot.flat:
            wrench[:, n + 3 :, 3:] = np.eye(3)
    return wrench
