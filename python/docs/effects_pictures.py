"""Pictures of what effects do to a signal, for the catalogue's pages.

An effect with an example is tried on the arm of `pdoik effects check`; of a floating base and of
noise a small sketch shows the law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from pdoik.sim2real.effect_check.arm import JOINTS, Arm
from pdoik.sim2real.effect_check.trial import Trial
from pdoik.sim2real.effects import Effect
from pdoik.sim2real.motion.place import Key

FloatArray = npt.NDArray[np.float64]

WITHOUT, WITH = "#9aa0a8", "#1f6fb4"
SHOWN = 4.0  # of the example, where the effect does most [s]
BALANCES = {
    "torque": "torque of {}",
    "drive": "reported less\ncommanded torque of {}",
    "law": "command less\nthe control law, {}",
    "velocity": "logged speed less\nthat of positions, {}",
    "servo": "position less\ncommand, {}",
    "tip": "measured tip less\nthe model's",
}
UNITS = {"velocity": "rad/s", "servo": "rad", "tip": "m or rad"}
OVER = {
    "speed": "speed [rad/s]",
    "q": "position [rad]",
    "load": "load [N m]",
    "acceleration": "acceleration [rad/s^2]",
}
CLEARER = 0.5  # of its spread among neighbours, another variable is drawn over


@dataclass(frozen=True, slots=True, kw_only=True)
class Signal:
    """A signal without an effect, and what the effect adds."""

    time: FloatArray  # (T,) [s]
    without: FloatArray  # (T,)
    added: FloatArray  # (T,)
    over: FloatArray  # (T,)
    label: str
    unit: str
    over_label: str
    caption: str = "On an example arm of three joints, with the values of the table."


def signal_of(effect: Effect, arm: Arm) -> Signal | None:
    """The balance that an effect changes most, or its sketch; None without either."""
    if effect.id in SKETCHES:
        return SKETCHES[effect.id]()
    if effect.example is None:
        return None
    trial = Trial(effect, effect.example, arm)
    if trial.place is None:
        return None
    balances, motion = trial.plain, trial.motion
    columns = balances.compute(effect, trial.place, trial.shape)
    added = {key: column @ trial.beta for key, column in columns.items()}
    added = {key: each for key, each in added.items() if np.abs(each).max() > 1e-9}
    if not added:
        return None
    key = max(added, key=lambda each: _shown_first(added, each))
    model = np.interp(balances.time, motion.time, motion.borne[:, key[1]])
    axis = key[1] if key[0] != "tip" else 1
    every = {
        "speed": motion.dq[:, axis],
        "q": motion.q[:, axis],
        "load": motion.borne[:, axis],
        "acceleration": motion.ddq[:, axis],
    }
    laws = {name: np.interp(balances.time, motion.time, x) for name, x in every.items()}
    spread = {name: _spread(x, added[key]) for name, x in laws.items()}
    clearest = min(spread, key=lambda name: spread[name])
    clear = spread[clearest] < CLEARER * spread[effect.against]
    against = clearest if clear and effect.against == Effect.against else effect.against
    return Signal(
        time=balances.time,
        without=model if key[0] == "torque" else np.zeros(len(balances.time)),
        added=added[key],
        over=laws[against],
        label=BALANCES[key[0]].format(JOINTS[axis]),
        unit=UNITS.get(key[0], "N m"),
        over_label=OVER[against],
    )


def _spread(x: FloatArray, y: FloatArray) -> float:
    """Mean variance of y among neighbours in x."""
    return float(np.mean([np.var(each) for each in np.array_split(y[np.argsort(x)], 20)]))


def _shown_first(added: dict[Key, FloatArray], key: Key) -> tuple[bool, float]:
    """Torques before other balances, then by size."""
    return key[0] == "torque", float(np.mean(added[key] ** 2))


def draw(signal: Signal, path: Path) -> None:
    """The signal without and with the effect, what is added, and the law."""
    rows = _busiest(signal)
    figure = Figure(figsize=(8.0, 3.8), layout="constrained")
    grid = figure.add_gridspec(2, 2, height_ratios=(3, 2), width_ratios=(4, 3))
    both = figure.add_subplot(grid[0, 0])
    alone = figure.add_subplot(grid[1, 0], sharex=both)
    law = figure.add_subplot(grid[:, 1])
    time = signal.time[rows]
    both.plot(time, signal.without[rows], color=WITHOUT, lw=2, label="without")
    both.plot(time, (signal.without + signal.added)[rows], color=WITH, lw=1.3, label="with")
    both.set_ylabel(f"{signal.label}\n[{signal.unit}]")
    both.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1, 0.98))
    both.tick_params(labelbottom=False)
    alone.plot(time, signal.added[rows], color=WITH, lw=1.3)
    alone.set(xlabel="time [s]", ylabel=f"added\n[{signal.unit}]")
    law.plot(signal.over, signal.added, ".", color=WITH, markersize=2.5)
    law.set(xlabel=signal.over_label, ylabel=f"added [{signal.unit}]")
    size = float(np.abs(signal.added).max())
    for each in (alone, law):
        low, high = each.get_ylim()
        if high - low < 0.2 * size:  # a constant
            each.set_ylim(min(0.0, 1.5 * low), max(0.0, 1.5 * high))
    for each in (both, alone, law):
        each.spines[["top", "right"]].set_visible(False)
    figure.savefig(path, metadata={"Date": None})


def _busiest(signal: Signal) -> npt.NDArray[np.bool_]:
    """The seconds in which the effect does most."""
    starts = signal.time[signal.time <= signal.time[-1] - SHOWN]
    if not len(starts):
        return np.ones(len(signal.time), dtype=bool)
    power = np.concatenate([[0.0], np.cumsum(signal.added**2)])
    ends = np.searchsorted(signal.time, starts + SHOWN)
    start = starts[int(np.argmax(power[ends] - power[: len(starts)]))]
    return (signal.time >= start) & (signal.time <= start + SHOWN)


TIME = np.linspace(0.0, SHOWN, 401)  # [s]
STEPS = np.sin(2 * np.pi * TIME)  # of a foot: on the ground where negative
GRAVITY = 9.81  # [m/s^2]


def _sketch(
    without: FloatArray, with_it: FloatArray, over: FloatArray, *words: str, caption: str
) -> Signal:
    label, unit, over_label = words
    return Signal(
        time=TIME, without=without, added=with_it - without, over=over, label=label, unit=unit,
        over_label=over_label, caption=f"A sketch of the law: {caption}.",
    )  # fmt: skip


def _sensor_noise() -> Signal:
    q = 0.3 * np.sin(np.pi * TIME)
    noise = np.random.default_rng(0).normal(0.0, 0.02, len(q))
    words = ("logged position", "rad", "position [rad]")
    return _sketch(q, q + noise, q, *words, caption="white noise of 0.02 rad")


def _imu_tilt() -> Signal:
    pitch = 0.1 * STEPS
    ahead, up = GRAVITY * np.sin(pitch), GRAVITY * np.cos(pitch)
    tilted = np.cos(0.05) * ahead + np.sin(0.05) * up
    words = ("acc.x of a base\nthat pitches", "m/s^2", "pitch [rad]")
    return _sketch(ahead, tilted, pitch, *words, caption="a tilt of 0.05 rad about y")


def _imu_offset() -> Signal:
    pitch = 0.1 * STEPS
    ahead = GRAVITY * np.sin(pitch)
    words = ("acc.x of a base\nthat pitches", "m/s^2", "pitch [rad]")
    return _sketch(ahead, ahead + 0.4, pitch, *words, caption="an offset of 0.4 m/s^2")


def _lift() -> FloatArray:
    return np.maximum(0.08 * STEPS, 0.0)


def _ground_height() -> Signal:
    lift, words = _lift(), ("height of a sole", "m", "height without [m]")
    with_it = np.maximum(lift, 0.02)
    return _sketch(lift, with_it, lift, *words, caption="a floor that is 2 cm higher")


def _ground_slope() -> Signal:
    lift, ahead = _lift(), 0.1 * TIME
    words = ("height of a sole", "m", "position x [m]")
    with_it = np.maximum(lift, 0.1 * ahead)
    return _sketch(lift, with_it, ahead, *words, caption="a slope of 0.1 along x")


def _foot_softness() -> Signal:
    force = 150.0 * np.maximum(-STEPS, 0.0)
    words = ("height of a sole", "m", "normal force [N]")
    return _sketch(
        _lift(), _lift() - 1e-4 * force, force, *words, caption="a compliance of 1e-4 m/N"
    )


def _foot_friction() -> Signal:
    force = 150.0 * np.maximum(-STEPS, 0.0)
    push = 90.0 * np.maximum(-STEPS, 0.0) ** 0.5
    words = ("tangential force", "N", "normal force [N]")
    slips = (np.minimum(push, mu * force) for mu in (0.8, 0.5))
    return _sketch(*slips, force, *words, caption="friction of 0.5 where the simulation has 0.8")


SKETCHES: dict[str, Callable[[], Signal]] = {
    "sensor_noise": _sensor_noise,
    "imu_tilt": _imu_tilt,
    "imu_offset": _imu_offset,
    "ground_height": _ground_height,
    "ground_slope": _ground_slope,
    "foot_softness": _foot_softness,
    "foot_friction": _foot_friction,
}
