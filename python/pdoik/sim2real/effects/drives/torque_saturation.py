"""A drive that gives no more than a certain torque, whatever is commanded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from pdoik.recordings import FloatArray

from ...motion import Columns, FlatTop, Motion, Place, Shape, flat_top, zero_phase
from ...simulation import DriveChange, Part
from ..effect import Effect, Example, Parameter
from ..site import Site

OF_REPORTED, OF_COMMAND, OF_LAW = 0.0, 1.0, 2.0
"""First entry of a shape: what is larger than the torque truly given."""


class TorqueSaturation(Effect):
    """tau = clip(tau_cmd, -L, L)."""

    id = "torque_saturation"
    family = "torque"
    on = "joint"
    equation = "tau = clip(tau_cmd, -L, L)"
    parameters = (Parameter("level", "N m", lower=0.0),)
    confused_with = ("torque_gain", "actuator_lag", "torque_speed_limit")
    decided_by = "one motion that asks for more torque than this, recorded with its command"
    source = "drive data sheet"
    at_top = 0.1  # share of a flat top by which its level may be off
    near_top = 0.15  # the same of a level that was fitted
    needed, passed = 0.8, 1.06  # shares of a level that a motion needs at least, and passes nowhere
    least_reached = 12  # samples that reach it
    missed = 0.5  # share of what is cut off by which the model may miss it
    example = Example(values={"level": 9.0}, place=Place(joints=(0,)), nothing={"level": 1e9})
    fixed = True
    least_of_rest = 0.5
    complexity = 2
    against = "load"
    size_first = True
    makes_up_for_misfit = True
    of_commands = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """The flat top's level; where the torque given was not recorded, levels below the peak."""
        (j,) = place.joints
        shapes: list[Shape] = []
        for kind in kinds(motions[0], j):
            top = top_of(motions, j, kind)
            shapes += [(kind, top.level)] if top is not None else []
        if motions[0].source:
            asked = np.concatenate([np.abs(asked_of(m, j, OF_REPORTED)) for m in motions])
            if np.isfinite(asked).all():
                levels = np.quantile(asked, (0.7, 0.85, 0.93, 0.97, 0.985, 0.993, 0.997, 0.999))
                shapes += [(OF_REPORTED, float(level)) for level in levels if level > 0.0]
        return shapes

    def asked(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Shapes for what was recorded in addition to the applied torque, or stands for it."""
        first, (j,) = motions[0], place.joints
        commanded = kinds(first, j) or ([OF_REPORTED] if first.source in ("tau_cmd", "law") else [])
        return [(kind, np.inf) for kind in commanded]

    def of_amount(
        self, amount: float, motions: Sequence[Motion], place: Place, shape: Shape, width: int
    ) -> tuple[Shape, FloatArray]:
        """The level that a share of the time would be cut at, the amount."""
        (j,) = place.joints
        torques = np.concatenate([np.abs(asked_of(m, j, shape[0])) for m in motions])
        return (shape[0], float(np.quantile(torques, 1.0 - amount))), np.ones(1)

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """What is missing beyond the level."""
        (j,) = place.joints
        kind, level = shape
        asked = asked_of(motion, j, kind)
        beyond = asked - np.clip(asked, -level, level)
        if kind == OF_COMMAND:
            return {("drive", j): -beyond[:, None]}
        if kind == OF_LAW:
            return {("law", j): -beyond[:, None]}
        return {("torque", j): beyond[:, None]}

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The level."""
        return {"level": shape[1]}

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Near the level found first."""
        kind, level = shape
        within = 0.2 if kind == OF_REPORTED else self.at_top
        return [(kind, kind), ((1.0 - within) * level, level / (1.0 - within))]

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The coefficient is 1."""
        return (shape[0] if shape else OF_COMMAND, values["level"]), np.ones(1)

    def variant(self, shape: Shape) -> str:
        """What is larger than the torque given."""
        return {OF_REPORTED: "reported torque", OF_COMMAND: "command", OF_LAW: "law"}[shape[0]]

    def plausible(self, motions: Sequence[Motion], place: Place, shape: Shape) -> bool:
        """Whether what is given has a flat top there; by the model, whether it never exceeds it."""
        (j,) = place.joints
        kind, level = shape
        if kind != OF_REPORTED:
            top = top_of(motions, j, kind)
            return top is not None and abs(level - top.level) < self.near_top * top.level
        asked = np.concatenate([asked_of(m, j, kind) for m in motions])
        needed = _needed(motions, j, asked, level)
        highest = float(np.quantile(np.abs(needed), 0.9995))
        reached = np.abs(asked) > level
        # A joint that never needed as much: what is cut off is not torque.
        rigid = max(_highest(m, j) for m in motions)
        return (
            self.needed * level <= rigid < self.passed * level
            and highest < self.passed * level
            and int(np.count_nonzero(reached)) >= self.least_reached
            and is_cut(
                _smooth(motions, [asked_of(m, j, kind) for m in motions]),
                needed,
                level,
                self.missed,
            )
        )

    def parts(self, site: Site) -> tuple[Part, ...]:
        """What a simulation is given for it."""
        return site.each(lambda j: DriveChange(joint=j, limit=site["level"]))

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        return (
            f"The drive of {where} gives at most {values['level']:.3g} N m, whatever the command."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"the highest torques of {where}"


def kinds(motion: Motion, j: int) -> list[float]:
    """What may be clipped at joint j and was recorded in addition to the applied torque."""
    command = [OF_COMMAND] if motion.has_command(j) else []
    return command + ([OF_LAW] if motion.has_law(j) else [])


def top_of(motions: Sequence[Motion], j: int, kind: float) -> FlatTop | None:
    """The flat top of what is given to joint j where a command or the law asks for more."""
    pairs = [(given_of(m, j, kind), asked_of(m, j, kind), m.valid, m.period) for m in motions]
    if not all(np.isfinite(given).all() and np.isfinite(asked).all() for given, asked, *_ in pairs):
        return None
    return flat_top(pairs, motions[0].thresholds.limits)


def asked_of(motion: Motion, j: int, kind: float) -> FloatArray:
    """The torque that is clipped, (T,)."""
    asked = {OF_REPORTED: motion.torque, OF_COMMAND: motion.command, OF_LAW: motion.law}[kind]
    assert asked is not None
    return np.ascontiguousarray(asked[:, j])


def given_of(motion: Motion, j: int, kind: float) -> FloatArray:
    """What came of it, (T,)."""
    if kind == OF_COMMAND and motion.torque is not None:
        return np.ascontiguousarray(motion.torque[:, j])
    return motion.given(j)


def _needed(motions: Sequence[Motion], j: int, asked: FloatArray, level: float) -> FloatArray:
    """What the motion needed by the model, with friction, rotor and scale of what was below, (N,).

    Fitted where less than the level was asked, noise apart.
    """
    parts = [
        np.stack([m.borne[:, j], m.sign(j), m.dq[:, j], m.ddq[:, j], np.ones(len(m.time))], axis=1)
        for m in motions
    ]
    A = _smooth(motions, parts)
    below = np.abs(asked) <= level
    scale = np.sqrt(np.mean(A[below] ** 2, axis=0)) + 1e-12
    beta = np.linalg.lstsq(A[below] / scale, asked[below], rcond=1e-6)[0]
    return np.asarray(A / scale @ beta)


def is_cut(asked: FloatArray, needed: FloatArray, level: float, missed: float) -> bool:
    """Whether the level is what is needed where more is asked, and by more than it scatters below.

    A drive that hums or is jolted reports more than the level, too, but the motion needs less; and
    a level that is hardly passed may as well be a misfit of high torques.
    """
    above, below = np.abs(asked) > level, (np.abs(asked) > level / 2.0) & (np.abs(asked) < level)
    if not above.any() or not below.any():
        return False
    beyond = _rms(np.abs(asked[above]) - level)
    left = _rms(np.sign(asked[above]) * needed[above] - level)
    return left < missed * beyond and _rms(asked[below] - needed[below]) < missed * beyond


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _smooth(motions: Sequence[Motion], parts: Sequence[FloatArray]) -> FloatArray:
    """Every motion's values, noise apart, one after the other."""
    pairs = zip(parts, motions, strict=True)
    return np.concatenate([zero_phase(part, m.cutoff, m.period) for part, m in pairs])


def _highest(motion: Motion, j: int) -> float:
    """The highest torque by the model alone, noise apart [N m]."""
    smooth = np.abs(zero_phase(motion.borne[:, j], motion.cutoff, motion.period))
    return float(np.quantile(smooth, 0.9995))
