"""Build a study folder from a spec: draw the machine, hide something, let it move, write files."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.sim2real.concealed.catalogue import EFFECTS
from bench.sim2real.concealed.draft import OF_THE_BODY, Draft, draft_of
from bench.sim2real.concealed.effect import Effect, Gate, Scene, multiple
from bench.sim2real.concealed.effects_outside import outside, slosh
from bench.sim2real.concealed.effects_sensor import lie
from bench.sim2real.concealed.logger import Take, visibility
from bench.sim2real.concealed.spec import Truth, WorldSpec
from bench.sim2real.concealed.truths import size_of, truth_of
from bench.sim2real.concealed.world import Run, World
from bench.sim2real.frame.arm import Array, urdf
from bench.sim2real.frame.robots import robot
from bench.sim2real.frame.study_files import joint_names, write_study, write_truth

LARGER = ("coulomb_friction", "viscous_friction", "payload", "torque_offset", "gravity_direction")

Made = tuple[World, list[Take]]


def make_study(
    folder: Path, spec: WorldSpec, truth_folder: Path | None = None, *, clean: bool = False
) -> Truth:
    """Writes robot.urdf, study.yaml and recordings; the truth only where asked for.

    With `clean` the truth's folder also gets what the channels were before noise, row by row
    (FOLDER.npz: recN_time, recN_q, recN_dq, recN_tau).
    """
    draft = draft_of(spec)
    world, takes, found = _visible(draft)
    noiseless, order = _written(folder, draft, takes)
    truth = truth_of(draft, world.effects, order, visibility(world, takes), found)
    if truth_folder is not None:
        write_truth(truth_folder, folder, truth.to_json())
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
    """Writes robot.urdf, study.yaml and recordings of a draft's machine with just these effects."""
    world, takes = _simulated(draft, effects, calibrate=False)
    if world.effects != effects:
        raise RuntimeError(f"the machine does not bear {effects[0]}")
    _written(folder, draft, takes)


def world_of(draft: Draft, effects: tuple[Effect, ...]) -> World:
    """A draft's machine with something in it that its URDF does not know."""
    return World(draft.arm, draft.armature, draft.control, draft.sensors, effects, draft.believed)


def _written(folder: Path, draft: Draft, takes: list[Take]) -> tuple[dict[str, Array], Array]:
    """The study's files; what the channels were before noise, and the order of its joints."""
    spec, noiseless = draft.spec, {}
    folder.mkdir(parents=True, exist_ok=True)
    for index, take in enumerate(takes):
        path, shuffle = folder / f"rec{index + 1}.csv", spec.stream(f"columns{index}")
        true = take.write(path, logged(draft), shuffle, tip=draft.sensors.tip)
        noiseless |= {f"{path.stem}_{name}": values for name, values in true.items()}
    order = spec.stream("order").permutation(draft.arm.n)
    write_study(folder, urdf(draft.believed), study_of(draft, order))
    return noiseless, order


def _visible(draft: Draft) -> tuple[World, list[Take], float]:
    """The simulated machine and the hidden effect's size; drawn again where it cannot be seen."""
    for attempt in range(4):
        effects = drawn(draft, attempt)
        found = None  # a size that only simulation tells, of the hidden effect alone
        if effects and effects[0].calibrated and (len(effects) > 1 or draft.plan.model_error):
            alone = replace(draft, believed=draft.arm)
            trial = _simulated(alone, effects[:1], calibrate=True)
            effects, found = (*trial[0].effects, *effects[1:]), size_of(visibility(*trial))
        world, takes = _simulated(draft, effects, calibrate=found is None)
        effects = world.effects
        if found is None:
            found = size_of(visibility(world, takes))
            if effects and not effects[0].calibrated:
                found = multiple(effects[0], draft.ref, draft.sensors) or found
        if found > 1.9 or draft.spec.effect not in EFFECTS or draft.plan.style.still:
            break
    return world, takes, found


