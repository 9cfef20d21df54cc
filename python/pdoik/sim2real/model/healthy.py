"""What the model leaves of a healthy machine's torques: the floor that `watch` holds to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from pdoik.recordings import FloatArray

VARIANCE = 4
"""Coefficients of a variance: of 1, and of the squares of speed, of inertial torque, of torque."""

CHARTS = 3
"""Columns that a joint's residual is compared with."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Healthy:
    """Figures of each joint's residual in logs without a fault."""

    logs: tuple[str, ...]  # they come from
    held_out: bool  # whether the findings were not fitted to these
    position_noise: FloatArray  # (n,) density of white noise in positions [rad^2/Hz]
    seconds: FloatArray  # (n,) of motion [s]
    variance: FloatArray  # (n, 4), see VARIANCE [(N m)^2 and per unit of each]
    friction: FloatArray  # (n,) root mean square of the friction that is known [N m]
    friction_off: FloatArray  # (n, 2) Coulomb [N m] and viscous [N m s/rad], less the model's
    speed: FloatArray  # (n,) root mean square of moving joints [rad/s]
    scale: FloatArray  # (n, 3) root mean square of each chart's column
    power: FloatArray  # (n, 3) mean square of the column over scale and noise [1/(N m)^2]
    density: FloatArray  # (n, 3) of the residual's noise along the column, at frequency zero [s]
    bias: FloatArray  # (n, 3) root mean square of the column's coefficient in healthy logs [N m]
    bodies_off: FloatArray  # (10 L,) inertial parameters of the links, less the model's
    bodies_covariance: FloatArray  # (10 L, 10 L); both are empty where none were learnt

    def variance_at(self, features: FloatArray) -> FloatArray:
        """Variance of the residual's noise at rows with these features, (N, n) [(N m)^2]."""
        return np.asarray(np.einsum("tjk,jk->tj", features, self.variance), dtype=np.float64)

    def content(self) -> dict[str, Any]:
        """The figures as plain data."""
        arrays = {name: getattr(self, name).tolist() for name in (*_SHAPES, *_BODIES)}
        return {"logs": list(self.logs), "held_out": self.held_out, **arrays}

    @classmethod
    def of_content(cls, content: Any, n: int) -> Healthy:
        """The figures of plain data, for n joints.

        Raises:
            KeyError, ValueError, TypeError: it is none.
        """
        arrays = {}
        for name, tail in _SHAPES.items():
            given = content.get(name, _UNKNOWN[name] * n) if name in _UNKNOWN else content[name]
            array = np.array(given, dtype=np.float64)
            if array.shape != (n, *tail):
                raise ValueError(f"{name}: expected shape {(n, *tail)}, got {array.shape}")
            arrays[name] = array
        for name in _BODIES:
            arrays[name] = np.array(content.get(name, []), dtype=np.float64)
        k = arrays["bodies_off"].size
        if arrays["bodies_covariance"].size != k * k:
            raise ValueError(f"bodies_covariance: expected {k} by {k} numbers")
        arrays["bodies_covariance"] = arrays["bodies_covariance"].reshape(k, k)
        logs = tuple(str(each) for each in content["logs"])
        return cls(logs=logs, held_out=bool(content["held_out"]), **arrays)


_SHAPES: dict[str, tuple[int, ...]] = {
    "position_noise": (),
    "seconds": (),
    "variance": (VARIANCE,),
    "friction": (),
    "friction_off": (2,),
    "speed": (),
    "scale": (CHARTS,),
    "power": (CHARTS,),
    "density": (CHARTS,),
    "bias": (CHARTS,),
}

_BODIES = ("bodies_off", "bodies_covariance")

_UNKNOWN: dict[str, list[Any]] = {"friction_off": [[0.0, 0.0]], "speed": [1.0]}
"""Per joint, in models that were written before these were kept."""
