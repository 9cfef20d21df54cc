"""Motors that are given a share of their supply: what torque a duty is.

    tau = k V u (1 - s |u|) - b dq,    0 where the drive has let go

with the supply V, of which full duty loses the share s, and the back-EMF's torque b dq. All with
the model's torque, friction, a rotor and a zero that is off, linear in what is sought:

    V u = (tau_model + J ddq + friction) / k + (b / k) dq + s V u |u|

Only ratios to the model's own torque are seen so: of a model twice as heavy k, b, J and friction
are twice as large. A `torque_per_volt` that the study gives settles it; then the model's gravity
and inertia each have a factor of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import optimize

from pdoik.recordings import FloatArray, Recording

from ..findings import Estimate
from ..motion import Balances, Motion, derivative, zero_phase
from ..study import GivenController
from ..thresholds import ControllerThresholds
from .linear_law import LinearModel, Parameter, parts_of

_THINNED = 10  # numerics: rows of a log to one that says something of a voltage
_LOADED = 0.05  # numerics: range of duties that a supply's loss shows in
_SUPPLY = 1.0  # a supply's slower changes are its own, quicker ones are the bridge's switching [Hz]
_LOW, _PARTS = 0.1, 8  # quantile of readings that are of pulses; parts by which its error is found
_MOST_LOSS, _USUAL_LOSS = 0.6, 0.3  # share of the supply lost at full duty; where none is read
_LEAST_LOSS_ERROR = 0.1  # of that share: a reading is of one instant, and a cable rings
_NOMINAL = 1.0  # supply where none is known: torques are per full duty then [V]


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A figure and its standard error."""

    value: float
    std: float

    def estimate(self, unit: str) -> Estimate:
        """The figure with its interval."""
        return Estimate.normal(self.value, self.std, unit)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """One joint's motor, and how its load's gravity and inertia stand to the model's."""

    torque_per_volt: Figure  # [N m/V]
    back_emf: Figure  # torque lost per speed [N m s/rad]
    supply_loss: Figure  # share of the supply lost at full duty
    rotor_inertia: Figure  # at the joint [kg m^2]; negative where the load is given too long
    gravity: Figure  # factor of the model's; 1 where nothing gives the torque's scale
    inertia: Figure  # the same of the inertia
    given: bool  # whether torque_per_volt is the study's
    given_rotor: bool  # whether the rotor's inertia is

    @property
    def rotor(self) -> Figure:
        """The rotor's inertia as it may be."""
        return replace(self.rotor_inertia, value=max(self.rotor_inertia.value, 0.0))

    def torque(
        self, duty: FloatArray, volts: FloatArray, dq: FloatArray, released: NDArray[np.bool_]
    ) -> FloatArray:
        """Torque of duties (T,), (T,) [N m]."""
        kept = 1.0 - self.supply_loss.value * np.abs(duty)
        given = self.torque_per_volt.value * volts * duty * kept
        return np.where(released, 0.0, given - self.back_emf.value * dq)

    def estimates(self) -> dict[str, Estimate]:
        """Figures of the drive by name."""
        return {
            "torque_per_volt": self.torque_per_volt.estimate("N m/V"),
            "back_emf": self.back_emf.estimate("N m s/rad"),
            "supply_loss": self.supply_loss.estimate("-"),
            "rotor_inertia": self.rotor.estimate("kg m^2"),
        }


def supply(recording: Recording, j: int, controller: GivenController | None) -> FloatArray:
    """Volts of joint j's supply without the bridge's switching, (T,)."""
    if recording.voltage is not None and np.isfinite(recording.voltage[:, j]).all():
        return zero_phase(recording.voltage[:, j], _SUPPLY, recording.period)
    volts = controller.volts if controller is not None and controller.volts else _NOMINAL
    return np.full(len(recording.time), volts)


def sag(recordings: Sequence[Recording], j: int) -> tuple[float, float] | None:
    """Share of the supply lost at full duty by its own readings, and its error; None without any.

    A reading falls between the bridge's pulses or into one: the lowest tenth of those at a duty are
    of the pulses (Koenker and Bassett's regression of that quantile over the duty).
    """
    duty, volts = [], []
    for r in recordings:
        if r.voltage is None or r.duty is None or not np.isfinite(r.voltage[:, j]).all():
            return None
        volts.append(r.voltage[:, j] / np.median(r.voltage[:, j]))
        duty.append(np.abs(r.duty[:, j]))
    u, v = np.concatenate(duty), np.concatenate(volts)

    def line(pick: NDArray[np.intp]) -> float:
        def pinball(x: FloatArray) -> float:
            over = v[pick] - x[0] * (1.0 - x[1] * u[pick])
            return float(np.mean(np.where(over > 0.0, _LOW * over, (_LOW - 1.0) * over)))

        return float(optimize.minimize(pinball, [1.0, 0.1], method="Nelder-Mead").x[1])

    every = np.arange(len(u))
    halves = [line(part) for part in np.array_split(every, _PARTS) if np.ptp(u[part]) > _LOADED]
    if len(halves) < 2:
        return None
    error = float(np.std(halves, ddof=1) / np.sqrt(len(halves)))
    return float(np.clip(line(every), 0.0, _MOST_LOSS)), max(error, _LEAST_LOSS_ERROR)


