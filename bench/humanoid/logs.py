"""The logs of an H1 that dodges, diagnosed: something is concealed in the robot.

python -m bench.humanoid.logs --out build/bench/h1_logs

The robot stands free on its soles and dodges what is thrown at it, as `python -m bench.humanoid
--mode predict --setup balanced` has it; its logs are that command's own. The study's robot is
the H1 as it is believed to be, with the joints' damping and rotors; nothing is known but its logs:
joints, torques and the pelvis' pose. Worlds that are there are not made again, nor diagnosed.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, NamedTuple
from xml.etree import ElementTree

import mujoco
import numpy as np
import pandas as pd
import pinocchio as pin
import typer
import yaml

from bench.common.commands import show, write_report
from bench.common.markdown import markdown_table
from bench.common.whole_files import write_text
from bench.humanoid.dodge.plan import Plan, Planner
from bench.humanoid.dodge.search import DodgeSearch
from bench.humanoid.trials.draw_throws import draw_throws
from bench.humanoid.trials.predict import follow_plan
from bench.humanoid.world.log import write_log
from bench.humanoid.world.model import ARMATURE, DAMPING, build_world
from bench.humanoid.world.objects import OBJECT_NAMES, load_object
from bench.humanoid.world.robot import BALANCED, URDF
from bench.humanoid.world.throws import Throw
from pdoik.sim2real import CATALOGUE, diagnose
from pdoik.view.h1_shapes import FEET, JOINT_NAMES, SOLE_HEIGHT

RUNS = 4  # the last is held out
AFTER = 3.0  # how long a run goes on behind the dodge [s]
GUESSES = 200  # for a plan: not seconds, so that every machine finds the same
THROWS = 16
SPARE = 3  # plans, for a machine that is not sound is hit or falls now and then
SHORTEST = 2.5  # [s]
CLAIMED = 0.75


class Cause(NamedTuple):
    """What is concealed, and how it should be said."""

    change: Callable[[mujoco.MjModel], None] = lambda model: None
    effect: str = ""
    place: str = ""
    figure: str = ""  # the parameter that is compared
    value: float = 0.0


def rubbing(joint: str, level: float) -> Cause:
    """Dry friction [N m]."""

    def change(model: mujoco.MjModel) -> None:
        model.dof_frictionloss[model.joint(joint).dofadr[0]] = level

    return Cause(change, "coulomb_friction", joint, "level", level)


def damped(joint: str, more: float) -> Cause:
    """Viscous friction beyond what is believed [N m s/rad]."""

    def change(model: mujoco.MjModel) -> None:
        model.dof_damping[model.joint(joint).dofadr[0]] += more

    return Cause(change, "viscous_friction", joint, "coefficient", more)


def loaded(body: str, mass: float, at: tuple[float, float, float]) -> Cause:
    """A point of mass [kg] at a place in the body's frame [m]."""

    def change(model: mujoco.MjModel) -> None:
        i, turn = model.body(body).id, np.zeros(9)
        mujoco.mju_quat2Mat(turn, model.body_iquat[i])
        R = turn.reshape(3, 3)
        own = R @ np.diag(model.body_inertia[i]) @ R.T
        both = pin.Inertia(float(model.body_mass[i]), model.body_ipos[i].copy(), own)
        both += pin.Inertia(mass, np.array(at), np.zeros((3, 3)))
        values, axes = np.linalg.eigh(both.inertia)
        axes[:, 2] *= np.linalg.det(axes)
        mujoco.mju_mat2Quat(model.body_iquat[i], axes.ravel())
        model.body_mass[i], model.body_ipos[i] = both.mass, both.lever
        model.body_inertia[i] = values
        mujoco.mj_setConst(model, mujoco.MjData(model))

    return Cause(change, "payload", body, "mass", mass)


def weak(joint: str, share: float) -> Cause:
    """A motor that gives less than is asked and logged."""

    def change(model: mujoco.MjModel) -> None:
        (motor,) = np.flatnonzero(model.actuator_trnid[:, 0] == model.joint(joint).id)
        model.actuator_gear[motor, 0] *= share

    return Cause(change, "torque_gain", joint, "gain", 1.0 / share)


CAUSES: dict[str, Cause] = {
    "nothing": Cause(),
    "a load of 3 kg on the torso": loaded("torso_link", 3.0, (0.0, 0.1, 0.3)),
    "a forearm that is 0.8 kg heavier": loaded("left_elbow_link", 0.8, (0.2, 0.0, 0.0)),
    "dry friction of 6 N m in a knee": rubbing("right_knee_joint", 6.0),
    "viscous friction of 8 N m s/rad in a hip": damped("left_hip_roll_joint", 8.0),
    "a knee's motor that gives 0.85 of what is logged": weak("left_knee_joint", 0.85),
}


