"""How often `pdoik compare` names what a machine has beyond its simulator, from positions alone.

    python -m bench.sim2real.simulators --out build/bench/simulators

Pairs are made here: the user's MJCF (an arm, or a quadruped that hangs), and a "machine" that is
the same with something concealed, simulated in a fourth of the simulator's step and seen through
noisy encoders. Commands and positions are all that is given. Finished pairs are kept, and the
same command goes on where it was stopped.
"""

import copy
from dataclasses import replace
from typing import Annotated

import numpy as np
import pandas as pd
import typer

from bench.common.campaign import Campaign, Row
from bench.common.commands import BUILD, OutFolder, console
from bench.common.markdown import markdown_table
from bench.sim2real.simulators.robots import Robot, position_servos, robots
from pdoik.sim2real import Recording, Thresholds
from pdoik.sim2real.simulation import build_plant, mjcf_text, movable_joints, read_description
from pdoik.sim2real.simulators import (
    EVERY,
    ParameterId,
    Step,
    UserModel,
    baseline,
    explain,
    place_of,
    simulated,
    step_of,
    user_model,
)

PERIOD = 5e-3  # of the logs [s]
SAME = {"kv": {"kv", "damping"}, "damping": {"damping", "kv"}, "mass": {"mass", "payload"}}
"""Names that count as right: one torque, or one body."""


def mjcf_of(robot: Robot) -> tuple[str, tuple[str, ...]]:
    joints = movable_joints(read_description(robot.urdf))[: robot.joints]
    others = movable_joints(read_description(robot.urdf))[robot.joints :]
    plant = build_plant(robot.urdf, (*joints, *others))
    for k, dof in enumerate(plant.dof):
        own = robot.damping[k] if k < robot.joints else 10.0
        plant.model.dof_damping[dof] = own
        plant.model.dof_armature[dof] = 0.01
        plant.model.dof_frictionloss[dof] = 0.2 * own
    servos = position_servos(joints, robot.kp, robot.kv)
    return mjcf_text(plant.model, actuators=servos, timestep=2e-3), joints


def commands(robot: Robot, seconds: float, role: str, rng: np.random.Generator) -> Recording:
    """Slow and fast sines of every joint, as one would excite a robot."""
    time = np.arange(0.0, seconds, PERIOD)
    n = robot.joints
    q = np.tile(np.array(robot.rest), (len(time), 1))
    for low, high, size in ((0.1, 0.4, 0.25), (0.5, 1.5, 0.12), (1.5, 3.5, 0.03)):
        f, phase = rng.uniform(low, high, n), rng.uniform(0.0, 2 * np.pi, n)
        q += size * np.sin(2 * np.pi * f * time[:, None] + phase)
    return Recording(
        name=f"{role}.csv",
        role="fit" if role == "fit" else "validate",
        start=0.0,
        time=time,
        q=q,
        q_des=q,
        valid=np.ones(len(time), dtype=bool),
        raw_period=PERIOD,
        jitter=0.0,
    )


def conceal(
    user: UserModel, kinds: list[str], rng: np.random.Generator
) -> dict[ParameterId, float]:
    """What the machine has, sizes as machines have them."""
    values: dict[ParameterId, float] = {}
    taken: set[int] = set()
    for kind in kinds:
        if kind == "shared delay":
            values[ParameterId("delay", EVERY)] = float(rng.uniform(4e-3, 20e-3))
            continue
        free = [k for k in range(len(user.joints)) if k not in taken]
        if kind == "mass":  # on a link that is moved by more than its own turning
            free = [k for k in free if k in _last_links(user)]
        k = int(rng.choice(free))
        taken.add(k)
        parameter = ParameterId(kind, k)
        value = baseline(user, parameter)
        drive = baseline(user, ParameterId("kp", k))
        values[parameter] = {
            "damping": lambda v, d: v + rng.uniform(0.01, 0.04) * d,
            "frictionloss": lambda v, d: v + rng.uniform(0.004, 0.02) * d,
            "armature": lambda v, d: v + rng.uniform(0.0004, 0.0015) * d,
            "kp": lambda v, d: v * rng.choice([rng.uniform(0.7, 0.9), rng.uniform(1.1, 1.4)]),
            "kv": lambda v, d: v * rng.uniform(0.4, 0.8),
            "delay": lambda v, d: rng.uniform(5e-3, 20e-3),
            "mass": lambda v, d: v + rng.uniform(0.3, 1.0) * max(v, 0.3),
            "ref": lambda v, d: rng.choice([-1, 1]) * rng.uniform(0.03, 0.1),
        }[kind](value, drive)
        values[parameter] = float(values[parameter])
    return values


