"""Motions of a held-out recording: the machine's, those of models, and the machine's another day.

The controller is the machine's own, which the diagnosis was never told: it is given to every model
alike, so that what differs is what the models say of the arm.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.concealed.motion import Motion
from bench.sim2real.machines.build import Draft, run
from bench.sim2real.machines.chain import chain_of
from bench.sim2real.machines.control import law
from bench.sim2real.machines.figures import Array
from bench.sim2real.machines.held_out.true_law import draft_behind
from bench.sim2real.machines.spec import WorldSpec
from pdoik.sim2real import Diagnosis, Model, load_study
from pdoik.sim2real.simulation.stepper import SimulationError


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


def replays_of(world: str, study: Path, truth: dict[str, Any], said: str) -> list[Replay]:
    """Every joint's, in the first recording that only judges."""
    spec = WorldSpec(**{**truth["spec"], "faults": tuple(truth["spec"]["faults"])})
    draft = draft_behind(spec, [each["parameters"] for each in truth["faults"]])
    at = draft.roles.index("validate")
    machine = run(draft, draft.faults)[1][at].rotor
    usual = run(_on_a_mean_day(draft), draft.faults)[1][at].rotor
    model = Model.of_study(load_study(study), Diagnosis.from_json(said).findings)
    paths = [_replayed(draft, draft.motions[at], model, findings) for findings in (False, True)]
    faulty = {name for fault in truth["faults"] for name in fault["joints"]}
    errors = [np.sqrt(np.mean((path - machine) ** 2, axis=0)) for path in (*paths, usual)]
    return [
        Replay(
            world=world,
            joint=name,
            faulty=name in faulty,
            moved=float(np.std(machine[:, j])),
            before=float(errors[0][j]),
            after=float(errors[1][j]),
            another_day=float(errors[2][j]),
        )
        for j, name in enumerate(truth["joints"])
    ]


def _on_a_mean_day(draft: Draft) -> Draft:
    warmer = np.mean([day["warmer"] for day in draft.days], axis=0)
    usual = {"friction": np.ones(draft.machine.arm.n), "warmer": warmer}
    return replace(draft, days=tuple({**day, **usual} for day in draft.days))


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
