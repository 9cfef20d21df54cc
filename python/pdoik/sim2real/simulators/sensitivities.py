"""How what a candidate shows changes with each of its properties, by finite differences."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..simulation.stepper import SimulationError
from ..study.recording import FloatArray
from .candidates import Knob, Term, Values, baseline, model_with
from .experiment import Experiment
from .property import EVERY, Scales
from .user_model import UserModel
from .vocabulary import PROPERTIES


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sensitivities:
    """A candidate and its surroundings. x of a knob is its change from the user's model in steps.

    Steps are of the properties' coordinates.

    shown(x) = shown + J (x - at), with J (P, R, C).
    """

    knobs: tuple[Knob, ...]
    step: FloatArray  # (P,) of each knob's coordinate
    base: FloatArray  # (P,) coordinates of the user's model
    at: FloatArray  # (P,) of the candidate, in steps
    shown: FloatArray  # (R, C)
    J: FloatArray

    @property
    def lowest(self) -> FloatArray:
        """Bounds of x, (P,)."""
        floor = np.array([PROPERTIES[knob.property].lowest for knob in self.knobs])
        return np.asarray((floor - self.base) / self.step)

    def values(self, x: FloatArray) -> dict[Knob, float]:
        """Of the knobs that are not as in the user's model."""
        moved = self.base + x * self.step
        return {
            knob: PROPERTIES[knob.property].value_at(float(value))
            for knob, value, change in zip(self.knobs, moved, x, strict=True)
            if change != 0.0
        }

    def std_of(self, p: int, std: float) -> float:
        """Standard error of a knob's value, in its unit, from that of its x."""
        to_value, h = PROPERTIES[self.knobs[p].property].value_at, 1e-3 * self.step[p]
        at = float(self.base[p] + self.at[p] * self.step[p])
        return float(std * abs(to_value(at + h) - to_value(at - h)) / 2e-3)


def scales_of(experiment: Experiment, values: Values) -> tuple[Scales, ...]:
    """Typical sizes at each joint, of the recordings' motion and a candidate's gains."""
    model = model_with(experiment.user, values)
    user = replace(experiment.user, model=model)
    found = []
    for k in range(len(user.joints)):
        errors, speeds, accelerations, travels = [], [], [], []
        for each in experiment.recordings:
            assert each.q_des is not None
            q = each.q[:, k]
            smooth = np.convolve(q, np.ones(5) / 5.0, mode="valid")
            speed = np.gradient(smooth, each.period)
            errors.append(_rms(each.q_des[:, k] - q))
            speeds.append(_rms(speed))
            accelerations.append(_rms(np.gradient(speed, each.period)))
            travels.append(float(np.std(q)))
        gain = abs(PROPERTIES["kp"].read(user, k))
        found.append(
            Scales(
                torque=max(gain * max(errors), 1e-4 * gain, 1e-6),
                speed=max(*speeds, 1e-2),
                acceleration=max(*accelerations, 1e-1),
                travel=max(*travels, 1e-2),
                mass=max(float(model.body_subtreemass[user.body_of(k)]), 1e-3),
            )
        )
    return tuple(found)


def knobs_of(terms: Sequence[Term]) -> tuple[Knob, ...]:
    """All that the terms turn, each once."""
    return tuple(dict.fromkeys(knob for term in terms for knob in term.knobs))


def sensitivities(
    experiment: Experiment,
    values: Values,
    knobs: Sequence[Knob],
    scales: Sequence[Scales],
) -> Sensitivities:
    """About a candidate. Knobs of trees that do not touch each other are turned in one run.

    Raises:
        SimulationError: the candidate itself is unstable; a neighbour that is has no column.
    """
    user = experiment.user
    told = [baseline(user, knob) for knob in knobs]
    both = list(zip(knobs, told, strict=True))
    base = np.array([_coordinate(knob, value) for knob, value in both])
    mine = [(knob, values.get(knob, value)) for knob, value in both]
    now = np.array([_coordinate(knob, value) for knob, value in mine])
    changed = [_coordinate(knob, value + _step(knob, scales, value)) for knob, value in mine]
    step = np.array(changed) - now
    shown = experiment.run(values)
    J = np.zeros((len(knobs), *shown.shape))
    columns = np.array([user.trees()[k] for _, k in experiment.channels])
    for group in _together(user, knobs):
        moved = dict(values)
        for p in group:
            to_value = PROPERTIES[knobs[p].property].value_at
            moved[knobs[p]] = to_value(float(now[p] + step[p]))
        try:
            difference = experiment.run(moved) - shown
        except SimulationError:
            continue
        for p in group:
            moves = np.ones(len(columns), dtype=bool)
            if knobs[p].index != EVERY:
                moves = columns == user.trees()[knobs[p].index]
            J[p][:, moves] = difference[:, moves]
    return Sensitivities(
        knobs=tuple(knobs), step=step, base=base, at=(now - base) / step, shown=shown, J=J
    )


def _together(user: UserModel, knobs: Sequence[Knob]) -> list[list[int]]:
    """Knobs by place, grouped so that none of a group moves what another of it moves."""
    trees = user.trees()
    alone = [[p] for p, knob in enumerate(knobs) if knob.index == EVERY]
    queues: dict[int, list[int]] = {}
    for p, knob in enumerate(knobs):
        if knob.index != EVERY:
            queues.setdefault(trees[knob.index], []).append(p)
    rounds = max((len(queue) for queue in queues.values()), default=0)
    return alone + [[q[k] for q in queues.values() if k < len(q)] for k in range(rounds)]


def _coordinate(knob: Knob, value: float) -> float:
    return PROPERTIES[knob.property].coordinate(value)


def _step(knob: Knob, scales: Sequence[Scales], value: float) -> float:
    mine = scales[0 if knob.index == EVERY else knob.index]
    return PROPERTIES[knob.property].step(mine, value)


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))
