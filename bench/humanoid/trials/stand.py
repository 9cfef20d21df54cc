"""Does it stand, and take a push?"""

from __future__ import annotations

from bench.humanoid.trials.measures import run_measures
from bench.humanoid.trials.store import Record
from bench.humanoid.world.model import build_world
from bench.humanoid.world.robot import Setup
from bench.humanoid.world.simulate import Push, Run, hold, simulate
from bench.humanoid.world.standing import standing_posture

PUSH = 60.0  # [N]
PUSH_TIME = 0.1  # [s]
DIRECTIONS = {"left": (1, 0), "right": (-1, 0), "back": (0, 1), "ahead": (0, -1)}  # world x, y


def stand(setup: Setup, seconds: float, push_seconds: float) -> tuple[Record, Run]:
    """Stand for a while, then be pushed from each side."""
    world, q = build_world(setup), standing_posture(setup)
    still = simulate(world, q, hold(q), seconds)
    record: Record = {
        "setup": setup.name,
        "seconds": seconds,
        "still": run_measures(world, still),
        "force": PUSH,
        "force_seconds": PUSH_TIME,
        "pushed": {},
    }
    for name, (x, y) in DIRECTIONS.items():
        push = Push(force=(PUSH * x, PUSH * y, 0.0), begin=0.2, end=0.2 + PUSH_TIME)
        run = simulate(world, q, hold(q), push_seconds, push=push)
        record["pushed"][name] = run_measures(world, run)
    return record, still
