"""What a motion must stay within: position, speed, acceleration and torque of every joint."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pdoik.errors import LoadError
from pdoik.recordings import FloatArray

from .path import Path as JointPath

_TO_FULL_SPEED = 0.4  # in which a joint reaches its speed limit where no acceleration is given [s]
_MARGIN = 0.03  # of a joint's range that is left free at either end
_HALF_TURN = np.pi  # of a joint without position limits, from where it starts


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Limits:
    """Limits of every joint, (n,) each."""

    lower: FloatArray  # [rad], [m]
    upper: FloatArray
    speed: FloatArray  # [rad/s]
    acceleration: FloatArray  # [rad/s^2]
    torque: FloatArray  # [N m]

    def within(
        self,
        speed_share: float = 0.7,
        torque_share: float = 0.8,
        acceleration: float | None = None,
    ) -> Limits:
        """What a motion is designed within: shares of these, and a margin at the ends.

        Args:
            speed_share: of the speed limits, 0 to 1.
            torque_share: of the torque limits, 0 to 1.
            acceleration: of every joint [rad/s^2]; None: such that speed is reached in 0.4 s.
        """
        for name, value in (("speed", speed_share), ("torque", torque_share)):
            if not 0.0 < value <= 1.0:
                raise ValueError(f"share of the {name} limits is {value:g}, expected 0 to 1")
        if acceleration is not None and not 0.0 < acceleration < np.inf:
            raise ValueError(f"acceleration is {acceleration:g}, expected more than 0 rad/s^2")
        speed = speed_share * self.speed
        rate = speed / _TO_FULL_SPEED if acceleration is None else np.full_like(speed, acceleration)
        margin = _MARGIN * (self.upper - self.lower)
        return Limits(
            lower=self.lower + margin,
            upper=self.upper - margin,
            speed=speed,
            acceleration=np.minimum(rate, self.acceleration),
            torque=torque_share * self.torque,
        )

    def excess(self, path: JointPath, torque: FloatArray | None = None) -> float:
        """The largest part of its limit that anything along a path takes: up to 1 it holds.

        Args:
            path: of the joints.
            torque: (T, n) that it needs; None: not judged.
        """
        middle, half = 0.5 * (self.lower + self.upper), 0.5 * (self.upper - self.lower)
        parts = [
            np.abs(path.q - middle) / half,
            np.abs(path.dq) / self.speed,
            np.abs(path.ddq) / self.acceleration,
        ]
        parts += [] if torque is None else [np.abs(torque) / self.torque]
        return float(max(part.max() for part in parts))


def limits_of(
    robot: str,
    joints: Sequence[str],
    start: FloatArray,
    *,
    speed: float | None = None,
    torque: float | None = None,
) -> Limits:
    """A description's limits.

    Args:
        robot: text of a URDF or an MJCF.
        joints: by name, in the study's order.
        start: (n,) around which a joint without position limits may turn by half a turn.
        speed: of every joint that the description gives none for [rad/s].
        torque: of every joint that the description gives none for [N m].

    Raises:
        ValueError: a limit is given nowhere; the message says of which joint and by which option.
    """
    described = _described(robot)
    rows = [described.get(joint, _OfJoint()) for joint in joints]
    fastest = _filled([row.speed for row in rows], speed, "speed", "--max-speed", joints)
    strongest = _filled([row.torque for row in rows], torque, "torque", "--max-torque", joints)
    lower = np.array([row.lower for row in rows])
    upper = np.array([row.upper for row in rows])
    endless = ~(np.isfinite(lower) & np.isfinite(upper)) | (np.abs(lower) > 1e6)
    lower = np.where(endless, start - _HALF_TURN, lower)
    upper = np.where(endless, start + _HALF_TURN, upper)
    return Limits(
        lower=lower,
        upper=upper,
        speed=fastest,
        acceleration=np.full(len(rows), np.inf),
        torque=strongest,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class _OfJoint:
    lower: float = -np.inf
    upper: float = np.inf
    speed: float = 0.0  # 0: none
    torque: float = 0.0


def _filled(
    values: list[float], given: float | None, what: str, option: str, joints: Sequence[str]
) -> FloatArray:
    known = np.array([value if np.isfinite(value) else 0.0 for value in values])
    missing = [joint for joint, value in zip(joints, known, strict=True) if value <= 0.0]
    if missing and given is None:
        raise ValueError(
            f"the robot's description has no {what} limit of {', '.join(missing)}: give it with"
            f" {option}"
        )
    if given is not None and not 0.0 < given < np.inf:
        raise ValueError(f"{option} is {given:g}, expected more than 0")
    return np.where(known > 0.0, known, 0.0 if given is None else given)


def _described(robot: str) -> Mapping[str, _OfJoint]:
    root = ElementTree.fromstring(robot)
    if root.tag == "robot":
        return {joint.get("name", ""): _of_urdf(joint) for joint in root.findall("joint")}
    return _of_mjcf(robot)


def _of_urdf(joint: ElementTree.Element) -> _OfJoint:
    limit = joint.find("limit")
    if limit is None:
        return _OfJoint()

    def number(name: str, otherwise: float) -> float:
        text = limit.get(name)
        try:
            return otherwise if text is None else float(text)
        except ValueError:
            raise LoadError(f"limit of {joint.get('name')}: {name} is {text!r}") from None

    found = _OfJoint(speed=number("velocity", 0.0), torque=number("effort", 0.0))
    if joint.get("type") == "continuous":
        return found
    return replace(found, lower=number("lower", 0.0), upper=number("upper", 0.0))


def _of_mjcf(robot: str) -> Mapping[str, _OfJoint]:
    """Ranges and ranges of forces; an MJCF knows no speed limits."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(robot)
    found = {}
    for k in range(model.njnt):
        ranged = bool(model.jnt_limited[k])
        low, high = model.jnt_range[k] if ranged else (-np.inf, np.inf)
        force = float(model.jnt_actfrcrange[k, 1]) if model.jnt_actfrclimited[k] else 0.0
        found[model.joint(k).name] = _OfJoint(lower=float(low), upper=float(high), torque=force)
    return found
