"""Motions to choose from: sums of sines, strokes to and fro at many speeds, quick moves and stops.

What distinguishes effects differs: friction needs reversals, small and large, slow and fast; bodies
need wide and quick motion of several joints; play and elasticity need quick stops. A recipe puts
such parts one after the other around a pose; every part is drawn from a seed of its own, so that a
better recipe is found by drawing one part anew.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from pdoik.recordings import FloatArray

from .limits import Limits
from .path import REST, STEP, Path, path_of

Kind = Literal["sines", "strokes", "moves"]
KINDS: tuple[Kind, ...] = ("sines", "strokes", "moves")
_FEWEST, _MOST = 2, 4  # parts of a recipe
_SHORTEST = 2.5  # of a part [s]
_TERMS = 5  # sines per joint
_SLOWEST_SINE, _FASTEST_SINE = 0.08, 1.2  # of them [Hz]
_SLOWEST = 0.03  # pace of a part, as a share of the speed limits
_SMALLEST = 0.006  # of strokes [rad]
_STROKES = ((0.05, 0.04), (0.15, 0.06), (0.3, 0.1), (0.45, 0.2), (0.65, 0.5))  # reach, pace
_LONGEST = 3.0  # that a stroke takes [s]
_RAMP = 0.7  # share of the acceleration limit that strokes and moves take
_WIDEST = 1.4  # room of a joint on either side of the pose, at most [rad]
_SOME = 0.3  # numerics: share of moves in which half of the joints move
_HALF = 0.5  # numerics: of them
_ALONE = 0.25  # numerics: share of parts in which the joints in question move alone
_TO_POSE = 0.6  # share of the speed limit at which the pose is gone to


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """A stretch of one kind."""

    kind: Kind
    seed: int
    share: float  # of the time
    pace: float  # 0 to 1, of the speed limits
    reach: float  # 0 to 1, of the room; of strokes on a scale from the smallest to the room
    alone: bool  # whether the joints in question move alone


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """Parts around a pose."""

    pose: int  # seed
    away: float  # 0 to 1: how far the pose may be from the start
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Frame:
    """What every motion has in common."""

    limits: Limits  # to design within
    start: FloatArray  # (n,)
    duration: float  # [s]
    stuck: FloatArray  # (n,) by which friction holds a joint back at a reversal
    asked: tuple[int, ...] = ()  # joints in question


def first_recipes(rng: np.random.Generator) -> list[Recipe]:
    """Motions known to serve: strokes of one size after another, then of two kinds in turn."""

    def part(kind: Kind, reach: float, pace: float = 0.6) -> Part:
        return Part(kind=kind, seed=_seed(rng), share=1.0, pace=pace, reach=reach, alone=False)

    plans = [
        *((part("strokes", reach, pace),) for reach, pace in _STROKES),
        (part("sines", 1.0, 1.0),),
        (part("moves", 0.8, 1.0),),
        (part("strokes", 0.1, 0.06), part("strokes", 0.5)),
        (part("strokes", 0.1, 0.06), part("sines", 1.0, 1.0)),
        (part("strokes", 0.3, 0.2), part("moves", 0.8, 1.0)),
    ]
    return [Recipe(pose=_seed(rng), away=0.3 * (k % 2), parts=p) for k, p in enumerate(plans)]


def random_recipe(rng: np.random.Generator) -> Recipe:
    """Two to four parts."""
    count = int(rng.integers(_FEWEST, _MOST + 1))
    return Recipe(
        pose=_seed(rng),
        away=float(rng.uniform(0.0, 1.0)),
        parts=tuple(_random_part(rng) for _ in range(count)),
    )


def changed(recipe: Recipe, rng: np.random.Generator) -> Recipe:
    """A recipe near this one: a part, the pose or a figure drawn anew."""
    parts = list(recipe.parts)
    which = int(rng.integers(len(parts)))
    part = parts[which]
    what = rng.choice(["seed", "pace", "reach", "share", "part", "pose", "alone", "more", "fewer"])
    if what == "pose":
        return replace(recipe, pose=_seed(rng), away=float(rng.uniform(0.0, 1.0)))
    if what == "more" and len(parts) < _MOST:
        parts.insert(which, _random_part(rng))
    elif what == "fewer" and len(parts) > 1:
        parts.pop(which)
    else:
        parts[which] = {
            "seed": replace(part, seed=_seed(rng)),
            "pace": replace(part, pace=_near(rng, part.pace)),
            "reach": replace(part, reach=_near(rng, part.reach)),
            "share": replace(part, share=float(rng.uniform(0.3, 1.0))),
            "alone": replace(part, alone=not part.alone),
        }.get(str(what), _random_part(rng))
    return replace(recipe, parts=tuple(parts))


def motion_of(recipe: Recipe, frame: Frame) -> Path:
    """The recipe's motion, within limits of position, speed and acceleration."""
    limits, count = frame.limits, round(frame.duration / STEP) + 1
    pose = pose_of(recipe, frame)
    path, rest = _there_and_back(pose, frame, count)
    room = np.minimum(np.minimum(limits.upper - pose, pose - limits.lower), _WIDEST)
    rows = count - 2 * rest
    swing = np.zeros((count, len(pose)))
    total, first = sum(part.share for part in recipe.parts), rest
    for part in recipe.parts:
        last = min(first + round(part.share / total * rows), count - rest)
        if last - first > round(_SHORTEST / STEP / 2):
            swing[first:last] = _stretch(part, last - first, room, frame)
        first = last
    return _within(path, swing, limits)


