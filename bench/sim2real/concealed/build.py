"""From a spec to a study folder: draw the machine, hide something, let it move, write files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.concealed import draw_decoys, logger
from bench.sim2real.concealed.arm import Array
from bench.sim2real.concealed.catalogue import EFFECTS
from bench.sim2real.concealed.draft import Draft, draft_of
from bench.sim2real.concealed.effect import Effect, Gate
from bench.sim2real.concealed.hide import OF_THE_BODY
from bench.sim2real.concealed.measure import visibility
from bench.sim2real.concealed.robots import robot
from bench.sim2real.concealed.scene import Scene
from bench.sim2real.concealed.sizing import multiple
from bench.sim2real.concealed.spec import Truth, WorldSpec
from bench.sim2real.concealed.study_files import (
    joint_names,
    write_recording,
    write_study,
    write_truth,
)
from bench.sim2real.concealed.truths import size_of, truth_of
from bench.sim2real.concealed.world import Run, World
from bench.sim2real.concealed.world import Truth as Rows

LARGER = ("coulomb_friction", "viscous_friction", "payload", "torque_offset", "gravity_direction")


def make_study(
    folder: Path, spec: WorldSpec, truth_folder: Path | None = None, *, clean: bool = False
) -> Truth:
    """Writes robot.urdf, study.yaml and recordings; the truth only where asked for.

    With `clean` the truth's folder also gets what the channels were before noise, row by row
    (FOLDER.npz: recN_time, recN_q, recN_dq, recN_tau).
    """
    draft = draft_of(spec)
    world, runs, rows, channels, found = _visible(draft)
    effects = world.effects
    noiseless, order = _written(folder, draft, runs, rows, channels)
    truth = truth_of(draft, effects, order, _seen(draft, world, runs, rows, channels), found)
    if truth_folder is not None:
        write_truth(truth_folder / f"{folder.name}.json", truth.to_json())
        if clean:
            np.savez_compressed(truth_folder / f"{folder.name}.npz", **noiseless)
    return truth


def hidden_in(draft: Draft) -> tuple[Effect, ...]:
    """What `make_study` hides in a draft's machine, at the size that its motions show.

    Machines are only simulated where nothing else tells the size.
    """
    effects = drawn(draft)
    return _visible(draft)[0].effects if any(each.calibrated for each in effects) else effects


def write_machine(folder: Path, draft: Draft, effects: tuple[Effect, ...]) -> None:
    """Writes robot.urdf, study.yaml and recordings of a draft's machine with just these effects.

    Raises:
        RuntimeError: it does not bear them.
    """
    world, *made = _simulated(draft, effects, calibrate=False)
    if world.effects != effects:
        raise RuntimeError(f"the machine does not bear {effects[0]}")
    _written(folder, draft, *made)


def _written(
    folder: Path,
    draft: Draft,
    runs: list[Run],
    rows: list[Rows],
    channels: list[dict[str, Array]],
) -> tuple[dict[str, Array], Array]:
    """The study's files; what the channels were before noise, and the order of its joints."""
    spec, noiseless = draft.spec, {}
    folder.mkdir(parents=True, exist_ok=True)
    logged = _logged(draft)
    for index, (run, row, channel) in enumerate(zip(runs, rows, channels, strict=True)):
        kept = logger.rows_of(channel, run)
        data = logger.measured(channel, run, kept)
        tip = logger.tip_poses(row, run, kept) if draft.sensors.tip else None
        shuffle = spec.stream(f"columns{index}")
        write_recording(folder / f"rec{index + 1}.csv", data, logged, tip, shuffle)
        true = {"time": row.time, "q": row.q, "dq": row.dq, "tau": channel["tau"]}
        noiseless |= {f"rec{index + 1}_{name}": values[kept] for name, values in true.items()}
    order = spec.stream("order").permutation(draft.arm.n)
    write_study(folder, draft.believed, _study(draft, order))
    return noiseless, order


def _visible(draft: Draft) -> tuple[World, list[Run], list[Rows], list[dict[str, Array]], float]:
    """The simulated machine and the hidden effect's size; drawn again where it cannot be seen."""
    for attempt in range(4):
        effects = drawn(draft, attempt)
        found = None  # a size that only simulation tells, of the hidden effect alone
        if effects and effects[0].calibrated and (len(effects) > 1 or draft.plan.model_error):
            alone = replace(draft, believed=draft.arm)
            trial = _simulated(alone, effects[:1], calibrate=True)
            effects, found = (*trial[0].effects, *effects[1:]), size_of(_seen(alone, *trial))
        result = _simulated(draft, effects, calibrate=found is None)
        effects = result[0].effects
        if found is None:
            found = size_of(_seen(draft, *result))
            if effects and not effects[0].calibrated:
                found = multiple(effects[0], draft.ref, draft.sensors) or found
        if found > 1.9 or draft.spec.effect not in EFFECTS or draft.plan.style.still:
            break
    return *result, found