def dodges(ycb: Path | None) -> list[tuple[Throw, Plan]]:
    """Throws and plans that a sound robot dodges."""
    things = {name: load_object(name, ycb) for name in OBJECT_NAMES}
    hits, _ = draw_throws(things, BALANCED, THROWS, 0)
    planner, found = Planner(BALANCED), []
    for k, hit in enumerate(hits):
        thing = things[hit.throw.object_name]
        search = DodgeSearch(BALANCED, thing, hit.throw, k)
        for _ in range(GUESSES):
            search.attempt()
        plans = planner.plans(search, hit.throw, thing, hit.contact.time)
        if plans:
            trial = follow_plan(build_world(BALANCED, thing), plans[0], hit.throw, AFTER)
            if trial.run.dodged:
                found.append((hit.throw, plans[0]))
        if len(found) == RUNS + SPARE:
            break
    return found


def recorded(folder: Path, cause: Cause, plans: list[tuple[Throw, Plan]], ycb: Path | None) -> None:
    """The logs of the first runs that last, of the set-up with what is concealed.

    Raises:
        RuntimeError: too few do.
    """
    kept = 0
    for throw, plan in plans:
        world = build_world(BALANCED, load_object(throw.object_name, ycb))
        cause.change(world.model)
        trial = follow_plan(world, plan, throw, AFTER)
        if trial.run.time[-1] > SHORTEST:
            write_log(trial.run, folder / f"dodge{kept}.csv")
            kept += 1
        if kept == RUNS:
            return
    raise RuntimeError(f"{kept} of {len(plans)} runs last, expected {RUNS}")


def write_study(folder: Path) -> None:
    """What a user would write; the description has the damping of the world."""
    tree = ElementTree.parse(URDF)
    for joint in tree.getroot().findall("joint"):
        if joint.attrib["name"] in JOINT_NAMES:
            ElementTree.SubElement(joint, "dynamics", damping=f"{DAMPING:g}", friction="0")
    write_text(folder / "robot.urdf", ElementTree.tostring(tree.getroot(), encoding="unicode"))
    roles = ["fit"] * (RUNS - 1) + ["validate"]
    study = {
        "robot": "robot.urdf",
        "joints": list(JOINT_NAMES),
        "recordings": [{"file": f"dodge{k}.csv", "role": role} for k, role in enumerate(roles)],
        "rotor_inertia": [ARMATURE] * len(JOINT_NAMES),
        "base": {
            "feet": {foot: {"sole": SOLE_HEIGHT} for foot in FEET},
            "ground": {"height": BALANCED.floor_z},
        },
    }
    write_text(folder / "study.yaml", yaml.safe_dump(study, sort_keys=False, width=100))


def row_of(name: str, cause: Cause, said: dict[str, Any], seconds: float) -> dict[str, str]:
    """What is hidden and what was said of it; what a link carries is an error of the link."""
    right, besides, figure = False, [], ""
    for finding in said["findings"]:
        at, effect = (*finding["joints"], *finding["links"]), finding["effect"]
        if finding["confidence"] < CLAIMED:
            continue
        same = effect == cause.effect or (
            cause.effect and CATALOGUE[effect].is_body and CATALOGUE[cause.effect].is_body
        )
        if cause.place not in at or not same:
            besides.append(f"{effect} {' '.join(at)}")
            continue
        right = True
        given = finding["parameters"]
        if not figure and (one := given.get(cause.figure, given.get(f"d_{cause.figure}"))):
            low, high = one["interval95"][:2]
            figure = f"{one['value']:.3g} [{low:.3g}, {high:.3g}]; truly {cause.value:.3g}"
    return {
        "concealed": name,
        "named at its place": "-" if not cause.effect else "yes" if right else "no",
        "figure": figure,
        "said besides": "; ".join(besides),
        "recorded [s]": f"{seconds:.0f}",
    }


def main(
    out: Annotated[Path, typer.Option(help="Folder of worlds and answers.")],
    ycb: Annotated[Path | None, typer.Option(help="YCB objects; primitives otherwise.")] = None,
    only: Annotated[str, typer.Option(help="Causes that contain this.")] = "",
) -> None:
    """Conceal, dodge, diagnose."""
    out.mkdir(parents=True, exist_ok=True)
    plans: list[tuple[Throw, Plan]] = []
    rows = []
    for name, cause in CAUSES.items():
        if only not in name:
            continue
        folder = out / "".join(c if c.isalnum() else "_" for c in name)
        answer = folder / "said.json"
        if not answer.is_file():
            plans = plans or dodges(ycb)
            folder.mkdir(exist_ok=True)
            write_study(folder)
            recorded(folder, cause, plans, ycb)
            write_text(answer, diagnose(folder / "study.yaml").to_json())
        seconds = sum(
            float(pd.read_csv(folder / f"dodge{k}.csv", usecols=["time"]).time.iloc[-1])
            for k in range(RUNS)
        )
        rows.append(row_of(name, cause, json.loads(answer.read_text()), seconds))
        print(rows[-1], flush=True)
    text = markdown_table(tuple(rows[0]), [tuple(row.values()) for row in rows])
    show(text)
    write_report(out / "h1_logs.md", text)


if __name__ == "__main__":
    typer.run(main)
