"""What a controller may feed forward: the model along a recording, of all joints at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pdoik.recordings import FloatArray, Recording

from ..motion import RigidBody, derivative, zero_phase

_SMOOTH = 10.0  # of a command's rates, and of errors' [Hz]
_RATE = 50.0  # at which the model is worked out; between, straight lines [Hz]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Feed:
    """The model's part in a recording; (T, n) but where said."""

    gravity: FloatArray  # torque at rest [N m]
    inertia: FloatArray  # torque for the commanded acceleration, rotors with it [N m]
    mass: FloatArray  # inertia that a joint sees with the others at rest [kg m^2]
    others: FloatArray  # (T, n, 2) by the other joints' errors and error speeds, as accelerations


class Feeds:
    """Feeds of recordings, each worked out once."""

    def __init__(self, body: RigidBody | None) -> None:
        self._body = body
        self._known: dict[tuple[str, int], Feed | None] = {}

    def of(self, r: Recording) -> Feed | None:
        """The feed of a recording; None without a known body, or where a joint was not logged."""
        key = (r.name, len(r.time))
        if key not in self._known:
            self._known[key] = self._worked_out(r)
        return self._known[key]

    def _worked_out(self, r: Recording) -> Feed | None:
        if self._body is None or r.q_des is None:
            return None
        if not (np.isfinite(r.q).all() and np.isfinite(r.q_des).all()):
            return None
        body, count = self._body, len(r.time)
        rows = np.unique(np.r_[0 : count : max(1, int(1.0 / (_RATE * r.period))), count - 1])
        gravity = _between(rows, body.gravity(r.q[rows]), count)
        mass = _between(rows, body.mass_matrices(r.q[rows]), count)
        smooth = zero_phase(r.q_des, _SMOOTH, r.period)
        wanted = derivative(derivative(smooth, r.period), r.period)
        error = r.q_des - r.q
        speed = derivative(zero_phase(error, _SMOOTH, r.period), r.period)
        own = np.diagonal(mass, axis1=1, axis2=2)
        others = [np.einsum("tij,tj->ti", mass, each) - own * each for each in (error, speed)]
        return Feed(
            gravity=gravity,
            inertia=np.einsum("tij,tj->ti", mass, wanted) + body.rotor * wanted,
            mass=own,
            others=np.stack(others, axis=2),
        )


def _between(rows: np.ndarray, values: FloatArray, count: int) -> FloatArray:
    """Values at some rows, straight lines between; (count, ...)."""
    flat = values.reshape(len(rows), -1)
    every = np.arange(count)
    columns = [np.interp(every, rows, column) for column in flat.T]
    return np.stack(columns, axis=1).reshape(count, *values.shape[1:])
