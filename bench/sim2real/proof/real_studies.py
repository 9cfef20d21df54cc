"""Studies of real machines' recordings, and what their models leave out."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

import pdoik
from bench.ik.judges.arm_meshes import go2_urdf
from bench.sim2real.proof.real_truths import (
    Known,
    delay_between,
    friction_everywhere,
    friction_within,
    no_load_beyond,
    none_of,
)
from bench.sim2real.servo import study as servo

ROBOTS = Path(pdoik.__file__).parent / "robots"


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine whose recordings may be there."""

    name: str  # of the recordings' folder
    title: str
    withheld: str  # the physics that its model does not have
    doubtful: str  # what keeps these recordings from proving more
    known: tuple[Known, ...]  # what is known to be true, and whether a diagnosis agrees
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


def _servo(source: Path, folder: Path) -> dict[str, Any]:
    (folder / "robot.urdf").write_text(servo.URDF.format(z=-servo.LENGTH, mass=servo.MASS))
    names = tuple(f"kp{servo.GAINS[-1]}_{each}" for each in servo.MOTIONS)
    runs = _copied(source, folder, names, "")
    return {"robot": "robot.urdf", "joints": ["joint1"], "recordings": runs}


def _go2(source: Path, folder: Path) -> dict[str, Any]:
    shutil.copyfile(go2_urdf(), folder / "robot.urdf")
    legs = ("FL", "FR", "RL", "RR")
    joints = [f"{leg}_{part}_joint" for leg in legs for part in ("hip", "thigh", "calf")]
    return {
        "robot": "robot.urdf",
        "joints": joints,
        "recordings": _copied(source, folder, ("run1",), ""),
        "controller": {"type": "pd", "kp": [20.0] * 12, "kd": [1.5] * 12},
    }


MACHINES = (
    Machine(
        name="ur10_unisa",
        title="UR10, 27 s at 125 Hz",
        withheld="All friction, the rotors' inertia and what else a rigid body lacks. The model's"
        " masses and inertias are public figures that nobody checked on this arm.",
        doubtful="Torque is current times a gain from elsewhere. There is one recording: the last"
        " 30 % of it is held out, so no other speed, load or pose is.",
        known=(
            friction_everywhere("every joint of a geared arm rubs"),
            none_of(
                ("stribeck_friction",),
                "friction of joints 1 to 3 passes smoothly through zero speed (its authors)",
                ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"),
            ),
            no_load_beyond(0.5, "it holds nothing"),
        ),
        build=_ur10,
    ),
    Machine(
        name="dfki_double_pendulum",
        title="Double pendulum with AK80-6 drives, 4 x 10 s at about 450 Hz",
        withheld="All friction, the rotors' inertia and the drives' own errors. Masses, lengths and"
        " inertias are those its builders identified.",
        doubtful="The reported torque is itself doubtful.",
        known=(
            friction_everywhere("both drives rub"),
            no_load_beyond(0.1, "its builders identified its masses"),
        ),
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
        known=(
            delay_between(0.04, 0.16, "commands act about 0.1 s late (its authors)"),
            no_load_beyond(0.0, "no torque was logged: masses cannot be told"),
        ),
        build=_so101,
    ),
    Machine(
        name="panda_unisa",
        title="Franka Panda, 24 s at 30 Hz",
        withheld="The little friction that torque sensors on the link's side still see, and what"
        " else a rigid body lacks. Masses and inertias are figures identified on another Panda.",
        doubtful="Accelerations are poor at 30 Hz. There is one recording: the last 30 % of it is"
        " held out.",
        known=(
            no_load_beyond(0.5, "it holds nothing"),
            none_of(("backlash", "torque_saturation", "command_delay"), "a sound new arm"),
        ),
        build=_panda,
    ),
    Machine(
        name="bam_xl330",
        title="Dynamixel XL330 that swings a point load, 4 x 6 s at about 190 Hz",
        withheld="The motor (torque per volt, resistance, rotor), its friction, the firmware.",
        doubtful="Torque is known as a duty only: masses and drive are known by their ratio.",
        known=(
            no_load_beyond(0.05, "the load is weighed and measured: 0.49 kg at 0.1 m"),
            friction_everywhere("a geared servo rubs"),
            none_of(("sensor_gain", "joint_offset", "torque_gain"), "nothing else was concealed"),
        ),
        build=_servo,
    ),
    Machine(
        name="go2_hanging",
        title="Unitree Go2 hung up, 12 joints, 23 s at 200 Hz",
        withheld="Friction, rotors and damping of all joints. Nothing was concealed.",
        doubtful="No torque was logged: it is the drives' law on commands and positions. There is"
        " one recording.",
        known=(
            friction_within(0.05, 0.6, "its authors' simulation: dry 0.2, damping 0.6 N m s/rad"),
            no_load_beyond(0.3, "nothing was added to it"),
        ),
        build=_go2,
    ),
)
