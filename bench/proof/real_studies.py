"""Studies of real machines' recordings, and what their models leave out."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

import pdoik

ROBOTS = Path(pdoik.__file__).parent / "robots"


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine whose recordings may be there."""

    name: str  # of the recordings' folder
    title: str
    withheld: str  # the physics that its model does not have
    doubtful: str  # what keeps these recordings from proving more
    build: Callable[[Path, Path], dict[str, Any]]  # writes what it needs, gives the study


def write_study(machine: Machine, recordings: Path, folder: Path) -> None:
    """A study folder with copies of the recordings."""
    folder.mkdir(parents=True)
    study = machine.build(recordings / machine.name, folder)
    (folder / "study.yaml").write_text(yaml.safe_dump(study, sort_keys=False))


def _copied(source: Path, folder: Path, names: tuple[str, ...], role: str) -> list[dict[str, str]]:
    for name in names:
        shutil.copyfile(source / f"{name}.csv", folder / f"{name}.csv")
    return [{"file": f"{name}.csv", **({"role": role} if role else {})} for name in names]


def _ur10(source: Path, folder: Path) -> dict[str, Any]:
    shutil.copyfile(ROBOTS / "ur10.urdf", folder / "robot.urdf")
    names = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
    return {
        "robot": "robot.urdf",
        "joints": [f"{name}_joint" for name in names],
        "recordings": _copied(source, folder, ("run1",), ""),
    }


def _panda(source: Path, folder: Path) -> dict[str, Any]:
    shutil.copyfile(ROBOTS / "panda.urdf", folder / "robot.urdf")
    runs = _copied(source, folder, ("run1",), "")
    text = (folder / "run1.csv").read_text()
    (folder / "run1.csv").write_text(text.replace("fer_joint", "panda_joint"))  # the URDF's names
    joints = [f"panda_joint{k}" for k in range(1, 8)]
    return {"robot": "robot.urdf", "joints": joints, "recordings": runs}


_LINK = (
    '<inertial><origin xyz="0 0 {z}"/><mass value="{mass}"/>'
    '<inertia ixx="1e-4" iyy="{about}" izz="{about}" ixy="0" ixz="0" iyz="0"/></inertial>'
)
_PENDULUM = """<robot name="pendulum"><link name="base"/>
  <link name="upper">{upper}</link><link name="lower">{lower}</link>
  <joint name="joint1" type="continuous"><parent link="base"/><child link="upper"/>
    <axis xyz="0 -1 0"/></joint>
  <joint name="joint2" type="continuous"><parent link="upper"/><child link="lower"/>
    <origin xyz="0 0 {length}"/><axis xyz="0 -1 0"/></joint></robot>
"""


def _pendulum(source: Path, folder: Path) -> dict[str, Any]:
    facts = yaml.safe_load((source / "model_parameters.yml").read_text())
    links = []
    for k in ("1", "2"):  # its inertias are about the joints
        mass, reach = facts[f"m{k}"], facts[f"r{k}"]
        about = facts[f"I{k}"] - mass * reach**2
        links.append(_LINK.format(z=-reach, mass=mass, about=about))
    text = _PENDULUM.format(upper=links[0], lower=links[1], length=-facts["l1"])
    (folder / "robot.urdf").write_text(text)
    runs = _copied(source, folder, ("run1", "run2"), "fit")
    runs += _copied(source, folder, ("run3", "run4"), "validate")
    return {"robot": "robot.urdf", "joints": ["joint1", "joint2"], "recordings": runs}


def _so101(source: Path, folder: Path) -> dict[str, Any]:
    fit = (
        *("chirp_sweep", "frequency_sweep", "pick_place", "random_waypoints", "slow_precision"),
        *("static_holding", "trapezoidal_profile"),
    )
    held_out = ("multisine", "single_joint_elbow", "step_response")
    runs = _copied(source, folder, fit, "fit") + _copied(source, folder, held_out, "validate")
    joints = ["rotation", "pitch", "elbow", "wrist_pitch", "wrist_roll", "jaw"]
    return {"joints": joints, "recordings": runs}


MACHINES = (
    Machine(
        name="ur10_unisa",
        title="UR10, 27 s at 125 Hz",
        withheld="All friction, the rotors' inertia and what else a rigid body lacks. The model's"
        " masses and inertias are public figures that nobody checked on this arm.",
        doubtful="Torque is current times a gain from elsewhere. There is one recording: the last"
        " 30 % of it is held out, so no other speed, load or pose is.",
        build=_ur10,
    ),
    Machine(
        name="dfki_double_pendulum",
        title="Double pendulum with AK80-6 drives, 4 x 10 s at about 450 Hz",
        withheld="All friction, the rotors' inertia and the drives' own errors. Masses, lengths and"
        " inertias are those its builders identified.",
        doubtful="The reported torque is itself doubtful.",
        build=_pendulum,
    ),
    Machine(
        name="so101_sage",
        title="SO-101 with hobby servos, 10 motions at 50 Hz",
        withheld="Everything: there is no model of the arm and no torque, only commands and"
        " positions. Known from elsewhere: commands act about 0.1 s late, about a degree of"
        " stiction or play.",
        doubtful="Without torques or the servos' gains friction, play, loads and inertias cannot be"
        " told apart.",
        build=_so101,
    ),
    Machine(
        name="panda_unisa",
        title="Franka Panda, 24 s at 30 Hz",
        withheld="The little friction that torque sensors on the link's side still see, and what"
        " else a rigid body lacks. Masses and inertias are figures identified on another Panda.",
        doubtful="Accelerations are poor at 30 Hz. There is one recording: the last 30 % of it is"
        " held out.",
        build=_panda,
    ),
)
