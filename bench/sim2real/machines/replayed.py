"""Held-out motions of a run's worlds, replayed by the models that were diagnosed.

    python -m bench.sim2real.machines.replayed --worlds build/bench/machines [--tool DIGEST]

Each machine's own controller, which the diagnosis was never given, drives its model as given
and with the findings, so that what differs is what the models say of the arm. Errors are of
positions, against the machine's; then those of the machine itself on a day of mean friction.
"""

import json
from dataclasses import asdict, dataclass, replace
from itertools import islice
from typing import Annotated

import numpy as np
import pandas as pd
import typer

from bench.common.commands import console, plain_errors, show
from bench.common.whole_files import write_text
from bench.sim2real.frame.motion import Motion
from bench.sim2real.machines.build import Draft, run
from bench.sim2real.machines.chain import chain_of
from bench.sim2real.machines.control import law
from bench.sim2real.machines.figures import Array
from bench.sim2real.machines.held_out import draft_behind
from bench.sim2real.machines.worlds import Tool, World, Worlds, joint_table, worlds_of
from pdoik.sim2real import Diagnosis, Model, load_study
from pdoik.sim2real.simulation import SimulationError


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """Root mean square errors of the positions of one joint [rad]; NaN where a model ran away."""

    world: str
    joint: str
    faulty: bool
    moved: float  # of the joint itself, about its mean
    before: float
    after: float
    another_day: float  # the machine itself, its friction that of a mean day


def replays_of(world: World) -> list[Replay]:
    """Every joint's, in the first recording that only judges."""
    draft = draft_behind(world.truth)
    at = draft.roles.index("validate")
    machine = run(draft, draft.faults)[1][at].rotor
    warmer = np.mean([day["warmer"] for day in draft.days], axis=0)
    mean = {"friction": np.ones(draft.machine.arm.n), "warmer": warmer}
    usual = replace(draft, days=tuple({**day, **mean} for day in draft.days))
    said = Diagnosis.from_json(json.dumps(world.said))
    model = Model.of_study(load_study(world.study), said.findings)
    paths = [_replayed(draft, draft.motions[at], model, findings) for findings in (False, True)]
    paths.append(run(usual, draft.faults)[1][at].rotor)
    errors = [np.sqrt(np.mean((path - machine) ** 2, axis=0)) for path in paths]
    return [
        Replay(
            world=world.name,
            joint=name,
            faulty=name in world.faulty,
            moved=float(np.std(machine[:, j])),
            before=float(errors[0][j]),
            after=float(errors[1][j]),
            another_day=float(errors[2][j]),
        )
        for j, name in enumerate(world.truth["joints"])
    ]


def _replayed(draft: Draft, path: Motion, model: Model, findings: bool) -> Array:
    """Positions as encoders read them at the controller's ticks, (K, n); NaN where it ran away."""
    made = draft.machine
    flags, gains = made.control.arrays()
    believed, figures = chain_of(made.believed), made.figures.joints
    ticks, n = path.q.shape
    q_des, dq_des = np.ascontiguousarray(path.q), np.ascontiguousarray(path.dq)
    scale, offset = 1.0 + made.sensors.current_gain, made.sensors.current_offset
    stepper = model.stepper(findings=findings)
    stepper.reset(q_des[0])
    memory, command = np.zeros((4, n)), np.empty(n)
    result = np.full((ticks, n), np.nan)
    for k in range(ticks):
        read = stepper.q
        result[k] = read
        law(flags, gains, believed, memory, read, q_des, dq_des, k, figures, command)
        try:
            stepper.step(command * scale + offset)
        except SimulationError:
            return np.full((ticks, n), np.nan)
    return result


def main(
    worlds: Worlds,
    tool: Tool = "",
    most: Annotated[int, typer.Option(help="Worlds, the first ones.")] = 10_000,
) -> None:
    """Replay what is missing, print."""
    with plain_errors():
        (said,) = worlds.glob(f"said-{tool}*")
        kept = worlds / f"replayed-{said.name.removeprefix('said-')}"
        kept.mkdir(exist_ok=True)
        rows = []
        for world in islice(worlds_of(worlds, tool), most):
            path = kept / f"{world.name}.json"
            if not path.exists():
                replays = [] if world.said is None else replays_of(world)
                write_text(path, json.dumps([asdict(row) for row in replays]))
                console.print(world.name)
            rows += json.loads(path.read_text())
        show(_table(pd.DataFrame(rows)))


def _table(joints: pd.DataFrame) -> str:
    moved = joints[joints.moved > 0.01]
    headings = {
        "as told, median [mrad]": "before",
        "as diagnosed [mrad]": "after",
        "the machine, another day [mrad]": "another_day",
    }

    def better(part: pd.DataFrame) -> pd.Series:
        ran = part.dropna()
        return ran.after / ran.before

    columns = {
        "ran away as told": lambda part: int(part.before.isna().sum()),
        "ran away as diagnosed": lambda part: int(part.after.isna().sum()),
        **{
            heading: lambda part, name=name: f"{1e3 * part.dropna()[name].median():.2f}"
            for heading, name in headings.items()
        },
        "after over before, median": lambda part: f"{better(part).median():.2f}",
        "nine of ten below": lambda part: f"{better(part).quantile(0.9):.2f}",
        "better": lambda part: f"{(better(part) < 1.0).mean():.2f}",
    }
    return joint_table(moved, columns)


if __name__ == "__main__":
    typer.run(main)