def drawn(draft: Draft, attempt: int = 0) -> tuple[Effect, ...]:
    """What is hidden first, then what stands before it."""
    spec, todo, rng = draft.spec, draft.plan, draft.spec.stream(f"effect{attempt}")
    scene = Scene(
        ref=draft.ref,
        control=draft.control,
        sensors=draft.sensors,
        rng=rng,
        places=(*todo.places[attempt:], *todo.places[:attempt]),
        gate=todo.gate,
        size=todo.size,
        torque_logged=todo.torque_logged,
        corner=todo.corner,
    )
    if todo.model_error and spec.effect in OF_THE_BODY and spec.size is None:
        floor = np.max(0.03 * np.std(draft.ref.tau, axis=0) / draft.sensors.tau_noise)
        scene = replace(scene, size=todo.size * max(1.0, 0.5 * float(floor)))
    group, _, kind = spec.effect.partition(":")
    if group == "clean" or (group == "still" and rng.random() < 0.5):
        return ()
    if group == "still":
        return (EFFECTS["coulomb_friction"](scene),)
    if spec.effect == "outside:slosh":
        return (slosh(robot(spec.robot, spec.stream("robot")), spec.stream("slosh")),)
    if group == "outside":
        return (outside(scene, kind),)
    if spec.effect == "lying:tau_model":
        places = [replace(scene, size=8.0, places=(j,)) for j in range(draft.arm.n)]
        friction = [EFFECTS["coulomb_friction"](each) for each in places]
        return (lie(scene, kind), *friction)
    if group == "lying":
        return (lie(scene, kind),)
    if spec.effect not in EFFECTS:
        raise ValueError(f"effect is {spec.effect!r}, expected one of {', '.join(EFFECTS)}")
    hidden = EFFECTS[spec.effect](scene)
    return (hidden, _second(scene, hidden)) if spec.hide == "second" else (hidden,)


def _second(scene: Scene, hidden: Effect) -> Effect:
    """Something three to five times as large elsewhere."""
    names = [name for name in LARGER if name != hidden.id]
    if hidden.id == "link_inertial_error":
        names.remove("payload")
    taken = set(hidden.joints(scene.ref))
    elsewhere = tuple(j for j in scene.places if j not in taken) or scene.places
    size = scene.rng.uniform(3.0, 5.0) * max(scene.size, 4.0)
    other = replace(scene, size=float(size), places=elsewhere, gate=Gate(), corner="")
    return EFFECTS[str(scene.rng.choice(names))](other)


def _simulated(draft: Draft, effects: tuple[Effect, ...], *, calibrate: bool) -> Made:
    """All recordings; an effect that the arm cannot bear is made smaller and tried again."""
    for attempt in range(8):
        world = world_of(draft, effects)
        streams = [draft.spec.stream(f"run{index}") for index in range(len(draft.motions))]
        try:
            takes = [
                Take.of(Run(world, motion, index, streams[index]))
                for index, motion in enumerate(draft.motions)
            ]
        except RuntimeError:
            if not effects:
                raise
            effects = (_times(effects[0], 0.6, draft), *effects[1:])
            continue
        sized = not effects or not effects[0].calibrated or draft.plan.style.still
        if not calibrate or sized or attempt >= 4:
            return world, takes
        ratio = draft.plan.size / max(size_of(visibility(world, takes)), 1e-3)
        scaled = _times(effects[0], float(np.clip(ratio, 0.2, 3.0)), draft)
        if 0.6 < ratio < 1.6 or scaled == effects[0]:
            return world, takes
        effects = (scaled, *effects[1:])
    raise RuntimeError(f"no arm came through: {draft.spec}")


def _times(effect: Effect, factor: float, draft: Draft) -> Effect:
    low, high = effect.limits(draft.ref)
    value = float(np.clip(factor * getattr(effect, effect.amplitude), low, high))
    return effect.scaled(float(f"{value:.5g}"))


def logged(draft: Draft) -> list[str]:
    """Names of the channels that are written."""
    sense, torque = draft.sensors, draft.plan.torque_logged
    known = {
        "q": True,
        "q_des": True,
        "tau": torque,
        "dq": sense.dq,
        "dq_des": draft.control.knows_speed,
        "tau_cmd": sense.tau_cmd and torque,
    }
    return [name for name, there in known.items() if there]


def study_of(draft: Draft, order: Array) -> dict[str, Any]:
    """What study.yaml says, with the joints in an order of indices (n,)."""
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
            "kp": control.kp[order].tolist(),
            "kd": control.kd[order].tolist(),
            "gravity_compensation": control.gravity_compensation,
            "period": control.period,
        },
        "rotor_inertia": draft.armature[order].tolist(),
    }
    if draft.believed is not draft.arm:
        study["trust"] = {"rigid_body": 0.1}
    return study
