"""Motors that are given a share of their supply: what torque a duty is.

    tau = k V u (1 - s |u|) - b dq,    0 where the drive has let go

with the supply V, of which full duty loses the share s, and the back-EMF's torque b dq. All beside
the model's torque, friction, a rotor and a zero that is off, linear in what is sought:

    V u = (tau_model + J ddq + friction) / k + (b / k) dq + s V u |u|

Only ratios to the model's own torque are seen so: of a model twice as heavy k, b, J and friction
are twice as large. A `torque_per_volt` that the study tells settles it; then the model's gravity
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
from ..motion.balances import Balances
from ..motion.motion import Motion
from ..motion.signals import derivative, zero_phase
from ..regression.clusters import clustered
from ..study.controller import ToldController
from ..thresholds.controllers import ControllerThresholds

_SUPPLY = 1.0  # a supply's slower changes are its own, quicker ones are the bridge's switching [Hz]
_LOW, _PARTS = 0.1, 8  # quantile of readings that are of pulses; parts by which its error is told
_MOST_LOSS = 0.6  # share of the supply lost at full duty
_LEAST_LOSS_ERROR = 0.1  # of that share: a reading is of one instant, and a cable rings
_NOMINAL = 1.0  # supply where none is known: torques are per full duty then [V]


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A figure and its standard error."""

    value: float
    std: float

    def estimate(self, unit: str) -> Estimate:
        """With its interval."""
        return Estimate.normal(self.value, self.std, unit)


@dataclass(frozen=True, slots=True, kw_only=True)
class Motor:
    """One joint's motor, and how its load's gravity and inertia stand to the model's."""

    torque_per_volt: Figure  # [N m/V]
    back_emf: Figure  # torque lost per speed [N m s/rad]
    supply_loss: Figure  # share of the supply lost at full duty
    rotor_inertia: Figure  # at the joint [kg m^2]; negative where the load is told too long
    gravity: Figure  # factor of the model's; 1 where nothing tells the torque's scale
    inertia: Figure  # the same of the inertia
    told: bool  # whether torque_per_volt is the study's
    told_rotor: bool  # whether the rotor's inertia is

    @property
    def rotor(self) -> Figure:
        """The rotor's inertia as it may be."""
        return replace(self.rotor_inertia, value=max(self.rotor_inertia.value, 0.0))

    def torque(
        self, duty: FloatArray, volts: FloatArray, dq: FloatArray, released: NDArray[np.bool_]
    ) -> FloatArray:
        """Of duties (T,) [N m]."""
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


def supply(recording: Recording, j: int, told: ToldController | None) -> FloatArray:
    """Volts of joint j's supply without the bridge's switching, (T,)."""
    if recording.voltage is not None and np.isfinite(recording.voltage[:, j]).all():
        return zero_phase(recording.voltage[:, j], _SUPPLY, recording.period)
    volts = told.volts if told is not None and told.volts else _NOMINAL
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
    halves = [line(part) for part in np.array_split(every, _PARTS) if np.ptp(u[part]) > 0.05]
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
    b: Balances, j: int, told: ToldController | None, limits: ControllerThresholds
) -> Motor | None:
    """The motor that fits the model best, beside friction; None where nothing moves.

    Where the study tells the torque per volt, the model's gravity and inertia have factors instead.
    """
    key = ("torque", j)
    if key not in b.residual or not b.excited[j]:
        return None
    free = any(let_go(m.recording, j).any() for m in b.motions)
    keep = b.mask[key]
    parts = [_columns(m, j, told) for m in b.motions]
    rows = np.concatenate([b.thin(i, part) for i, part in enumerate(parts)])[keep]
    y, A = rows[:, 0], rows[:, 1:].copy()
    if len(rows) < limits.least_rows // 10 or not np.any(A[:, _GRAVITY]):
        return None
    known = _told(told, j)
    body = b.motions[0].body
    rotor = 0.0 if body is None else float(body.rotor[j])
    lower, upper = _LOWER.copy(), _UPPER.copy()
    scale_told = "torque_per_volt" in known
    if not scale_told:  # only the whole is seen
        A[:, _GRAVITY] += A[:, _INERTIA] + rotor * A[:, _ROTOR]
        upper[_INERTIA] = 1e-12
    if rotor:
        fixed = rotor / known["torque_per_volt"] if scale_told else 0.0
        lower[_ROTOR], upper[_ROTOR] = fixed - 1e-12, fixed + 1e-12
    if not free:
        upper[_VISCOUS] = 1e-12
    if scale_told and "back_emf" in known:
        emf = known["back_emf"] / known["torque_per_volt"]
        lower[_EMF], upper[_EMF] = emf - 1e-12, emf + 1e-12
    if "supply_loss" in known:
        loss = known["supply_loss"]
        lower[_LOSS], upper[_LOSS] = loss - 1e-12, loss + 1e-12
    beta = _bounded(A, y, lower, upper)
    block = b.block[keep]
    read = sag([m.recording for m in b.motions], j)
    if read is not None and "supply_loss" not in known:
        # What readings say of the loss weighs as a row; rows near in time are one.
        weight = float(np.std(y - A @ beta)) * np.sqrt(len(y) / len(np.unique(block))) / read[1]
        row = np.zeros(A.shape[1])
        row[_LOSS] = weight
        A, y = np.vstack([A, row]), np.append(y, weight * read[0])
        block = np.append(block, block.max() + 1)
        beta = _bounded(A, y, lower, upper)
    std = _errors(A, y - A @ beta, block, lower, upper, beta)
    if scale_told:
        k = Figure(value=known["torque_per_volt"], std=0.0)
        gravity, inertia = (
            Figure(value=float(k.value * beta[at]), std=float(k.value * std[at]))
            for at in (_GRAVITY, _INERTIA)
        )
    else:
        k = Figure(
            value=float(1.0 / beta[_GRAVITY]), std=float(std[_GRAVITY] / beta[_GRAVITY] ** 2)
        )
        gravity = inertia = Figure(value=1.0, std=0.0)
    if not rotor:
        turning = Figure(value=float(k.value * beta[_ROTOR]), std=float(k.value * std[_ROTOR]))
    else:
        turning = Figure(value=rotor, std=0.0)
    return Motor(
        torque_per_volt=k,
        back_emf=Figure(value=float(k.value * beta[_EMF]), std=float(k.value * std[_EMF])),
        supply_loss=Figure(value=float(beta[_LOSS]), std=float(std[_LOSS])),
        rotor_inertia=turning,
        gravity=gravity,
        inertia=inertia,
        told=scale_told,
        told_rotor=bool(rotor),
    )


