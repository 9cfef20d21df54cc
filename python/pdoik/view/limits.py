"""Which joint is nearest to a limit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import pdoik

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class NearestLimit:
    """The joint that has the least share of its range left on one side."""

    joint: int
    side: str  # "lower" or "upper"
    distance: float  # negative beyond it [rad] or [m]
    share: float  # of the range


def nearest_limit(robot: pdoik.Robot, q: FloatArray) -> NearestLimit | None:
    """Nearest limit of any joint; None where no joint has limits."""
    lower, upper = np.asarray(robot.lower), np.asarray(robot.upper)
    width = upper - lower
    limited = np.isfinite(width) & (width > 0)
    if not limited.any():
        return None
    left = np.full(len(q), np.inf)
    left[limited] = (np.minimum(q - lower, upper - q)[limited]) / width[limited]
    joint = int(left.argmin())
    below, above = float(q[joint] - lower[joint]), float(upper[joint] - q[joint])
    return NearestLimit(
        joint=joint,
        side="lower" if below < above else "upper",
        distance=min(below, above),
        share=float(left[joint]),
    )


def amount_text(limit: NearestLimit, robot: pdoik.Robot) -> str:
    """'3.1° to its upper limit', or past it."""
    if robot.joint_types[limit.joint] == "prismatic":
        amount = f"{1e3 * abs(limit.distance):.1f} mm"
    else:
        amount = f"{np.degrees(abs(limit.distance)):.1f}°"
    return f"{amount} {'to' if limit.distance >= 0 else 'past'} its {limit.side} limit"


def limit_text(limit: NearestLimit, robot: pdoik.Robot) -> str:
    """'panda_joint4, 3.1° to its upper limit (1 % of its range)'."""
    share = f"{100 * limit.share:.0f} % of its range"
    return f"{robot.joint_names[limit.joint]}, {amount_text(limit, robot)} ({share})"