def random_motion(frame: Frame, rng: np.random.Generator) -> Path:
    """Quick moves between random poses, as anybody would make them, to compare with."""
    part = Part(kind="moves", seed=_seed(rng), share=1.0, pace=0.7, reach=0.8, alone=False)
    return motion_of(Recipe(pose=_seed(rng), away=0.5, parts=(part,)), frame)


def pose_of(recipe: Recipe, frame: Frame) -> FloatArray:
    """The pose that a recipe's parts are around."""
    rng, limits = np.random.default_rng(recipe.pose), frame.limits
    middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * (limits.upper - limits.lower)
    anywhere = middle + 0.6 * half * rng.uniform(-1.0, 1.0, len(middle))
    aim = np.clip(anywhere, frame.start - _WIDEST, frame.start + _WIDEST)
    return np.asarray(frame.start + recipe.away * (aim - frame.start), dtype=np.float64)


def _there_and_back(pose: FloatArray, frame: Frame, count: int) -> tuple[FloatArray, int]:
    """Path from the start to the pose, and back at the end; and how many rows either takes."""
    limits, distance = frame.limits, np.abs(pose - frame.start)
    # The quintic's largest speed is 15/8 of its mean, its largest acceleration 5.78 of D / T^2.
    by_speed = float(np.max(15 / 8 * distance / (_TO_POSE * limits.speed)))
    by_rate = float(np.max(np.sqrt(5.78 * distance / (_TO_POSE * limits.acceleration))))
    needed = min(max(by_speed, by_rate, 0.3), 0.3 * frame.duration)
    rest, rows = round(REST / STEP), round(needed / STEP)
    s = np.linspace(0.0, 1.0, rows)
    rise = np.concatenate([np.zeros(rest), s**3 * (10.0 - 15.0 * s + 6.0 * s**2)])
    share = np.ones(count)
    share[: len(rise)], share[-len(rise) :] = rise, rise[::-1]
    return frame.start + share[:, None] * (pose - frame.start), len(rise)


def _within(path: FloatArray, swing: FloatArray, limits: Limits) -> Path:
    """Path and swing together, swings as much smaller as limits ask."""
    scale = np.ones(swing.shape[1])
    for _ in range(8):
        made = path_of(path + scale * swing)
        middle, half = 0.5 * (limits.lower + limits.upper), 0.5 * (limits.upper - limits.lower)
        excess = np.max(
            [
                np.max(np.abs(made.q - middle) / half, axis=0),
                np.max(np.abs(made.dq) / limits.speed, axis=0),
                np.max(np.abs(made.ddq) / limits.acceleration, axis=0),
            ],
            axis=0,
        )
        if (excess <= 1.0).all():
            break
        scale = np.where(excess > 1.0, 0.97 * scale / excess, scale)
    return made


def _stretch(part: Part, rows: int, room: FloatArray, frame: Frame) -> FloatArray:
    """Swings of one part, (rows, n), that begin and end at the pose."""
    rng = np.random.default_rng(part.seed)
    limits, reach = frame.limits, part.reach * room
    if part.kind == "strokes":
        reach = _SMALLEST * (np.maximum(room, 2.0 * _SMALLEST) / _SMALLEST) ** part.reach
        path = _strokes(
            rng, rows, part.pace * limits.speed, reach, limits.acceleration, 2.0 * frame.stuck
        )
    else:
        make = {"sines": _sines, "moves": _moves}[part.kind]
        path = make(rng, rows, part.pace * limits.speed, reach, limits.acceleration)
    if part.alone and frame.asked:
        kept = np.isin(np.arange(path.shape[1]), frame.asked)
        path = path * kept
    fade = np.clip(np.minimum(np.arange(rows), np.arange(rows)[::-1]) * STEP / 0.6, 0.0, 1.0)
    return path * (fade**2 * (3.0 - 2.0 * fade))[:, None]


