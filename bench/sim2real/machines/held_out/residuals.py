"""Held-out torques of a world: what is left as the model is, by the diagnosis, and truly."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.machines.figures import Array
from bench.sim2real.machines.held_out.true_law import draft_behind, true_torque
from bench.sim2real.machines.spec import WorldSpec
from pdoik.sim2real import load_study
from pdoik.sim2real.motion.prepare import prepare


def rows_of(world: str, study: Path, truth: dict[str, Any], said: dict[str, Any]) -> list[Any]:
    """For each joint: whether it has the fault, left as the model is, by the diagnosis, truly."""
    spec = WorldSpec(
        seed=truth["spec"]["seed"],
        faults=tuple(truth["spec"]["faults"]),
        robot=truth["spec"]["robot"],
    )
    draft = draft_behind(spec, [each["parameters"] for each in truth["faults"]])
    prepared = prepare(load_study(study))
    balances = prepared.validate
    assert balances is not None
    true = [true_torque(draft, m.q, m.dq, m.ddq, m.period) for m in balances.motions]
    faulty = {name for fault in truth["faults"] for name in fault["joints"]}
    rows = []
    for j, name in enumerate(prepared.study.joints):
        fit = said["joints"].get(name)
        keep = balances.mask["torque", j]
        if fit is None or not keep.sum() or fit["unit"] != "N m":
            continue
        logged = np.concatenate(
            [balances.thin(i, _torque(m, j)) for i, m in enumerate(balances.motions)]
        )
        law = np.concatenate([balances.thin(i, each[:, j]) for i, each in enumerate(true)])
        left = float(np.sqrt(np.mean((logged - law)[keep] ** 2)))
        rows.append([world, name, name in faulty, fit["before"], fit["after"], left])
    return rows


def _torque(motion: Any, j: int) -> Array:
    assert motion.torque is not None
    return np.ascontiguousarray(motion.torque[:, j])