def with_torque(
    recordings: Sequence[Recording],
    motors: Sequence[Motor | None],
    told: ToldController | None,
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
                tau[:, j] = motor.torque(r.duty[:, j], supply(r, j, told), dq[:, j], let_go(r, j))
        result.append(replace(r, tau=tau))
    return tuple(result)


_GRAVITY, _INERTIA, _ROTOR, _SIGN, _THROUGH, _ZERO, _EMF, _LOSS, _VISCOUS = range(9)
_LOWER = np.array([1e-6, 0.0, -np.inf, 0.0, 0.0, -np.inf, 0.0, 0.0, 0.0])
_UPPER = np.array([np.inf] * 7 + [_MOST_LOSS, np.inf])


def _columns(m: Motion, j: int, told: ToldController | None) -> FloatArray:
    """Volts given, then what they are made of (see the module), (T, 10)."""
    r = m.recording
    assert r.duty is not None
    assert m.body is not None
    on = ~let_go(r, j)
    given = r.duty[:, j] * supply(r, j, told) * on
    gravity = m.body.gravity(m.q)[:, j]
    rigid = m.load(j)
    lost = given * np.abs(r.duty[:, j])
    speed, sign = m.dq[:, j], m.sign(j)
    made_of = [gravity, rigid - gravity, m.ddq[:, j], sign, np.abs(rigid) * sign]
    made_of += [m.dtau_dq[:, j, j], speed * on, lost, speed]
    return np.stack([given, *made_of], axis=1)


def _told(told: ToldController | None, j: int) -> dict[str, float]:
    """Figures of the drive that the study tells."""
    if told is None:
        return {}
    each = {
        "torque_per_volt": told.torque_per_volt,
        "back_emf": told.back_emf,
        "supply_loss": told.supply_loss,
    }
    return {name: float(values[j]) for name, values in each.items() if values is not None}


def _bounded(A: FloatArray, y: FloatArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    scale = np.sqrt(np.mean(A**2, axis=0)) + 1e-9
    found = optimize.lsq_linear(A / scale, y, (lower * scale, upper * scale), method="bvls")
    return np.asarray(found.x / scale, dtype=np.float64)


def _errors(
    A: FloatArray,
    left: FloatArray,
    block: NDArray[np.intp],
    lower: FloatArray,
    upper: FloatArray,
    beta: FloatArray,
) -> FloatArray:
    """Standard errors of what lies on no bound, blocks as clusters."""
    span = 1e-6 * (np.abs(beta) + 1e-9)
    free = (beta > lower + span) & (beta < upper - span)
    std = np.zeros(len(beta))
    if not free.any():
        return std
    scale = np.sqrt(np.mean(A[:, free] ** 2, axis=0)) + 1e-12
    even = A[:, free] / scale
    inverse = np.linalg.pinv(even.T @ even, hermitian=True)
    covariance, count = clustered(inverse, even, left, block)
    covariance *= count / max(count - even.shape[1], 1)
    std[free] = np.sqrt(np.maximum(np.diag(covariance), 0.0)) / scale
    return std
