"""Machines with something concealed in them whose recordings hardly show what it is.

The operator moved them slowly, one joint of them only, or within a few degrees: as a first log
often is. The machine is that of bench/sim2real/concealed; so is what runs on it afterwards.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from bench.sim2real.concealed.build import hidden_in, write_machine
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.frame.arm import Array
from bench.sim2real.frame.motion import STEP, Motion, center, smoothed, smoothstep
from bench.sim2real.frame.study_files import joint_names

Way = Literal["slow", "short", "one joint", "one way"]
WAYS: tuple[Way, ...] = ("slow", "short", "one joint", "one way")
LENGTH = 9.0  # of each of two recordings [s]

Axes = tuple[int, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class PoorWorld:
    """A machine, what is concealed in it, and what was recorded of it."""

    draft: Draft  # with the poor motions
    effects: tuple[Effect, ...]

    def write(self, folder: Path, *more: Motion) -> Path:
        """The study's folder, with further motions run on the machine; gives study.yaml."""
        folder.mkdir(parents=True, exist_ok=True)
        draft = replace(
            self.draft,
            motions=[*self.draft.motions, *more],
            roles=[*self.draft.roles, *("fit" for _ in more)],
        )
        write_machine(folder, draft, self.effects)
        return folder / "study.yaml"

    @property
    def hidden(self) -> dict[str, object]:
        """The effect and its place, as a truth has it."""
        names, first, ref = joint_names(self.draft.arm), self.effects[0], self.draft.ref
        return {
            "effect": first.id,
            "joints": [names[k] for k in first.joints(ref)],
            "links": [f"link{k + 1}" for k in first.links(ref)],
            "recordings": None,
            "window": None,
        }

    @property
    def beside(self) -> list[dict[str, object]]:
        """What comes with it at the same place: the dry friction of a Stribeck curve."""
        first = self.hidden
        return [{**first, "effect": name} for name in self.effects[0].beside()]


def poor_world(spec: WorldSpec, way: Way) -> PoorWorld:
    """Drawn by the spec; the effect is sized by ordinary motion, then poor motion is recorded."""
    draft = draft_of(spec)
    effects = hidden_in(draft)
    draft = replace(draft, sensors=replace(draft.sensors, tip=False))
    rng = spec.stream("poor")
    asked = effects[0].joints(draft.ref) or tuple(range(draft.arm.n))
    motions = [poor_motion(draft, rng, way, asked) for _ in range(2)]
    return PoorWorld(
        draft=replace(draft, motions=motions, roles=["fit", "validate"]), effects=effects
    )


def poor_motion(draft: Draft, rng: np.random.Generator, way: Way, asked: Axes) -> Motion:
    arm, rows = draft.arm, round(LENGTH / STEP)
    middle, half = center(arm, rng)
    time = STEP * np.arange(rows)
    make = {"slow": _creep, "short": _short, "one joint": _swing, "one way": _one_way}[way]
    path = np.column_stack([make(rng, time, float(each)) for each in half])
    if way == "one joint":
        moved = asked[int(rng.integers(len(asked)))]
        path[:, np.arange(arm.n) != moved] = 0.0
    if way != "one way":
        path = path * smoothstep(np.minimum(time, time[-1] - time) / 1.5)[:, None]
    speed = 0.6 * arm.speeds
    fastest = np.max(np.abs(np.diff(path, axis=0)), axis=0) / STEP
    return Motion.of(smoothed(middle + path * np.minimum(1.0, speed / np.maximum(fastest, 1e-9))))


def _creep(rng: np.random.Generator, time: Array, half: float) -> Array:
    """To and fro at one slow speed."""
    pace, reach = rng.uniform(0.04, 0.1), half * rng.uniform(0.08, 0.2)
    turns = time * pace / (4.0 * reach) + rng.uniform()
    return reach * (4.0 * np.abs(turns % 1.0 - 0.5) - 1.0)


def _short(rng: np.random.Generator, time: Array, half: float) -> Array:
    reach = rng.uniform(0.05, 0.12)
    rates = 2.0 * np.pi * rng.uniform(0.15, 0.6, 2)
    return 0.5 * reach * np.sin(np.outer(time, rates) + rng.uniform(0.0, 6.3, 2)).sum(axis=1)


def _swing(rng: np.random.Generator, time: Array, half: float) -> Array:
    rate = 2.0 * np.pi * rng.uniform(0.1, 0.3)
    wave = np.sin(rate * time) + 0.5 * np.sin(1.7 * rate * time + rng.uniform(0.0, 6.3))
    return 0.4 * half * wave


def _one_way(rng: np.random.Generator, time: Array, half: float) -> Array:
    """Path from one end to the other, once, (T,)."""
    s = np.clip((time - 1.0) / (time[-1] - 2.0), 0.0, 1.0)
    return rng.choice([-1.0, 1.0]) * rng.uniform(0.3, 0.7) * half * (2.0 * (s**2 * (3 - 2 * s)) - 1)
