"""Runs and answers in numbers."""

from __future__ import annotations

from collections import Counter

import numpy as np

from bench.common.arrays import FloatArray
from bench.humanoid.dodge.follow import Steps
from bench.humanoid.trials.store import Record
from bench.humanoid.world.model import World
from bench.humanoid.world.simulate import AT_THE_END, Run
from bench.humanoid.world.standing import COM_LOWER, COM_UPPER
from pdoik.view.h1_shapes import JOINT_NAMES

SUSTAINED = 0.02  # a torque at its limit for so long counts as saturated [s]
FOOT_TILTS = np.radians(1.0)  # a sole that turns so far has lifted [rad]


def run_measures(world: World, run: Run) -> Record:
    """What a simulation says of one run."""
    contact = run.contact
    beyond = beyond_box(run.com)
    lag = np.abs(run.q_des - run.q).max(axis=0)
    return {
        "untouched": contact is None,
        "stands": run.stands,
        "dodged": run.dodged,
        "contact": None
        if contact is None
        else {"time": contact.time, "link": contact.link, "geom": contact.robot_geom},
        "fallen": run.fallen,
        "duration": float(run.time[-1]),
        "least_distance": run.least_distance if len(run.distance) else None,
        "com_beyond_box": beyond.max(axis=0),  # (3,) [m]
        "com_beyond_box_at_end": beyond[run.time >= run.time[-1] - AT_THE_END].max(axis=0),
        "foot_drift": run.foot_drift,
        "foot_tilt": float(_tilt(run).max()),
        "lag": float(lag.max()),
        "lag_joint": JOINT_NAMES[int(lag.argmax())],
        "saturation": {
            name: float(share)
            for name, share in zip(JOINT_NAMES, run.saturation, strict=True)
            if share > 0
        },
        "first_saturated": first_saturated(world, run),
        "first_lifted": _first(run, _tilt(run) > FOOT_TILTS),
    }


def beyond_box(com: FloatArray) -> FloatArray:
    """How far points (T, 3) are outside the box of Eq. com, (T, 3), 0 inside [m]."""
    return np.asarray(np.maximum(0.0, np.maximum(COM_LOWER - com, com - COM_UPPER)))


def first_saturated(world: World, run: Run) -> Record | None:
    """The joint whose torque is first at its limit for SUSTAINED, and since when."""
    at_limit = np.abs(run.tau) >= world.effort - 1e-9  # (T, 19)
    n = max(1, round(SUSTAINED / float(world.model.opt.timestep)))
    if len(at_limit) < n:
        return None
    total = np.vstack([np.zeros((1, at_limit.shape[1])), np.cumsum(at_limit, axis=0)])
    since, joint = np.nonzero(total[n:] - total[:-n] >= n)  # by time, then joint
    if not len(since):
        return None
    return {"joint": JOINT_NAMES[int(joint[0])], "time": float(run.time[since[0]])}


def _tilt(run: Run) -> FloatArray:
    """Tilt of the foot that is farther from level, (T,) [rad]."""
    x, y = run.feet[:, :, 4], run.feet[:, :, 5]
    return np.asarray(np.arccos(np.clip(1 - 2 * (x * x + y * y), -1, 1)).max(axis=1))


def _first(run: Run, seen: FloatArray) -> float | None:
    where = np.flatnonzero(seen)
    return float(run.time[where[0]]) if len(where) else None


def steps_measures(steps: Steps) -> Record:
    """What the Tracker says of its own answers."""
    bad = [answer for answer in steps.answers if answer.tracking != "tracking"]
    worst = Counter(f"{answer.tracking}: {answer.worst_constraint}" for answer in bad)
    return {
        "rate": [float(np.quantile(steps.rate, share)) for share in (0, 0.5, 1)],  # [Hz]
        "statuses": dict(Counter(answer.tracking for answer in steps.answers)),
        "worst_when_not_tracking": dict(worst.most_common(5)),
        "position_error": float(steps.column("position_error").max()),
        "rotation_error": float(steps.column("rotation_error").max()),
        "balance_violation": float(steps.column("balance_violation").max()),
        "clearance": float(steps.column("clearance").min()),
        "self_distance": float(steps.column("self_distance").min()),
        "largest_jump": steps.largest_jump,  # share of the step limit
    }