def pair(job: dict[str, object]) -> list[Row]:
    """One concealed pair, explained and scored: a row for each concealed cause, or one for none."""
    rng = np.random.default_rng(int(str(job["seed"])))
    robot = robots()[str(job["robot"])]
    text, joints = mjcf_of(robot)
    user = user_model(text, joints, name="user.xml")
    kinds = [each for each in str(job["kinds"]).split("+") if each != "nothing"]
    values = conceal(user, kinds, rng)
    fine = copy.copy(user.model)
    fine.opt.timestep = user.timestep / 4
    machine = replace(user, model=fine)
    noise = float(rng.choice([1e-4, 3e-4, 1e-3]))
    logs = []
    for seconds, role in ((14.0, "fit"), (8.0, "validate")):
        log = simulated(machine, commands(robot, seconds, role, rng), values)
        logs.append(replace(log, q=log.q + rng.normal(0.0, noise, log.q.shape), tau=None, dq=None))
    limits = Thresholds().simulators
    step = step_of(explain(user, logs[:1], logs[1:], limits), "machine", limits)
    return _scored(step, values, {"robot": str(job["robot"]), "noise": noise})


def _scored(step: Step, values: dict[ParameterId, float], about: Row) -> list[Row]:
    user = step.explained.user
    matched: set[int] = set()
    rows: list[Row] = []
    for parameter, value in values.items():
        place = "" if parameter.index == EVERY else place_of(user, parameter)
        names = SAME.get(parameter.property, {parameter.property})
        claimed, estimate = False, None
        for i, finding in enumerate(step.findings):
            where = (*finding.joints, *finding.links)
            right = len(where) == len(user.joints) if not place else where == (place,)
            others = {each.effect for each in finding.equivalents if place in each.joints}
            if right and (finding.effect in names or names & others):
                matched.add(i)
                claimed = True
                estimate = finding.parameters.get(parameter.property)
        listed = claimed or any(
            f.effect in names and (not place or place in (*f.joints, *f.links))
            for f in step.suspected
        )
        low, high = estimate.interval95 if estimate else (np.nan, np.nan)
        rows.append(
            {
                **about,
                "cause": "shared delay" if not place else parameter.property,
                "claimed": claimed,
                "listed": listed,
                "truth": value,
                "value": estimate.value if estimate else np.nan,
                "inside": bool(low <= value <= high) if estimate else None,
            }
        )
    before = np.sqrt(np.mean([fit.before**2 for fit in step.joints.values()]))
    after = np.sqrt(np.mean([fit.after**2 for fit in step.joints.values()]))
    false = [f.statement for i, f in enumerate(step.findings) if i not in matched]
    shared = {"false": len(false), "said": "; ".join(false), "before": before, "after": after}
    rows = rows or [{**about, "cause": "nothing", "claimed": not false, "listed": not false}]
    return [{**row, **(shared if k == 0 else {"false": 0})} for k, row in enumerate(rows)]


def _last_links(user: UserModel) -> list[int]:
    parents = user.model.body_parentid
    moved = {user.body_of(k) for k in range(len(user.joints))}
    return [
        k
        for k in range(len(user.joints))
        if not any(int(parents[other]) == user.body_of(k) for other in moved)
    ]


def jobs_of(count: int) -> dict[str, dict[str, object]]:
    """Jobs by name: a seventh with nothing, two fifths of the rest with two causes."""
    rng = np.random.default_rng(20)
    kinds = (
        *("damping", "frictionloss", "armature", "kp", "kv", "delay", "shared delay", "mass"),
        *("ref",),
    )
    known = list(robots())
    found: dict[str, dict[str, object]] = {}
    for k in range(count):
        if k % 7 == 6:
            said = "nothing"
        else:
            first = kinds[(k - k // 7) % len(kinds)]
            rest = [kind for kind in kinds if kind != first]
            said = f"{first}+{rng.choice(rest)}" if k % 5 in (1, 3) else first
        found[f"pair_{k:03d}"] = {"robot": known[k % len(known)], "kinds": said, "seed": 1000 + k}
    return found


def table(rows: pd.DataFrame) -> str:
    """Table by cause: how often claimed, listed at all, and its size within the interval."""
    lines = []
    for cause, each in rows.groupby("cause"):
        known = each["inside"].dropna()
        inside = f"{int(known.sum())} / {len(known)}" if len(known) else ""
        lines.append(
            (
                cause,
                f"{int(each['claimed'].sum())} / {len(each)}",
                f"{int(each['listed'].sum())} / {len(each)}",
                inside,
                int(each["false"].sum()),
            )
        )
    header = ("concealed", "claimed by name and joint", "or suspected", "size in its interval")
    return markdown_table((*header, "false"), lines)


def main(
    out: OutFolder = BUILD / "simulators",
    pairs: Annotated[int, typer.Option(min=1, help="How many.")] = 42,
) -> None:
    """Make the pairs that are missing, and print the table."""
    campaign = Campaign(out, {"pairs": pairs})
    typer.echo(table(campaign.run_here(pair, jobs_of(pairs), console)))


if __name__ == "__main__":
    typer.run(main)
