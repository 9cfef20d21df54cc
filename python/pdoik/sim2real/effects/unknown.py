"""None of the named effects: a smooth function of what it is seen to depend on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import cast

import numpy as np

from pdoik.recordings import FloatArray

from ..motion import Columns, Motion, Place, Shape
from ..simulation import (
    HardFriction,
    JointTorque,
    Law,
    Part,
    Variable,
    curve,
    cycle,
    of_speed,
    smooth_sign,
)
from .effect import Effect, Example, Parameter
from .site import Site

VARIABLES = (
    "position",
    "speed",
    "load",
    "time",
    "position and speed",
    "other position",
    "other speed",
    "clock",
    "other load",
    "other position and speed",
    "fine position",
    "fine position and speed",
)
"""What an unknown torque may depend on; a shape is (index, lowest, highest value or frequency)."""

_KNOTS = 9
_KNOTS_2D = 5
_FINEST = 0.05  # between the knots of what changes quickly with position [rad], [m]
_MOST_FINE = 60  # knots
BEYOND = 0.25  # of its range that a function's outermost lines go on for
_LESS = 1.5  # log odds, of a function of one variable less
_MOST = 2 * _MOST_FINE  # coefficients


class Unknown(Effect):
    """tau = f(x), f piecewise linear over nine knots; x is named, f is not."""

    id = "unknown"
    name = "unknown effect"
    on = "joint"
    odds = 0.01
    equation = "tau = f(x), f given by its values at knots"
    parameters = (Parameter("size", "N m"), Parameter("knots", "-"))
    decided_by = "motion that varies what it depends on and keeps everything else still"
    source = "penalised regression splines (Eilers and Marx, Statistical Science 11(2), 1996)"
    example = Example(
        values={"variable": 0.0, "lowest": -1.2, "highest": 1.5}
        | {f"value_{k}": 0.3 * (k % 3) for k in range(_KNOTS)},
    )
    complexity = 9
    function = True
    sought = "last"
    together = True
    makes_up_for_misfit = True
    refined = False
    jumps = True

    def shapes(self, motions: Sequence[Motion], place: Place) -> list[Shape]:
        """Every variable over its range, but time within a recording's periodic part."""
        shapes: list[Shape] = []
        for code, name in enumerate(VARIABLES):
            if name == "clock" or (len(place.joints) > 1) != name.startswith("other"):
                continue
            x = np.concatenate([variable(m, place, code) for m in motions])
            low, high = np.quantile(x, (0.005, 0.995))
            if high > low:
                shapes.append((float(code), float(low), float(high)))
        return shapes

    def log_prior(self, shape: Shape) -> float:
        """What repeats with the machine's own motion is likelier than what time alone does."""
        name = VARIABLES[int(shape[0])]
        if name in ("time", "clock"):
            return -_LESS * 3.0
        wide = name.endswith("and speed") or name.startswith("fine")
        return -_LESS * (wide + 2.0 * name.startswith("other"))

    def columns(self, motion: Motion, place: Place, shape: Shape) -> Columns:
        """Hat functions of the variable."""
        j = place.joints[0]
        code = int(shape[0])
        if VARIABLES[code] == "clock":
            angle = 2 * np.pi * shape[1] * (motion.recording.start + motion.time)
            return {("torque", j): np.stack([np.cos(angle), np.sin(angle)], axis=1)}
        if VARIABLES[code].endswith("position and speed"):
            across = hats(variable(motion, place, code), shape[1], shape[2], knots_of(shape))
            sign = motion.sign(j)[:, None]
            both = np.hstack([across * sign, across * motion.dq[:, j, None]])
            return {("torque", j): both}
        x = variable(motion, place, code)
        return {("torque", j): hats(x, shape[1], shape[2], knots_of(shape))}

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """None."""
        return np.full(_MOST, -np.inf), np.full(_MOST, np.inf)

    def prior(self, width: int) -> FloatArray:
        """A trace, so that knots no sample came near stay at zero."""
        return np.full(width, 1e-4)

    def admissible(self, beta: FloatArray) -> bool:
        """Always."""
        return True

    def shape_bounds(self, shape: Shape) -> list[tuple[float, float]]:
        """Fixed."""
        return [(value, value) for value in shape]

    def values(self, shape: Shape, beta: FloatArray) -> dict[str, float]:
        """The variable's index and range, and the function at its knots [N m]."""
        result = {"variable": shape[0], "lowest": shape[1], "highest": shape[2]}
        return result | {f"value_{i}": float(b) for i, b in enumerate(beta)}

    def coefficients(
        self, values: Mapping[str, float], shape: Shape = ()
    ) -> tuple[Shape, FloatArray]:
        """The function at its knots."""
        count = sum(name.startswith("value_") for name in values)
        beta = np.array([values[f"value_{i}"] for i in range(count)])
        return (values["variable"], values["lowest"], values["highest"]), beta

    def parts(self, site: Site) -> tuple[Part, ...]:
        """A torque by its values at even knots of a variable."""
        depends, joint = depends_on(site.values), site.joints[0]
        if depends not in SIMULATED:
            return ()
        low, high = site["lowest"], site["highest"]
        count = sum(each.startswith("value_") for each in site.values)
        values = [site[f"value_{k}"] for k in range(count)]
        if depends == "clock":
            law = cycle(low, values[0], values[1])
            return (JointTorque(joint=joint, law=law, by_clock=True),)
        if depends.endswith("position and speed"):
            knots, levels = _prolonged(low, high, values[: count // 2])
            level = curve("position", knots, levels)
            slope = curve("position", *_prolonged(low, high, values[count // 2 :]))
            return (
                _dry(joint, level, min(levels)),
                JointTorque(joint=joint, law=of_speed(slope)),
            )
        variable = cast(Variable, depends.removeprefix("other ").removeprefix("fine "))
        knots, values = _prolonged(low, high, values)
        return (unknown_part(joint, variable, knots, values, of=site.joints[-1]),)

    def not_simulated(self, values: Mapping[str, float]) -> str:
        """A loaded neighbour's torque is no law of one joint."""
        known = depends_on(values) in SIMULATED
        return "" if known else "a torque without a law is not simulated"

    def shown(self, values: Mapping[str, float]) -> dict[str, str]:
        """The function's values, by where their knots are."""
        names = [name for name in values if name.startswith("value_")]
        return {name: _knot(values, k, len(names)) for k, name in enumerate(names)}

    def statement(self, where: str, values: Mapping[str, float]) -> str:
        """Statement of the finding in words."""
        name = VARIABLES[int(values["variable"])]
        on = {
            "other position": "another joint's position",
            "other speed": "another joint's speed",
            "position": "its own position",
            "speed": "its own speed",
            "load": "the load it carries",
            "time": "the time since the recording's start",
            "position and speed": "its position and its speed together",
            "other load": "the load another joint carries",
            "other position and speed": "its speed and another joint's position together",
            "fine position": "its own position, and changes within a few degrees",
            "fine position and speed": "its speed and, within a few degrees, its position",
            "clock": f"the clock, with a period of {1.0 / max(values['lowest'], 1e-9):.3g} s",
        }[name]
        return (
            f"{where} has a torque the model does not know and no effect of the catalogue explains;"
            f" it depends on {on}."
        )

    def regime(self, where: str) -> str:
        """When it shows."""
        return f"see the statement; {where}"


def variable(motion: Motion, place: Place, code: int) -> FloatArray:
    """The variable of an unknown torque along a motion, (T,)."""
    j, name = place.joints[0], VARIABLES[code]
    if name in ("position", "position and speed") or name.startswith("fine"):
        values = motion.q[:, j]
    elif name == "speed":
        values = motion.dq[:, j]
    elif name == "load":
        values = motion.borne[:, j]
    elif name == "other load":
        values = motion.borne[:, place.joints[1]]
    elif name.startswith("other position"):
        values = motion.q[:, place.joints[1]]
    elif name == "other speed":
        values = motion.dq[:, place.joints[1]]
    else:
        values = motion.time
    return np.ascontiguousarray(values)


def knots_of(shape: Shape) -> int:
    """Number of knots over a variable's range."""
    name = VARIABLES[int(shape[0])]
    if name.startswith("fine"):
        return int(np.clip(np.ceil((shape[2] - shape[1]) / _FINEST), _KNOTS, _MOST_FINE))
    return _KNOTS_2D if name.endswith("and speed") else _KNOTS


def hats(x: FloatArray, low: float, high: float, knots: int) -> FloatArray:
    """Piecewise linear functions that are 1 at one of evenly spaced knots, (T, knots).

    Beyond the ends the outermost lines go on for a quarter of the range.
    """
    place = np.clip((x - low) / (high - low), -BEYOND, 1.0 + BEYOND) * (knots - 1)
    before = np.clip(np.floor(place), 0, knots - 2)
    share = place - before
    k = np.arange(knots)
    left, right = before[:, None] == k, before[:, None] + 1 == k
    return np.asarray(left * (1.0 - share)[:, None] + right * share[:, None])


SIMULATED = (
    "position",
    "fine position",
    "speed",
    "load",
    "time",
    "position and speed",
    "fine position and speed",
    "other position",
    "other speed",
    "clock",
)
"""Variables of torques that a law of one joint can be: a loaded neighbour's cannot."""


def depends_on(values: Mapping[str, float]) -> str:
    """On what an unnamed torque depends."""
    return VARIABLES[int(values["variable"])]


def unknown_part(
    joint: str, variable: Variable, knots: Sequence[float], values: Sequence[float], of: str = ""
) -> JointTorque:
    """A torque without a name as straight lines over a variable (of another joint, if `of`)."""
    law = curve(variable, knots, values)
    return JointTorque(joint=joint, law=law, of=of, needs_load=variable == "load")


def _prolonged(low: float, high: float, values: list[float]) -> tuple[list[float], list[float]]:
    """Even knots and values, the outermost lines going on as those of the columns do."""
    knots = np.linspace(low, high, len(values)).tolist()
    if len(values) < 2:
        return knots, values
    more, steps = BEYOND * (high - low), BEYOND * (len(values) - 1)
    first = values[0] - steps * (values[1] - values[0])
    last = values[-1] + steps * (values[-1] - values[-2])
    return [low - more, *knots, high + more], [first, *values, last]


def _dry(joint: str, level: Law, lowest: float) -> Part:
    """Friction of a level that varies; where it may be negative, smooth and without sticking."""
    if lowest >= 0.0:
        return HardFriction(joint=joint, level=level)
    return JointTorque(joint=joint, law=smooth_sign(level))


def _knot(values: Mapping[str, float], k: int, count: int) -> str:
    """What the k-th of the values stands for."""
    name, low, high = depends_on(values), values["lowest"], values["highest"]
    if name == "clock":
        return f"{'cosine' if k == 0 else 'sine'} at {low:.3g} Hz"
    part = ""
    if name.endswith("and speed"):
        count //= 2
        part = "direction, " if k < count else "speed, "
        k %= count
    return f"{part}at {low + (high - low) * k / max(count - 1, 1):.3g}"