def drawn(draft: Draft, attempt: int = 0) -> tuple[Effect, ...]:
    """What is hidden first, then what stands before it."""
    spec, todo, rng = draft.spec, draft.plan, draft.spec.stream(f"effect{attempt}")
    places = (*todo.places[attempt:], *todo.places[:attempt])
    scene = Scene(
        ref=draft.ref,
        control=draft.control,
        sensors=draft.sensors,
        rng=rng,
        places=places,
        gate=todo.gate,
        size=todo.size,
        torque_logged=todo.torque_logged,
        corner=todo.corner,
    )
    if todo.model_error and spec.effect in OF_THE_BODY and spec.size is None:
        floor = np.max(0.03 * np.std(draft.ref.tau, axis=0) / draft.sensors.tau_noise)
        scene = replace(scene, size=todo.size * max(1.0, 0.5 * float(floor)))
    kind = spec.effect.partition(":")[2]
    if spec.effect == "clean":
        return ()
    if spec.effect == "still":
        return () if rng.random() < 0.5 else (EFFECTS["coulomb_friction"](scene),)
    if spec.effect == "outside:slosh":
        return (draw_decoys.slosh(robot(spec.robot, spec.stream("robot")), spec.stream("slosh")),)
    if spec.effect.startswith("outside:"):
        return (draw_decoys.outside(scene, kind),)
    if spec.effect == "lying:tau_model":
        size = replace(scene, size=8.0)
        friction = [
            EFFECTS["coulomb_friction"](replace(size, places=(j,))) for j in range(draft.arm.n)
        ]
        return (draw_decoys.lie(scene, kind), *friction)
    if spec.effect.startswith("lying:"):
        return (draw_decoys.lie(scene, kind),)
    if spec.effect not in EFFECTS:
        raise ValueError(f"effect is {spec.effect!r}, expected one of {', '.join(EFFECTS)}")
    hidden = EFFECTS[spec.effect](scene)
    return (hidden, *_second(scene, hidden)) if spec.hide == "second" else (hidden,)


def _second(scene: Scene, hidden: Effect) -> tuple[Effect, ...]:
    """Something three to five times as large elsewhere."""
    rng = scene.rng
    names = [name for name in LARGER if name != hidden.id]
    if hidden.id == "link_inertial_error":
        names.remove("payload")
    taken = set(hidden.joints(scene.ref))
    elsewhere = tuple(j for j in scene.places if j not in taken) or scene.places
    size = rng.uniform(3.0, 5.0) * max(scene.size, 4.0)
    other = replace(scene, size=float(size), places=elsewhere, gate=Gate(), corner="")
    return (EFFECTS[str(rng.choice(names))](other),)


def _simulated(
    draft: Draft, effects: tuple[Effect, ...], *, calibrate: bool
) -> tuple[World, list[Run], list[Rows], list[dict[str, Array]]]:
    """All recordings; an effect that the arm cannot bear is made smaller and tried again."""
    wanted = draft.plan.size
    for attempt in range(8):
        world = World(
            draft.arm, draft.armature, draft.control, draft.sensors, effects, draft.believed
        )
        runs, rows, channels = [], [], []
        try:
            for index, motion in enumerate(draft.motions):
                run = Run(world, motion, index, draft.spec.stream(f"run{index}"))
                runs.append(run)
                rows.append(run.simulate())
                channels.append(logger.channels_of(rows[-1], run))
        except RuntimeError:
            if not effects:
                raise
            effects = (_times(effects[0], 0.6, draft), *effects[1:])
            continue
        if (
            not calibrate
            or not effects
            or not effects[0].calibrated
            or attempt >= 4
            or draft.plan.style.still
        ):
            break
        ratio = wanted / max(size_of(_seen(draft, world, runs, rows, channels)), 1e-3)
        scaled = _times(effects[0], float(np.clip(ratio, 0.2, 3.0)), draft)
        if 0.6 < ratio < 1.6 or scaled == effects[0]:
            break
        effects = (scaled, *effects[1:])
    else:
        raise RuntimeError(f"no arm came through: {draft.spec}")
    return world, runs, rows, channels


def _times(effect: Effect, factor: float, draft: Draft) -> Effect:
    low, high = effect.limits(draft.ref)
    value = float(np.clip(factor * getattr(effect, effect.amplitude), low, high))
    return effect.scaled(float(f"{value:.5g}"))


def _seen(
    draft: Draft,
    world: World,
    runs: list[Run],
    rows: list[Rows],
    channels: list[dict[str, Array]],
) -> dict[str, list[float]]:
    return visibility(world.believed, runs, rows, channels, draft.control, draft.sensors)


def _logged(draft: Draft) -> list[str]:
    sense, todo = draft.sensors, draft.plan
    logged = ["q", "q_des"]
    logged += ["tau"] if todo.torque_logged else []
    logged += ["dq"] if sense.dq else []
    logged += ["dq_des"] if draft.control.knows_speed else []
    logged += ["tau_cmd"] if sense.tau_cmd and todo.torque_logged else []
    return logged


def _study(draft: Draft, order: Array) -> dict[str, Any]:
    names, control = joint_names(draft.arm), draft.control
    study: dict[str, Any] = {
        "robot": "robot.urdf",
        "tip": "tool",
        "joints": [names[k] for k in order],
        "recordings": [
            {"file": f"rec{index + 1}.csv", "role": role} for index, role in enumerate(draft.roles)
        ],
        "controller": {
            "type": "pd",
            "kp": [float(control.kp[k]) for k in order],
            "kd": [float(control.kd[k]) for k in order],
            "gravity_compensation": control.gravity_compensation,
            "period": control.period,
        },
        "rotor_inertia": [float(draft.armature[k]) for k in order],
    }
    if draft.plan.model_error:
        study["trust"] = {"rigid_body": 0.1}
    return study
