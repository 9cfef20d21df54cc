"""One throw, not foreseen: the Tracker sees the cloud of the moment and nothing else."""

from __future__ import annotations

from pdoik.h1.draw_throws import REACT_SPEEDS, control_run
from pdoik.h1.follow import PERIOD, Follower, Steps
from pdoik.h1.measures import run_measures, steps_measures
from pdoik.h1.model import Setup, build_world
from pdoik.h1.objects import FlyingObject
from pdoik.h1.simulate import Run, simulate
from pdoik.h1.standing import standing_posture
from pdoik.h1.store import Record, throw_record
from pdoik.h1.throws import Throw

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