def let_go(recording: Recording, j: int) -> NDArray[np.bool_]:
    """Samples at which joint j's drive has let go, (T,)."""
    if recording.released is None:
        return np.zeros(len(recording.time), dtype=np.bool_)
    return np.ascontiguousarray(recording.released[:, j])


def motor_of(
    b: Balances, j: int, controller: GivenController | None, limits: ControllerThresholds
) -> Motor | None:
    """The motor that fits the model best, with friction; None where nothing moves.

    Where the study gives the torque per volt, the model's gravity and inertia have factors instead.
    """
    key = ("torque", j)
    if key not in b.residual or not b.excited[j]:
        return None
    keep, parts = b.mask[key], [_columns(m, j, controller) for m in b.motions]
    thin = [b.thin(i, part) for i, part in enumerate(parts)]
    rows = dict(zip(_NAMES, np.concatenate(thin)[keep].T, strict=True))
    volts = rows.pop("volts")
    if len(volts) < limits.least_rows // _THINNED or not np.any(rows["gravity"]):
        return None
    given, body = _given(controller, j), b.motions[0].body
    k = given.pop("torque_per_volt", None)
    rotor = 0.0 if body is None else float(body.rotor[j])
    if k is None:  # only the whole of the load is seen, a rotor that is known with it
        rows["gravity"] = rows["gravity"] + rows.pop("inertia") + rotor * rows["rotor_inertia"]
        given.pop("back_emf", None)
    if rotor:
        given["rotor_inertia"] = rotor if k else 0.0
    if not any(let_go(m.recording, j).any() for m in b.motions):
        del rows["viscous"]
    for name, value in given.items():
        volts = volts - (value if name == "supply_loss" else value / (k or 1.0)) * rows.pop(name)
    counts = [int(part.sum()) for part in np.split(keep, np.cumsum([len(t) for t in thin])[:-1])]
    plain = LinearModel(
        target=volts,
        parameters=tuple(
            Parameter(name=name, columns=column, positive=name in _POSITIVE)
            for name, column in rows.items()
        ),
        parts=parts_of(counts),
    )
    # What friction's law misses is as slow as a block: what is read counts more against such rows.
    weight = min(float(np.sqrt(len(np.unique(b.block[keep])) / plain.rows)), 1.0)
    mean, std = sag([m.recording for m in b.motions], j) or (0.0, _USUAL_LOSS)
    model = plain.with_prior("supply_loss", mean, weight * std)
    per = model.value("gravity")
    if per <= 0.0:
        return None

    def figure(name: str, scale: float) -> Figure:
        if name not in rows:
            return Figure(value=given[name], std=0.0)
        return Figure(value=scale * model.value(name), std=scale * model.std(name))

    scale, one = k or 1.0 / per, Figure(value=1.0, std=0.0)
    turning = Figure(value=rotor, std=0.0) if rotor else figure("rotor_inertia", scale)
    return Motor(
        torque_per_volt=Figure(value=scale, std=0.0 if k else model.std("gravity") / per**2),
        back_emf=figure("back_emf", scale),
        supply_loss=figure("supply_loss", 1.0),
        rotor_inertia=turning,
        gravity=figure("gravity", scale) if k else one,
        inertia=figure("inertia", scale) if k else one,
        given=bool(k),
        given_rotor=bool(rotor),
    )


def with_torque(
    recordings: Sequence[Recording],
    motors: Sequence[Motor | None],
    controller: GivenController | None,
    cutoff: float,
) -> tuple[Recording, ...]:
    """Recordings with torques in place of duties, where a joint's motor is known."""
    result = []
    for r in recordings:
        assert r.duty is not None
        dq = derivative(zero_phase(r.q, cutoff, r.period), r.period)
        tau = np.full_like(r.q, np.nan)
        for j, motor in enumerate(motors):
            if motor is not None:
                tau[:, j] = motor.torque(
                    r.duty[:, j], supply(r, j, controller), dq[:, j], let_go(r, j)
                )
        result.append(replace(r, tau=tau))
    return tuple(result)


_NAMES = (
    *("volts", "gravity", "inertia", "rotor_inertia", "sign", "through"),
    *("zero", "back_emf", "supply_loss", "viscous"),
)
_POSITIVE = ("gravity", "inertia", "sign", "through", "back_emf", "supply_loss", "viscous")


def _columns(m: Motion, j: int, controller: GivenController | None) -> FloatArray:
    """Volts given, then what they are made of (see the module), (T, 10)."""
    r = m.recording
    assert r.duty is not None
    assert m.body is not None
    on = ~let_go(r, j)
    given = r.duty[:, j] * supply(r, j, controller) * on
    gravity = m.body.gravity(m.q)[:, j]
    rigid = m.load(j)
    lost = given * np.abs(r.duty[:, j])
    speed, sign = m.dq[:, j], m.sign(j)
    made_of = [gravity, rigid - gravity, m.ddq[:, j], sign, np.abs(rigid) * sign]
    made_of += [m.dtau_dq[:, j, j], speed * on, lost, speed]
    return np.stack([given, *made_of], axis=1)


def _given(controller: GivenController | None, j: int) -> dict[str, float]:
    """Figures of the drive that the study gives."""
    if controller is None:
        return {}
    each = {
        "torque_per_volt": controller.torque_per_volt,
        "back_emf": controller.back_emf,
        "supply_loss": controller.supply_loss,
    }
    return {name: float(values[j]) for name, values in each.items() if values is not None}
