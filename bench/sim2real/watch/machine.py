"""A Panda that works all day: logs of any length by inverse dynamics, with changes that begin.

Its links are a few percent off the description, all joints rub (dry friction with presliding, so
that a joint at rest holds any torque within, and viscous), friction is another one each day and
drifts within the day, sensors are noisy. It moves from pose to pose at any pace, swings in several
joints at once, and stands. Inverse dynamics are Pinocchio's, of a machine of its own: nothing of
what is watched with is used.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pinocchio as pin

FloatArray = npt.NDArray[np.float64]

SEED = 7
ROBOT = Path(__file__).parents[3] / "cpp" / "robots" / "panda.urdf"
JOINTS = tuple(f"panda_joint{k}" for k in range(1, 8))
RATE = 100.0  # of the logs [Hz]
NEUTRAL = np.array([0.0, -0.3, 0.0, -1.9, 0.0, 1.8, 0.6])
REACH = np.array([1.4, 0.7, 1.2, 0.7, 1.4, 0.9, 1.4])  # around the neutral pose [rad]
SPEED = np.array([1.6, 1.4, 1.6, 1.6, 2.0, 2.0, 2.2])  # of the fastest motion [rad/s]
COULOMB = np.array([0.9, 1.1, 0.8, 0.9, 0.5, 0.45, 0.4])  # [N m]
VISCOUS = np.array([0.6, 0.7, 0.5, 0.5, 0.25, 0.2, 0.2])  # [N m s/rad]
ROTOR = np.array([0.5, 0.5, 0.4, 0.4, 0.15, 0.15, 0.1])  # known from data sheets [kg m^2]
PRESLIDING = 5e-4  # deflection at which a joint slides [rad]
NOISE_Q, NOISE_TAU = 1e-5, np.array([0.1, 0.1, 0.1, 0.1, 0.05, 0.05, 0.05])  # [rad], [N m]
LINKS_OFF = 0.02  # standard deviation of the links' masses, relative
DAY, HOUR = 0.04, 0.02  # standard deviations of friction from day to day, and its drift in a log


@dataclass(frozen=True, kw_only=True)
class Onset:
    """A change of the machine that begins in a log and stays."""

    kind: str  # friction, payload, offset, gain
    at: float  # [s]
    joint: int = 0  # of all but payloads
    size: float = 0.0  # factor of the friction, kg, N m, factor of the torque
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)  # of a payload, in the last joint's frame


@dataclass(frozen=True, kw_only=True)
class Log:
    """Columns of a log, (T, n), and the truth."""

    time: FloatArray
    q: FloatArray
    tau: FloatArray
    dq: FloatArray = field(repr=False)  # true speeds, not logged
    effect: FloatArray = field(repr=False)  # true torque of the onset, (T, n) [N m]

    def columns(self) -> dict[str, FloatArray]:
        table = {"time": self.time}
        for channel in ("q", "tau"):
            values = getattr(self, channel)
            table |= {f"{channel}.{name}": values[:, j] for j, name in enumerate(JOINTS)}
        return table


class Machine:
    """One machine: the same links whatever the log."""

    def __init__(self, seed: int) -> None:
        """Draws how far the links are off."""
        rng = np.random.default_rng([seed, 0])
        self.seed = seed
        self.model = pin.buildModelFromUrdf(str(ROBOT))
        held = [i for i in range(1, self.model.njoints) if self.model.names[i] not in JOINTS]
        self.model = pin.buildReducedModel(self.model, held, pin.neutral(self.model))
        for i in range(1, self.model.njoints):
            own = self.model.inertias[i]
            factor = 1.0 + LINKS_OFF * rng.normal()
            self.model.inertias[i] = pin.Inertia(own.mass * factor, own.lever, own.inertia * factor)

    def log(
        self, number: int, seconds: float, onset: Onset | None = None, *, busy: bool = False
    ) -> Log:
        """The log of this number; the same each time.

        Args:
            number: of the day.
            seconds: how long.
            onset: what begins.
            busy: whether it never stands for long, as in a motion for identification.
        """
        rng = np.random.default_rng([self.seed, 1, number])
        q, dq, ddq = motion(rng, round(seconds * RATE), busy=busy)
        time = np.arange(len(q)) / RATE
        day = 1.0 + DAY * rng.normal(size=(2, len(JOINTS)))
        hour = HOUR * np.sin(2 * np.pi * (time / rng.uniform(300, 900) + rng.uniform()))[:, None]
        coulomb, viscous = (COULOMB * day[0]) * (1 + hour), (VISCOUS * day[1]) * (1 + hour)
        friction = coulomb * presliding(q) + viscous * dq
        rigid = self._rigid(q, dq, ddq) + ROTOR * ddq
        effect = np.zeros_like(rigid)
        if onset is not None:
            since, j = int(onset.at * RATE), onset.joint
            part = slice(since, None)
            if onset.kind == "friction":
                effect[part, j] = (onset.size - 1.0) * friction[part, j]
            elif onset.kind == "offset":
                effect[part, j] = onset.size
            elif onset.kind == "gain":
                effect[part, j] = (onset.size - 1.0) * (rigid + friction)[part, j]
            elif onset.kind == "payload":
                loaded = self._loaded(onset)
                effect[part] = (
                    loaded._rigid(q[part], dq[part], ddq[part]) - (rigid - ROTOR * ddq)[part]
                )
            else:
                raise ValueError(f"no onset of kind {onset.kind!r}")
        tau = rigid + friction + effect + NOISE_TAU * rng.normal(size=q.shape)
        return Log(
            time=time, q=q + NOISE_Q * rng.normal(size=q.shape), tau=tau, dq=dq, effect=effect
        )

    def _loaded(self, onset: Onset) -> Machine:
        other = object.__new__(Machine)
        other.model = self.model.copy()
        body = pin.Inertia(onset.size, np.array(onset.com), 0.0015 * onset.size * np.eye(3))
        last = other.model.njoints - 1
        other.model.inertias[last] = other.model.inertias[last] + body
        return other

    def _rigid(self, q: FloatArray, dq: FloatArray, ddq: FloatArray) -> FloatArray:
        model, data = self.model, self.model.createData()
        return np.stack(
            [pin.rnea(model, data, *row).copy() for row in zip(q, dq, ddq, strict=True)]
        )


def presliding(q: FloatArray) -> FloatArray:
    """Dry friction over its level, -1 to 1: springs that slide (Prandtl's elements), (T, n)."""
    z = np.zeros(q.shape[1])
    out = np.zeros_like(q)
    for t, step in enumerate(np.diff(q, axis=0) / PRESLIDING, start=1):
        z = np.minimum(np.maximum(z + step, -1.0), 1.0)
        out[t] = z
    return out


def motion(rng: np.random.Generator, count: int, *, busy: bool) -> tuple[FloatArray, ...]:
    """Positions, speeds and accelerations, (count, n) each: pieces that begin and end at rest."""
    pieces, length, here = [], 0, NEUTRAL.copy()
    while length < count:
        draw = rng.uniform()
        if draw < (0.05 if busy else 0.25):
            piece = _stand(here, rng.uniform(0.2, 1.0) if busy else rng.uniform(0.5, 15.0))
        elif draw < (0.5 if busy else 0.4):
            piece = _swing(rng, here, rng.uniform(6.0, 20.0))
        else:
            piece = _go(rng, here)
        pieces.append(piece)
        here = piece[0, -1]
        length += piece.shape[1]
    q, dq, ddq = np.concatenate(pieces, axis=1)[:, :count]
    return q, dq, ddq


def _stand(here: FloatArray, seconds: float) -> FloatArray:
    held = np.zeros((3, max(1, round(seconds * RATE)), len(here)))
    held[0] = here
    return held


def _go(rng: np.random.Generator, here: FloatArray) -> FloatArray:
    """To another pose by a polynomial of fifth degree; sometimes some joints only move."""
    there = NEUTRAL + REACH * rng.uniform(-1, 1, len(here))
    there = np.where(rng.uniform(size=len(here)) < 0.25, here, there)
    pace = rng.uniform(0.2, 1.0)
    seconds = max(0.6, float(np.max(1.875 * np.abs(there - here) / (SPEED * pace))))
    T = round(seconds * RATE) / RATE
    s = np.arange(1, round(T * RATE) + 1)[:, None] / (T * RATE)
    way = there - here
    return np.stack(
        [
            here + way * (10 * s**3 - 15 * s**4 + 6 * s**5),
            way / T * (30 * s**2 - 60 * s**3 + 30 * s**4),
            way / T**2 * (60 * s - 180 * s**2 + 120 * s**3),
        ]
    )


def _swing(rng: np.random.Generator, here: FloatArray, seconds: float) -> FloatArray:
    """All joints in sines of their own, which fade in and out."""
    T = round(seconds * RATE) / RATE
    t = np.arange(1, round(T * RATE) + 1)[:, None] / RATE
    omega = 2 * np.pi * rng.uniform(0.1, 0.5, len(here))
    room = np.minimum(REACH - np.abs(here - NEUTRAL), 0.6 * SPEED / omega)
    size = np.maximum(room, 0.0) * rng.uniform(0.2, 0.9, len(here))
    fade, dfade, ddfade = _fade(t, T)
    wave, dwave, ddwave = (
        size * np.sin(omega * t),
        size * omega * np.cos(omega * t),
        -size * omega**2 * np.sin(omega * t),
    )
    return np.stack(
        [
            here + fade * wave,
            dfade * wave + fade * dwave,
            ddfade * wave + 2 * dfade * dwave + fade * ddwave,
        ]
    )


def _fade(t: FloatArray, T: float) -> tuple[FloatArray, ...]:
    """sin^2(pi t / T) and its derivatives."""
    w = 2 * np.pi / T
    return 0.5 - 0.5 * np.cos(w * t), 0.5 * w * np.sin(w * t), 0.5 * w**2 * np.cos(w * t)


def write_study(folder: Path, machine: Machine, days: int = 4, seconds: float = 60.0) -> Path:
    """A study of some days of identification motion, the last of them held out."""
    folder.mkdir(parents=True, exist_ok=True)
    entries = []
    for day in range(days):
        table = machine.log(day, seconds, busy=True).columns()
        np.savetxt(
            folder / f"day{day}.csv",
            np.column_stack(list(table.values())),
            fmt="%.7g",
            delimiter=",",
            header=",".join(table),
            comments="",
        )
        role = "validate" if day == days - 1 else "fit"
        entries.append(f"  - {{file: day{day}.csv, role: {role}, session: day{day}}}")
    path = folder / "study.yaml"
    path.write_text(
        f"robot: {ROBOT}\njoints: [{', '.join(JOINTS)}]\nrecordings:\n"
        + "\n".join(entries)
        + "\ntrust: {rigid_body: 0.05}"
        + f"\nrotor_inertia: [{', '.join(f'{i:g}' for i in ROTOR)}]\n"
    )
    return path
