"""One throw, foreseen: search, plan, follow, and what others say of it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from bench.humanoid.dodge.follow import PERIOD, Follower, Steps
from bench.humanoid.dodge.plan import DodgeSearch, Plan, Planner
from bench.humanoid.trials.checks import check_answers
from bench.humanoid.trials.draw_throws import control_run
from bench.humanoid.trials.measures import run_measures, steps_measures
from bench.humanoid.trials.store import Record, plan_record, throw_record
from bench.humanoid.world.model import World, build_world
from bench.humanoid.world.objects import FlyingObject
from bench.humanoid.world.robot import Setup
from bench.humanoid.world.simulate import Run, simulate
from bench.humanoid.world.throws import Throw


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """How long to look, and at what."""

    seconds: float = 2.0  # of the search for a throw [s]
    long_seconds: float = 20.0  # of the search that says whether a throw can be dodged, in all [s]
    long_seeds: int = 2  # searches that share long_seconds
    long_plans: int = 12  # the best of each search that are tried in simulation
    after: float = 2.0  # how long a run goes on behind the dodge [s]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trial:
    """One run that followed a plan, and the control loop's answers in it."""

    world: World
    plan: Plan
    run: Run
    steps: Steps


def follow_plan(world: World, plan: Plan, throw: Throw, after: float) -> Trial:
    """Follow a plan in simulation at 1 kHz until `after` seconds behind the throw, or contact."""
    follower = Follower(world.setup, plan.q_stand, plan)
    run = simulate(
        world,
        plan.q_stand,
        follower,
        duration=throw.duration + after,
        throw=throw,
        stop_at_contact=True,
        desired_period=PERIOD,
    )
    return Trial(world=world, plan=plan, run=run, steps=follower.steps())


def predict(
    setup: Setup, thing: FlyingObject, throw: Throw, planner: Planner, budget: Budget, seed: int
) -> tuple[Record, Trial | None]:
    """Foresee one throw: the record, and the run of its best plan, None if there is no plan.

    Where the best plan fails, the longer search says whether any would have done.
    """
    world = build_world(setup, thing)
    contact = control_run(world, throw)
    record: Record = {
        "setup": setup.name,
        "throw": throw_record(throw),
        "standing_still": None
        if contact is None
        else {"time": contact.time, "link": contact.link, "geom": contact.robot_geom},
    }
    due = throw.arrival if contact is None else contact.time
    plans, record["search"] = _search(setup, thing, throw, planner, due, budget.seconds, seed)
    trial = follow_plan(world, plans[0], throw, budget.after) if plans else None
    if trial is not None:
        record["plan"] = plan_record(trial.plan)
        record["run"] = run_measures(world, trial.run)
        record["answers"] = steps_measures(trial.steps)
        record["checks"] = check_answers(world, throw, trial.run.time, trial.run.q_des)
    if trial is None or not trial.run.dodged:
        record["long"] = _long_search(world, thing, throw, planner, due, budget, seed, plans[1:])
    return record, trial


def _search(
    setup: Setup,
    thing: FlyingObject,
    throw: Throw,
    planner: Planner,
    due: float,
    seconds: float,
    seed: int,
) -> tuple[list[Plan], Record]:
    search = DodgeSearch(setup, thing, throw, seed)
    search.search(seconds)
    begin = time.perf_counter()
    plans = planner.plans(search, throw, thing, due)
    return plans, {
        "seed": seed,
        "seconds": seconds,
        "tried": search.tried,
        "found": len(search.postures),
        "plans": len(plans),
        "planning_seconds": time.perf_counter() - begin,
    }


def _long_search(
    world: World,
    thing: FlyingObject,
    throw: Throw,
    planner: Planner,
    due: float,
    budget: Budget,
    seed: int,
    others: list[Plan],
) -> Record:
    """Try the plans that the short search left, then those of other seeds, until one dodges."""
    record: Record = {"searches": [], "simulated": 0, "dodged": False, "outcomes": []}

    def one_dodges(plans: list[Plan]) -> bool:
        for plan in plans[: budget.long_plans]:
            run = follow_plan(world, plan, throw, budget.after).run
            record["simulated"] += 1
            record["outcomes"].append(_outcome(run))
            if run.dodged:
                record["dodged"], record["plan"] = True, plan_record(plan)
                return True
        return False

    if one_dodges(others):
        return record
    for k in range(budget.long_seeds):
        plans, found = _search(
            world.setup,
            thing,
            throw,
            planner,
            due,
            budget.long_seconds / budget.long_seeds,
            seed + 1000 * (k + 1),
        )
        record["searches"].append(found)
        if one_dodges(plans):
            break
    return record


def _outcome(run: Run) -> str:
    if run.contact is not None:
        return f"touched {run.contact.link} at {run.contact.time:.2f} s"
    distance = f"{1e3 * run.least_distance:.0f} mm"
    if not run.stands:
        return f"fell over, untouched by {distance}"
    return f"dodged by {distance}"
