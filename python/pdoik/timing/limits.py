"""What a motion has to keep to: limits of joints and of the tool, taken from arguments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from pdoik import _core

if TYPE_CHECKING:
    from pdoik.timing.curve import Curve  # which SciPy makes

FloatArray = npt.NDArray[np.float64]

_RIGID = 1e-6
_LEAST_RATE = 1e-9  # of what moves to its limit, at turning points


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Limits:
    """Limits of joints, shape (n,) each: speed, acceleration, and jerk, which may be infinite."""

    speed: FloatArray
    acceleration: FloatArray
    jerk: FloatArray


def joint_limits(
    robot: _core.Robot,
    moves: npt.NDArray[np.bool_],
    max_speed: npt.ArrayLike | None,
    max_acceleration: npt.ArrayLike | None,
    max_jerk: npt.ArrayLike | None,
) -> Limits:
    """The limits of all joints, with those of the robot; of joints that do not move they are 1.

    Raises:
        ValueError: A shape or number is wrong, or what has to be given is missing.
    """
    if max_acceleration is None:
        raise ValueError(
            "max_acceleration is missing, and robots' descriptions have none: give one for all "
            f"joints, or one for each, shape ({robot.dof},) [rad/s^2] or [m/s^2]"
        )
    speed = np.minimum(robot.velocity, _of_each(robot, "max_speed", max_speed))
    acceleration = _of_each(robot, "max_acceleration", max_acceleration)
    jerk = _of_each(robot, "max_jerk", max_jerk)
    for name, j in zip(robot.joint_names, range(robot.dof), strict=True):
        if moves[j] and not 0.0 < speed[j] < np.inf:
            what = "may not move" if speed[j] == 0.0 else "has no speed limit: give max_speed"
            raise ValueError(f"joint {name!r} moves along the path and {what}")
        if moves[j] and acceleration[j] == np.inf:
            raise ValueError(f"max_acceleration of {name!r} is infinite, expected a number")
    return Limits(
        speed=np.where(moves, speed, 1.0),
        acceleration=np.where(moves, acceleration, 1.0),
        jerk=np.where(moves, jerk, np.inf),
    )


def _of_each(robot: _core.Robot, name: str, values: npt.ArrayLike | None) -> FloatArray:
    array = np.asarray(np.inf if values is None else values, dtype=np.float64)
    if array.shape not in ((), (robot.dof,)):
        raise ValueError(f"{name} has shape {array.shape}, expected () or ({robot.dof},)")
    each = np.broadcast_to(array, (robot.dof,))
    for joint, value in zip(robot.joint_names, each, strict=True):
        if not value > 0.0:
            raise ValueError(f"{name} of {joint!r} is {value}, expected a positive number")
    return each


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Tool:
    """What of a tip is to go at a speed. Without a speed there is no limit."""

    robot: _core.Robot
    link: str
    origin: FloatArray  # (3,), in the link's frame [m]
    speed: float  # [m/s]
    turn: float  # [rad/s]

    @classmethod
    def of(
        cls,
        robot: _core.Robot,
        tip: str | None,
        T_tip_tool: npt.ArrayLike | None,
        speed: float | None,
        turn: float | None,
    ) -> Tool | None:
        """None where no speed is given.

        Raises:
            ValueError: A number or shape is wrong, there is no such link, or no speed for it.
        """
        for name, value in (("tool_speed [m/s]", speed), ("tool_turn [rad/s]", turn)):
            if value is not None and not (np.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} is {value}, expected a positive number")
        if speed is None and turn is None:
            if tip is not None or T_tip_tool is not None:
                raise ValueError("tip and T_tip_tool are given, and no tool_speed or tool_turn")
            return None
        if tip is None:
            if len(robot.tip_links) != 1:
                names = ", ".join(robot.tip_links)
                raise ValueError(f"tip is not given and the robot has several: {names}")
            tip = robot.tip_links[0]
        robot.fk(robot.mid_configuration(), tip)  # raises where there is no such link
        T = np.eye(4) if T_tip_tool is None else np.asarray(T_tip_tool, dtype=np.float64)
        if T.shape != (4, 4):
            raise ValueError(f"T_tip_tool has shape {T.shape}, expected (4, 4)")
        off = T @ np.block([[T[:3, :3].T, np.zeros((3, 1))], [0.0, 0.0, 0.0, 1.0]])
        if not np.allclose(off[:, :3], np.eye(4)[:, :3], atol=_RIGID) or T[3, 3] != 1.0:
            raise ValueError("T_tip_tool is no rigid motion")
        return cls(
            robot=robot,
            link=tip,
            origin=T[:3, 3],
            speed=np.inf if speed is None else speed,
            turn=np.inf if turn is None else turn,
        )

    def rates(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """How fast it goes and turns at joint positions and speeds (k, n): shape (k, 2)."""
        J = np.array([self.robot.jacobian(each, self.link) for each in q])
        R = np.array([self.robot.fk(each, self.link)[:3, :3] for each in q])
        twist = np.einsum("kij,kj->ki", J, dq)
        linear = twist[:, :3] + np.cross(twist[:, 3:], R @ self.origin)
        rates: FloatArray = np.linalg.norm([linear, twist[:, 3:]], axis=2).T
        return rates


@dataclass(frozen=True, slots=True, eq=False)
class Bounds:
    """Limits along a curve, of which in some regions of it only a share may be used."""

    curve: Curve
    limits: Limits
    tool: Tool | None
    edges: FloatArray  # (m,), of regions, from 0 to the curve's length
    inside: dict[str, FloatArray]  # (m - 1,), the share of each limit by region

    def acceleration(self, s: FloatArray) -> FloatArray:
        """Acceleration limits of joints, at places on the curve, shape (k, n)."""
        return self._share("acceleration", s) * self.limits.acceleration

    def jerk(self, s: FloatArray) -> FloatArray:
        """Jerk limits, the same."""
        return self._share("jerk", s) * self.limits.jerk

    def ceiling(self, s: FloatArray) -> FloatArray:
        """The largest square of ds/dt by the speeds of joints and tool, shape (k,)."""
        q1 = self.curve(s, 1)
        rates = [np.abs(q1) / self.limits.speed / self._share("speed", s)]
        if self.tool is not None:
            shares = np.hstack([self._share("tool", s), self._share("turn", s)])
            most = shares * (self.tool.speed, self.tool.turn)
            rates.append(self.tool.rates(self.curve(s), q1) / most)
        rate: FloatArray = np.hstack(rates).max(axis=1)
        return np.maximum(rate, _LEAST_RATE) ** -2.0

    def _share(self, limit: str, s: FloatArray) -> FloatArray:
        """The less of two at an edge, shape (k, 1)."""
        share = self.inside[limit]
        last = len(share) - 1
        sides = [np.searchsorted(self.edges, s, side) - 1 for side in ("left", "right")]
        least: FloatArray = np.min([share[np.clip(k, 0, last)] for k in sides], axis=0)
        return least[:, None]
