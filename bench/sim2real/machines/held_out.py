"""Held-out residuals of a run's diagnoses over the true law's.

    python -m bench.sim2real.machines.held_out --worlds build/bench/machines [--tool DIGEST]

Of joints that carry no fault and of those that do, on the recordings that only judge, in the band
of the diagnosis; worlds whose fault no law of torques has (contacts, logs with glitches, loose or
limited drives) are left out. The true law has the true bodies, rotors, gears' losses and bearings,
with the friction of a mean day: what it leaves is the day, the structure, the twist of gears and
the sensors. Nobody who knows the machine would leave less.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import typer
from numba import njit

from bench.common.commands import console, plain_errors, show
from bench.sim2real.machines.build import Draft, draft_of
from bench.sim2real.machines.chain import chain_of
from bench.sim2real.machines.figures import INDEX, Array
from bench.sim2real.machines.physics import friction
from bench.sim2real.machines.plan import WorldSpec
from bench.sim2real.machines.simulate import torque_of
from bench.sim2real.machines.worlds import Tool, World, Worlds, joint_table, worlds_of
from pdoik.sim2real import load_study
from pdoik.sim2real.motion import prepare

_LAWFUL = {
    *("coulomb_friction", "viscous_friction", "stribeck_friction", "asymmetric_friction"),
    *("load_dependent_friction", "gear_efficiency", "presliding_hysteresis", "joint_coupling"),
    *("torque_gain", "torque_ripple", "joint_offset", "position_dependent_spring"),
    *("link_inertial_error", "payload", "gravity_direction"),
}
"""Kinds that the true law has, and that act throughout."""


def rows_of(world: World) -> list[dict[str, Any]]:
    """For each joint: whether it has the fault, left as the model is, by the diagnosis, truly."""
    assert world.said is not None
    draft = draft_behind(world.truth)
    prepared = prepare(load_study(world.study))
    balances = prepared.validate
    assert balances is not None
    true = [true_torque(draft, m.q, m.dq, m.ddq, m.period) for m in balances.motions]
    rows = []
    for j, name in enumerate(prepared.study.joints):
        fit = world.said["joints"].get(name)
        keep = balances.mask["torque", j]
        if fit is None or not keep.sum() or fit["unit"] != "N m":
            continue
        left = [
            balances.thin(i, np.ascontiguousarray(motion.torque[:, j]))
            - balances.thin(i, law[:, j])
            for i, (motion, law) in enumerate(zip(balances.motions, true, strict=True))
        ]
        truly = float(np.sqrt(np.mean(np.concatenate(left)[keep] ** 2)))
        row = {"world": world.name, "joint": name, "faulty": name in world.faulty}
        rows.append(row | {"before": fit["before"], "after": fit["after"], "true": truly})
    return rows


def main(worlds: Worlds, tool: Tool = "") -> None:
    """Work out, print."""
    with plain_errors():
        rows = []
        for world in worlds_of(worlds, tool):
            begun = any(fault["begins"] for fault in world.truth["faults"])
            lawful = {fault["kind"] for fault in world.truth["faults"]} <= _LAWFUL
            if lawful and not begun and world.said is not None:
                rows += rows_of(world)
                console.print(world.name)
        joints = pd.DataFrame(rows)
        joints["first"], joints["over"] = joints.before / joints.true, joints.after / joints.true
        columns = {
            "as the model is, median": lambda part: f"{part['first'].median():.2f}",
            "by the diagnosis, median": lambda part: f"{part.over.median():.2f}",
            "nine of ten below": lambda part: f"{part.over.quantile(0.9):.2f}",
            "at most 1.15 times": lambda part: f"{(part.over <= 1.15).mean():.2f}",
        }
        show(joint_table(joints, columns))


_BRISTLE, _COULOMB, _ROTOR = (INDEX[name] for name in ("bristle", "coulomb", "rotor"))
_CREEP = 0.02  # speed below which directions are not sharp [rad/s]
_WARMER = 4.0  # than 25 deg C, on a mean day [K]
_ATTEMPTS = ((0, 1.0), (1, 1.8), (2, 3.2))  # as build.py tries severities


def draft_behind(truth: Mapping[str, Any]) -> Draft:
    """The draft of a world, whose faults have the truth's parameters."""
    spec, faults = WorldSpec(**truth["spec"]), [each["parameters"] for each in truth["faults"]]
    for attempt, severity in _ATTEMPTS:
        draft = draft_of(spec, attempt, severity)
        if [fault.parameters for fault in draft.faults] == faults:
            return draft
    raise ValueError(
        f"seed {spec.seed}: no draft has the truth's faults; was the generator changed?"
    )


def true_torque(draft: Draft, q: Array, dq: Array, ddq: Array, period: float) -> Array:
    """As the log has it, for (T, n) of the joints' motion, faults at work throughout, (T, n)."""
    made, arm = draft.machine, draft.machine.arm
    figures = made.figures
    for fault in draft.faults:
        arm = arm if fault.arm is None else fault.arm(arm)
        figures = figures if fault.figures is None else fault.figures(figures)
    chain, gravity = chain_of(arm), figures.whole[:3]
    q = q - figures.of("offset")
    link = np.array([torque_of(chain, *row, gravity) for row in zip(q, dq, ddq, strict=True)])
    above = q - figures.of("spring_onset")
    side = figures.of("spring_side")
    link += np.where((side == 0.0) | (above * side > 0.0), figures.of("spring") * above, 0.0)
    link += figures.of("drag") * dq * np.abs(dq)
    link[:, :-1] += figures.of("coupled")[1:] * link[:, 1:]
    loss = np.where(link * dq > 0.0, figures.of("loss_driving"), figures.of("loss_driven"))
    motor = link + np.abs(link) * loss * np.tanh(dq / _CREEP) + figures.of("rotor") * ddq
    cogging = figures.of("cogging_cycles") * q + figures.of("cogging_phase")
    motor -= figures.of("cogging") * np.sin(cogging)
    for j in range(arm.n):
        motor[:, j] += _rubbed(figures.joints[j], q[:, j], dq[:, j], link[:, j], period)
    sensors = made.sensors
    return np.asarray(
        motor / figures.of("gain") * (1.0 + sensors.current_gain) + sensors.current_offset
    )


@njit(cache=True)
def _rubbed(f, q, dq, load, period):
    """Friction along a path, bristles bent by it, (T,)."""
    result, bristle = np.empty(len(q)), 0.0
    reach = f[_BRISTLE]
    for k in range(len(q)):
        goal = np.sign(dq[k])
        bristle = goal + (bristle - goal) * np.exp(-abs(dq[k]) * period / reach)
        level, _ = friction(f, dq[k], bristle, load[k], q[k], _WARMER, 0.0)
        rate = (dq[k] - abs(dq[k]) * bristle) / reach
        inner = 0.5 * np.sqrt(max(f[_COULOMB], 0.0) * f[_ROTOR] * reach)
        result[k] = level - inner * np.exp(-((dq[k] / 0.05) ** 2)) * rate
    return result


if __name__ == "__main__":
    typer.run(main)
