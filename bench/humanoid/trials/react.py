"""One throw, not foreseen: the Tracker sees the cloud of the moment and nothing else."""

from __future__ import annotations

from bench.humanoid.dodge.follow import PERIOD, Follower, Steps
from bench.humanoid.trials.draw_throws import REACT_SPEEDS, control_run
from bench.humanoid.trials.measures import run_measures, steps_measures
from bench.humanoid.trials.store import Record, throw_record
from bench.humanoid.world.model import build_world
from bench.humanoid.world.objects import FlyingObject
from bench.humanoid.world.robot import Setup
from bench.humanoid.world.simulate import Run, simulate
from bench.humanoid.world.standing import standing_posture
from bench.humanoid.world.throws import Throw

SPEEDS = REACT_SPEEDS


def react(
    setup: Setup, thing: FlyingObject, throw: Throw, after: float
) -> tuple[Record, Run, Steps]:
    """Run one throw at its speed and see whether it touches."""
    world = build_world(setup, thing)
    contact = control_run(world, throw)
    q = standing_posture(setup)
    follower = Follower(setup, q)
    run = simulate(
        world,
        q,
        follower,
        duration=throw.duration + after,
        throw=throw,
        stop_at_contact=True,
        desired_period=PERIOD,
    )
    steps = follower.steps()
    record: Record = {
        "setup": setup.name,
        "speed": throw.speed,
        "throw": throw_record(throw),
        "standing_still": None
        if contact is None
        else {"time": contact.time, "link": contact.link, "geom": contact.robot_geom},
        "run": run_measures(world, run),
        "answers": steps_measures(steps),
    }
    return record, run, steps
