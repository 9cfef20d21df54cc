"""What a law may be made of: columns over the samples of a joint's recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from pdoik.recordings import FloatArray, Recording

from ..motion import RigidBody, derivative, shifted, zero_phase
from ..thresholds import ControllerThresholds

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


EFFORTS = {"tau_cmd": "N m", "duty": "1", "tau": "N m", "current": "A"}
"""Channels of effort and their units, the nearest to what a controller puts out first."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Piece:
    """One recording of one joint; arrays are (T,)."""

    name: str
    period: float
    q: FloatArray
    q_des: FloatArray
    dq: FloatArray
    dq_des: FloatArray  # zero where it was not logged
    rate: FloatArray  # of q_des; zero where dq_des was logged
    effort: FloatArray
    gravity: FloatArray  # torque of the model at rest [N m]
    inertia: FloatArray  # torque of the model for the commanded acceleration [N m]
    mass: FloatArray  # of the joint by the model, zero where nobody knows [kg m^2]
    others: FloatArray  # (T, 2) the model's torque for the other joints' errors and error speeds
    use: NDArray[np.bool_]  # samples that count

    @property
    def error(self) -> FloatArray:
        """Error of position, (T,)."""
        return self.q_des - self.q

    @property
    def speed_error(self) -> FloatArray:
        """Error of speed: minus the speed where no desired one was logged, (T,)."""
        return self.dq_des - self.dq

    def column(self, name: str) -> FloatArray:
        """A part of a law, (T,)."""
        if name == "integral":
            return np.asarray(np.cumsum(self.error) * self.period, dtype=np.float64)
        if name == "travel":
            return np.asarray(self.q[0] - self.q, dtype=np.float64)
        if name.startswith("knee"):
            beyond = np.maximum(np.abs(self.error) - float(name.removeprefix("knee ")), 0.0)
            return np.asarray(np.sign(self.error) * beyond, dtype=np.float64)
        values: FloatArray = getattr(self, name)
        return values

    def commanded_late(self, delay: float) -> Self:
        """The piece with commands, and the torque for them, so much later [s]."""
        if delay <= 0.0:
            return self
        late = np.stack([self.q_des, self.dq_des, self.rate, self.inertia], axis=1)
        q_des, dq_des, rate, inertia = shifted(late, delay, self.period).T
        return replace(self, q_des=q_des, dq_des=dq_des, rate=rate, inertia=inertia)


def effort_of(recordings: Sequence[Recording], j: int) -> str:
    """The channel from which joint j's law can be seen; "" without one, or without a command."""

    def has(channel: str) -> bool:
        each = [getattr(r, channel) for r in recordings]
        return all(values is not None and np.isfinite(values[:, j]).all() for values in each)

    if not recordings or not has("q_des"):
        return ""
    return next((channel for channel in EFFORTS if has(channel)), "")


def pieces_of(
    recordings: Sequence[Recording],
    j: int,
    effort: str,
    feeds: Feeds,
    limits: ControllerThresholds,
    most: int | None = None,
) -> tuple[Piece, ...]:
    """The recordings of joint j, their first samples up to `most`."""
    most = limits.most_rows // max(len(recordings), 1) if most is None else most
    return tuple(_piece(r, j, effort, feeds, limits, most) for r in recordings)


def _piece(
    r: Recording,
    j: int,
    effort: str,
    feeds: Feeds,
    limits: ControllerThresholds,
    most: int,
) -> Piece:
    assert r.q_des is not None
    count = min(len(r.time), most)
    part = slice(0, count)
    speed = r.dq if r.dq is not None and np.isfinite(r.dq[:, j]).all() else None
    dq = derivative(r.q, r.period)[part, j] if speed is None else speed[part, j]
    rate, dq_des = derivative(r.q_des[:, j], r.period)[part], np.zeros(count)
    if r.dq_des is not None and np.isfinite(r.dq_des[:, j]).all():
        rate, dq_des = dq_des, r.dq_des[part, j]
    gravity = inertia = mass = np.zeros(count)
    others = np.zeros((count, 2))
    model = feeds.of(r) if effort in ("tau_cmd", "tau") else None
    if model is not None:
        gravity, inertia = model.gravity[part, j], model.inertia[part, j]
        mass, others = model.mass[part, j], model.others[part, j]
    use = r.valid[part].copy()
    use[: int(limits.settling / r.period)] = False
    values: FloatArray = getattr(r, effort)
    if r.released is not None:
        use &= ~r.released[part, j]
    return Piece(
        name=r.name,
        period=r.period,
        q=r.q[part, j],
        q_des=r.q_des[part, j],
        dq=dq,
        dq_des=dq_des,
        rate=rate,
        effort=values[part, j],
        gravity=gravity,
        inertia=inertia,
        mass=mass,
        others=others,
        use=use,
    )