def _sines(
    rng: np.random.Generator, rows: int, speed: FloatArray, reach: FloatArray, rate: FloatArray
) -> FloatArray:
    time, n = STEP * np.arange(rows), len(speed)
    path = np.zeros((rows, n))
    for j in range(n):
        rates = (
            2.0 * np.pi * np.exp(rng.uniform(np.log(_SLOWEST_SINE), np.log(_FASTEST_SINE), _TERMS))
        )
        phases, weights = rng.uniform(0.0, 2.0 * np.pi, _TERMS), rng.uniform(0.3, 1.0, _TERMS)
        wave = (np.sin(np.outer(time, rates) + phases) * (weights / rates)).sum(axis=1)
        wave -= wave.mean()
        dwave = np.gradient(wave, STEP)
        quickest = np.max(np.abs(np.gradient(dwave, STEP)))
        path[:, j] = wave * min(
            speed[j] / np.max(np.abs(dwave)),
            reach[j] / np.max(np.abs(wave)),
            _RAMP * rate[j] / quickest,
        )
    return path


def _strokes(
    rng: np.random.Generator,
    rows: int,
    speed: FloatArray,
    reach: FloatArray,
    rate: FloatArray,
    stuck: FloatArray,
) -> FloatArray:
    """Path (rows, n) to and fro, each stroke with its own speed, down to a sixth of `speed`.

    A part has strokes of one order of length, `reach`: what small ones show, large ones drown. Each
    is longer by what friction takes of it, which is passed quickly.
    """
    path, n = np.zeros((rows, len(speed))), len(speed)
    for j in range(n):
        at, row, sign = 0.0, 0, rng.choice([-1.0, 1.0])
        while row < rows:
            length = reach[j] * np.exp(rng.uniform(-0.4, 0.4))
            pace = speed[j] * np.exp(rng.uniform(-1.8, 0.0))
            pace = max(pace, min(length / _LONGEST, speed[j]))
            stroke = _stroke(length, pace, _RAMP * rate[j])
            if stuck[j] > 0.0:  # at once through what friction takes, while nothing moves
                first = _stroke(stuck[j], np.inf, _RAMP * rate[j])
                stroke = np.concatenate([first, stuck[j] + stroke])
            end = min(row + len(stroke), rows)
            path[row:end, j] = at + sign * stroke[: end - row]
            aim = at + sign * (length + stuck[j])
            at, row, sign = aim, end, -sign
    return path


def _stroke(length: float, pace: float, rate: float) -> FloatArray:
    """Positions from 0 to a length with a trapezoid of speed, on the grid of a path."""
    pace = min(pace, float(np.sqrt(rate * max(length, 1e-6))))
    ramp = pace / rate
    whole = ramp + length / pace
    rows = max(round(whole / STEP), 2)
    t = np.linspace(0.0, whole, rows)
    speed = np.clip(np.minimum(t, whole - t) / ramp, 0.0, 1.0)
    travelled = np.cumsum(speed)
    return np.asarray(length * travelled / travelled[-1], dtype=np.float64)


def _moves(
    rng: np.random.Generator, rows: int, speed: FloatArray, reach: FloatArray, rate: FloatArray
) -> FloatArray:
    """Path (rows, n) from pose to pose, resting shortly at each, of all joints or half of them."""
    n = len(speed)
    path, row, here = np.zeros((rows, n)), 0, np.zeros(n)
    while row < rows:
        goal = rng.uniform(-1.0, 1.0, n) * reach
        if rng.random() < _SOME:
            goal = np.where(rng.random(n) < _HALF, goal, here)
        distance = np.abs(goal - here)
        # With ramps of a fifth the speed is 1.25 D / T, the acceleration 6.25 D / T^2.
        by_rate = float(np.max(np.sqrt(6.25 * distance / (_RAMP * rate))))
        needed = max(float(np.max(1.25 * distance / speed)), by_rate, 0.3)
        count = max(round(needed / STEP), 2)
        t = np.linspace(0.0, 1.0, count)
        pace = np.cumsum(np.clip(np.minimum(t, 1.0 - t) / 0.2, 0.0, 1.0))
        end = min(row + count, rows)
        path[row:end] = here + (pace / pace[-1])[: end - row, None] * (goal - here)
        here, row = goal, end
        end = min(row + round(rng.uniform(0.1, 0.5) / STEP), rows)
        path[row:end] = here
        row = end
    return path


def _random_part(rng: np.random.Generator) -> Part:
    return Part(
        kind=KINDS[int(rng.integers(len(KINDS)))],
        seed=_seed(rng),
        share=float(rng.uniform(0.3, 1.0)),
        pace=float(np.exp(rng.uniform(np.log(_SLOWEST), 0.0))),
        reach=float(rng.uniform(0.3, 1.0)),
        alone=bool(rng.random() < _ALONE),
    )


def _near(rng: np.random.Generator, share: float) -> float:
    return float(np.clip(share * np.exp(rng.normal(0.0, 0.4)), _SLOWEST, 1.0))


def _seed(rng: np.random.Generator) -> int:
    return int(rng.integers(2**31))
