"""Studies of real machines' recordings, what their models leave out, and what is known of them."""

import shutil
from functools import partial
from pathlib import Path
from typing import Any

import yaml

import pdoik
from bench.common.descriptions import go2_urdf
from bench.sim2real.proof.real_facts import (
    delay_between,
    friction_at,
    friction_within,
    no_load_beyond,
    none_of,
)
from bench.sim2real.proof.real_machine import Machine
from bench.sim2real.proof.real_strangers import STRANGERS
from bench.sim2real.servo import study as servo

ROBOTS = Path(pdoik.__file__).parent / "robots"


def _copied(source: Path, folder: Path, names: tuple[str, ...], role: str) -> list[dict[str, str]]:
    for name in names:
        shutil.copyfile(source / f"{name}.csv", folder / f"{name}.csv")
    return [{"file": f"{name}.csv", **({"role": role} if role else {})} for name in names]


UR10 = [
    f"{name}_joint"
    for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
]
SO101 = ["rotation", "pitch", "elbow", "wrist_pitch", "wrist_roll", "jaw"]
GO2 = [
    f"{leg}_{part}_joint" for leg in ("FL", "FR", "RL", "RR") for part in ("hip", "thigh", "calf")
]


def _ur10(source: Path, folder: Path) -> dict[str, Any]:
    shutil.copyfile(ROBOTS / "ur10.urdf", folder / "robot.urdf")
    runs = _copied(source, folder, ("run1",), "")
    return {"robot": "robot.urdf", "joints": UR10, "recordings": runs}


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
    return {"joints": SO101, "recordings": runs}


def _servo(source: Path, folder: Path) -> dict[str, Any]:
    (folder / "robot.urdf").write_text(servo.URDF.format(z=-servo.LENGTH, mass=servo.MASS))
    names = tuple(f"kp{servo.GAINS[-1]}_{each}" for each in servo.MOTIONS)
    runs = _copied(source, folder, names, "")
    return {"robot": "robot.urdf", "joints": ["joint1"], "recordings": runs}


def _go2(source: Path, folder: Path) -> dict[str, Any]:
    shutil.copyfile(go2_urdf(), folder / "robot.urdf")
    return {
        "robot": "robot.urdf",
        "joints": GO2,
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
        known={
            "every joint of a geared arm rubs": partial(friction_at, joints=UR10),
            "friction of joints 1 to 3 passes smoothly through zero speed (its authors)": partial(
                none_of,
                effects=("stribeck_friction",),
                joints=UR10[:3],
            ),
            "it holds nothing": partial(no_load_beyond, most=0.5),
        },
        build=_ur10,
    ),
    Machine(
        name="dfki_double_pendulum",
        title="Double pendulum with AK80-6 drives, 4 x 10 s at about 450 Hz",
        withheld="All friction, the rotors' inertia and the drives' own errors. Masses, lengths and"
        " inertias are those its builders identified.",
        doubtful="The reported torque is itself doubtful.",
        known={
            "both drives rub": partial(friction_at, joints=("joint1", "joint2")),
            "its builders identified its masses": partial(no_load_beyond, most=0.1),
        },
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
        known={
            "commands act about 0.1 s late (its authors)": partial(
                delay_between, joints=SO101, least=0.04, most=0.16
            ),
            "no torque was logged: masses cannot be told": partial(no_load_beyond, most=0.0),
        },
        build=_so101,
    ),
    Machine(
        name="panda_unisa",
        title="Franka Panda, 24 s at 30 Hz",
        withheld="The little friction that torque sensors on the link's side still see, and what"
        " else a rigid body lacks. Masses and inertias are figures identified on another Panda.",
        doubtful="Accelerations are poor at 30 Hz. There is one recording: the last 30 % of it is"
        " held out.",
        known={
            "it holds nothing": partial(no_load_beyond, most=0.5),
            "a sound new arm": partial(
                none_of, effects=("backlash", "torque_saturation", "command_delay")
            ),
        },
        build=_panda,
    ),
    Machine(
        name="bam_xl330",
        title="Dynamixel XL330 that swings a point load, 4 x 6 s at about 190 Hz",
        withheld="The motor (torque per volt, resistance, rotor), its friction, the firmware.",
        doubtful="Torque is known as a duty only: masses and drive are known by their ratio.",
        known={
            "the load is weighed and measured: 0.49 kg at 0.1 m": partial(
                no_load_beyond, most=0.05
            ),
            "a geared servo rubs": partial(friction_at, joints=("joint1",)),
            "nothing else was concealed": partial(
                none_of, effects=("sensor_gain", "joint_offset", "torque_gain")
            ),
        },
        build=_servo,
    ),
    Machine(
        name="go2_hanging",
        title="Unitree Go2 hung up, 12 joints, 23 s at 200 Hz",
        withheld="Friction, rotors and damping of all joints. Nothing was concealed.",
        doubtful="No torque was logged: it is the drives' law on commands and positions. There is"
        " one recording.",
        known={
            "every geared joint rubs": partial(friction_at, joints=GO2),
            "its authors' simulation: dry 0.2, damping 0.6 N m s/rad": partial(
                friction_within, least=0.05, most=0.6
            ),
            "nothing was added to it": partial(no_load_beyond, most=0.3),
        },
        build=_go2,
    ),
    *STRANGERS,
)
