"""The same machine at conditions its study does not show: faster, in other poses, with a load."""

import json
from collections.abc import Callable
from dataclasses import field
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.concealed import build
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect, effect
from bench.sim2real.concealed.logger import Take
from bench.sim2real.concealed.reference import reference
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.concealed.world import Run, World
from bench.sim2real.frame.arm import Arm, Link, urdf
from bench.sim2real.frame.motion import STEP, Motion, Style, recording_motion

CONDITIONS = ("faster", "poses", "load")
DURATION = 20.0  # of each recording [s]
EFFORT = 0.85  # of the drives' effort that the believed machine may need
SPEED = 0.95  # of the drives' speed


@effect("known_load")
class KnownLoad(Effect):
    """A body fixed to the last link, after whatever else has changed it; it is known to all."""

    body: Link = field(kw_only=True)

    def change_arm(self, arm: Arm) -> Arm:
        return arm.with_link(arm.n - 1, arm.links[-1].plus(self.body))


def make_beyond(folder: Path, spec: WorldSpec) -> dict[str, Any]:
    """Writes faster.csv, poses.csv, load.csv, robot_loaded.urdf, conditions.json and truth.npz.

    The machine, with what is hidden in it, is that of `make_study` of the same spec. The truth has
    NAME_time, NAME_q, NAME_dq and NAME_tau of each recording, without noise, along the chain.
    Gives what conditions.json has: how the conditions differ from those of the fit.
    """
    draft = draft_of(spec)
    effects = build._visible(draft)[0].effects
    load = KnownLoad(body=known_load(draft.arm, spec.stream("known load")))
    loaded = load.change_arm(draft.believed)
    folder.mkdir(parents=True, exist_ok=True)
    facts: dict[str, Any] = {"load": {"mass": load.body.mass, "com": load.body.com.tolist()}}
    noiseless = {}
    for index, name in enumerate(CONDITIONS):
        more, believed = ((load,), loaded) if name == "load" else ((), draft.believed)
        world = World(
            draft.arm, draft.armature, draft.control, draft.sensors, (*effects, *more), believed
        )
        motion, take = _bearable(draft, world, believed, name, index)
        shuffle = spec.stream(f"columns {name}")
        true = take.write(folder / f"{name}.csv", build.logged(draft), shuffle, tip=False)
        noiseless |= {f"{name}_{key}": values for key, values in true.items()}
        facts[name] = facts.get(name, {}) | compared(draft, motion)
    (folder / "robot_loaded.urdf").write_text(urdf(loaded))
    (folder / "conditions.json").write_text(json.dumps(facts, indent=1, sort_keys=True) + "\n")
    np.savez_compressed(folder / "truth.npz", **noiseless)
    return facts


def known_load(arm: Arm, rng: np.random.Generator) -> Link:
    """A box at the tip, 20 to 30 % as heavy as the last three links."""
    mass = sum(link.mass for link in arm.links[-3:]) * rng.uniform(0.2, 0.3)
    size = rng.uniform(0.04, 0.09, 3)
    com = arm.T_last_tip[:3, 3] + rng.uniform(-0.03, 0.03, 3)
    inertia = mass / 12.0 * np.diag(size @ size - size**2)
    digits = np.vectorize(lambda value: float(f"{value:.5g}"))
    return Link(mass=float(f"{mass:.4g}"), com=digits(com), inertia=digits(inertia))


def _of_the_fit(draft: Draft, name: str) -> np.ndarray:
    return np.concatenate(
        [
            getattr(m, name)
            for role, m in zip(draft.roles, draft.motions, strict=True)
            if role == "fit"
        ]
    )


def compared(draft: Draft, motion: Motion) -> dict[str, Any]:
    """How fast and how far outside the fit a motion is."""
    q, dq = _of_the_fit(draft, "q"), _of_the_fit(draft, "dq")
    outside = (motion.q < q.min(axis=0)) | (motion.q > q.max(axis=0))
    speeds = np.sqrt(np.mean(motion.dq**2, axis=0) / np.maximum(np.mean(dq**2, axis=0), 1e-12))
    return {
        "speed_ratio": round(float(np.median(speeds)), 3),
        "share_outside": round(float(np.mean(outside)), 3),
    }


def _bearable(
    draft: Draft, world: World, believed: Arm, name: str, index: int
) -> tuple[Motion, Take]:
    """The motion as it is wanted, or tamer until drives and controller bear it."""
    makers: dict[str, Callable[[Draft, float], Motion]] = {"faster": _faster, "poses": _elsewhere}
    for ease in (1.0, 0.9, 0.8, 0.7, 0.55, 0.4, 0.25):
        motion = makers.get(name, _ordinary)(draft, ease)
        ref = reference(believed, draft.armature, [motion])
        if ease > 0.25 and np.any(np.abs(ref.tau) > EFFORT * draft.arm.efforts):
            continue
        run = Run(world, motion, len(draft.motions) + index, draft.spec.stream(f"run {name}"))
        try:
            return motion, Take.of(run)
        except RuntimeError:
            continue
    raise RuntimeError(f"no arm came through {name}: {draft.spec}")


def _plain(draft: Draft, name: str, duration: float = DURATION, pace: float = 0.8) -> Motion:
    """As the study's motions are."""
    rng = draft.spec.stream(f"beyond {name}")
    return recording_motion(draft.arm, rng, ("moves", "sines"), duration, pace, Style())


def _ordinary(draft: Draft, ease: float) -> Motion:
    return _plain(draft, "load", pace=0.8 * ease)


def _faster(draft: Draft, ease: float) -> Motion:
    """A motion as the fit's, played up to twice as fast; reach gives way to the drives' speed."""
    pace = 1.0 + ease
    plain = _plain(draft, "faster", pace * DURATION)
    time = STEP * np.arange(round(DURATION / STEP))
    q = np.stack([np.interp(pace * time, plain.time, column) for column in plain.q.T], axis=1)
    peak = np.max(np.abs(np.diff(q, axis=0)), axis=0) / STEP
    share = np.minimum(1.0, SPEED * draft.arm.speeds / np.maximum(peak, 1e-9))
    return Motion.of(q[0] + (q - q[0]) * share)


def _elsewhere(draft: Draft, ease: float) -> Motion:
    """About poses at the side of the fit's where there is more room."""
    q, plain = _of_the_fit(draft, "q"), _plain(draft, "poses").q
    low, high = q.min(axis=0), q.max(axis=0)
    lower, upper = draft.arm.limits
    up = upper - high > low - lower
    room = np.where(up, upper - 0.05 - plain.max(axis=0), plain.min(axis=0) - lower - 0.05)
    shift = ease * np.clip(room, 0.0, 1.5)
    return Motion.of(plain + np.where(up, shift, -shift))
