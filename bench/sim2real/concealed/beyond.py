"""The same machine at conditions its study does not show: faster, in other poses, with a load."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.concealed import build, logger
from bench.sim2real.concealed.arm import Arm, Array, Link, urdf
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect
from bench.sim2real.concealed.motion import STEP, Motion, Style, recording_motion
from bench.sim2real.concealed.reference import reference
from bench.sim2real.concealed.spec import WorldSpec
from bench.sim2real.concealed.study_files import write_recording
from bench.sim2real.concealed.world import Run, World

CONDITIONS = ("faster", "poses", "load")
DURATION = 20.0  # of each recording [s]
KINDS = ("moves", "sines")
EFFORT = 0.85  # of the drives' effort that the believed machine may need
SPEED = 0.95  # of the drives' speed


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownLoad(Effect):
    """A body fixed to the last link of which everybody is told."""

    body: Link = field(kw_only=True)

    id = "known_load"

    def change_arm(self, arm: Arm) -> Arm:
        """With the load, after whatever else has changed the last link."""
        return arm.with_link(arm.n - 1, arm.links[-1].plus(self.body))


def make_beyond(folder: Path, spec: WorldSpec) -> dict[str, Any]:
    """Writes faster.csv, poses.csv, load.csv, robot_loaded.urdf, conditions.json and truth.npz.

    The machine, with what is hidden in it, is that of `make_study` of the same spec. The truth has
    NAME_time, NAME_q, NAME_dq and NAME_tau of each recording, without noise, along the chain.
    Gives what conditions.json has: how the conditions differ from those of the fit.
    """
    draft = draft_of(spec)
    effects = build._visible(draft)[0].effects
    load = known_load(draft.arm, spec.stream("known load"))
    loaded = draft.believed.with_link(draft.arm.n - 1, draft.believed.links[-1].plus(load))
    folder.mkdir(parents=True, exist_ok=True)
    facts: dict[str, Any] = {"load": {"mass": load.mass, "com": load.com.tolist()}}
    logged, noiseless = build._logged(draft), {}
    for index, name in enumerate(CONDITIONS):
        more = (KnownLoad(body=load),) if name == "load" else ()
        believed = loaded if more else draft.believed
        world = World(
            draft.arm, draft.armature, draft.control, draft.sensors, (*effects, *more), believed
        )
        motion, run, rows = _bearable(draft, world, believed, name, index)
        channels = logger.channels_of(rows, run)
        kept = logger.rows_of(channels, run)
        data = logger.measured(channels, run, kept)
        shuffle = spec.stream(f"columns {name}")
        write_recording(folder / f"{name}.csv", data, logged, None, shuffle)
        true = {"time": rows.time, "q": rows.q, "dq": rows.dq, "tau": channels["tau"]}
        noiseless |= {f"{name}_{key}": values[kept] for key, values in true.items()}
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


def compared(draft: Draft, motion: Motion) -> dict[str, Any]:
    """How fast and how far outside the fit a motion is."""
    fits = [m for role, m in zip(draft.roles, draft.motions, strict=True) if role == "fit"]
    q = np.concatenate([fit.q for fit in fits])
    dq = np.concatenate([fit.dq for fit in fits])
    outside = (motion.q < q.min(axis=0)) | (motion.q > q.max(axis=0))
    speeds = np.sqrt(np.mean(motion.dq**2, axis=0) / np.maximum(np.mean(dq**2, axis=0), 1e-12))
    return {
        "speed_ratio": round(float(np.median(speeds)), 3),
        "share_outside": round(float(np.mean(outside)), 3),
    }


def _bearable(
    draft: Draft, world: World, believed: Arm, name: str, index: int
) -> tuple[Motion, Run, Any]:
    """The motion as it is wanted, or tamer until drives and controller bear it."""
    make: Callable[[Draft, float], Motion] = {"faster": _faster, "poses": _elsewhere}.get(
        name, _ordinary
    )
    efforts = np.array([joint.effort for joint in draft.arm.joints])
    for ease in (1.0, 0.9, 0.8, 0.7, 0.55, 0.4, 0.25):
        motion = make(draft, ease)
        ref = reference(believed, draft.armature, [motion])
        if ease > 0.25 and np.any(np.abs(ref.tau) > EFFORT * efforts):
            continue
        run = Run(world, motion, len(draft.motions) + index, draft.spec.stream(f"run {name}"))
        try:
            return motion, run, run.simulate()
        except RuntimeError:
            continue
    raise RuntimeError(f"no arm came through {name}: {draft.spec}")


def _ordinary(draft: Draft, ease: float) -> Motion:
    """As the study's motions are."""
    rng = draft.spec.stream("beyond load")
    return recording_motion(draft.arm, rng, KINDS, DURATION, 0.8 * ease, Style())


def _faster(draft: Draft, ease: float) -> Motion:
    """A motion as the fit's, played up to twice as fast; reach gives way to the drives' speed."""
    pace = 1.0 + ease
    rng = draft.spec.stream("beyond faster")
    plain = recording_motion(draft.arm, rng, KINDS, pace * DURATION, 0.8, Style())
    time = STEP * np.arange(round(DURATION / STEP))
    q = np.stack([np.interp(pace * time, plain.time, column) for column in plain.q.T], axis=1)
    peak = np.max(np.abs(np.diff(q, axis=0)), axis=0) / STEP
    limits = np.array([joint.speed for joint in draft.arm.joints])
    share = np.minimum(1.0, SPEED * limits / np.maximum(peak, 1e-9))
    return _motion(q[0] + (q - q[0]) * share)


def _elsewhere(draft: Draft, ease: float) -> Motion:
    """About poses at the side of the fit's where there is more room."""
    fits = [m for role, m in zip(draft.roles, draft.motions, strict=True) if role == "fit"]
    q = np.concatenate([fit.q for fit in fits])
    low, high = q.min(axis=0), q.max(axis=0)
    lower = np.array([joint.lower for joint in draft.arm.joints])
    upper = np.array([joint.upper for joint in draft.arm.joints])
    rng = draft.spec.stream("beyond poses")
    plain = recording_motion(draft.arm, rng, KINDS, DURATION, 0.8, Style()).q
    up = upper - high > low - lower
    room = np.where(up, upper - 0.05 - plain.max(axis=0), plain.min(axis=0) - lower - 0.05)
    shift = ease * np.clip(room, 0.0, 1.5)
    return _motion(plain + np.where(up, shift, -shift))


def _motion(q: Array) -> Motion:
    dq = np.gradient(q, STEP, axis=0)
    return Motion(q=q, dq=dq, ddq=np.gradient(dq, STEP, axis=0))
