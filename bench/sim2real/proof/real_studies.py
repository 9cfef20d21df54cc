"""Studies of real machines' recordings, what their models leave out, and what is known of them.

A known fact takes a diagnosis, and gives what that says of it in words and whether it agrees.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import yaml

import pdoik
from bench.ik.judges.arm_meshes import go2_urdf
from bench.sim2real.servo import study as servo
from pdoik.sim2real.effects import CATALOGUE

Content = Mapping[str, Any]
Said = tuple[str, bool]

FRICTION = {each.id for each in CATALOGUE.values() if each.family == "friction"} | {
    "gear_efficiency"
}
LOADS = {"payload": "mass", "link_inertial_error": "d_mass"}
DELAYS = ("command_delay", "actuator_lag")


def friction_everywhere(diagnosis: Content) -> Said:
    """Friction of some kind at every joint that is judged."""
    judged = [name for name, each in diagnosis["joints"].items() if each["excited"]]
    rubbing = {j for f in _findings(diagnosis, FRICTION) for j in f["joints"]}
    missing = [name for name in judged if name not in rubbing]
    words = f"friction at {len(judged) - len(missing)} of {len(judged)} joints"
    return words + (f", not {', '.join(missing)}" if missing else ""), not missing


def friction_within(diagnosis: Content, least: float, most: float) -> Said:
    """Levels of dry friction, where they are told, within bounds [N m]."""
    levels = [
        f["parameters"]["level"]["value"]
        for f in _findings(diagnosis, FRICTION)
        if "level" in f["parameters"]
    ]
    if not levels:
        return "no dry friction", False
    words = f"{len(levels)} levels, {min(levels):.2g} to {max(levels):.2g} N m"
    return words, least <= min(levels) and max(levels) <= most


def no_load_beyond(diagnosis: Content, most: float) -> Said:
    """No mass that was not there, but for so much [kg]."""
    found = [
        (f["links"][0], f["parameters"][LOADS[f["effect"]]]["value"])
        for f in _findings(diagnosis, LOADS)
        if LOADS[f["effect"]] in f["parameters"]
    ]
    words = ", ".join(f"{mass:+.2g} kg at {link}" for link, mass in found)
    return words or "no mass", all(abs(mass) <= most for _, mass in found)


def delay_between(diagnosis: Content, least: float, most: float) -> Said:
    """Delay and lag of commands together at every joint, of those that are told [s]."""
    late: dict[str, float] = {}
    for f in _findings(diagnosis, DELAYS):
        for joint in f["joints"]:
            told = sum(each["value"] for each in f["parameters"].values())
            late[joint] = late.get(joint, 0.0) + told
    if not late:
        return "no delay", False
    words = f"{len(late)} joints, {min(late.values()):.2g} to {max(late.values()):.2g} s"
    return words, all(least <= each <= most for each in late.values())


def none_of(diagnosis: Content, effects: Sequence[str], joints: Sequence[str] = ()) -> Said:
    """None of these names, at some joints or anywhere."""
    wrong = [
        f"{f['effect']} at {', '.join(f['joints'])}"
        for f in _findings(diagnosis, effects)
        if not joints or set(f["joints"]) & set(joints)
    ]
    return "; ".join(wrong) or "none of it", not wrong


def _findings(diagnosis: Content, effects: Any) -> list[Content]:
    return [each for each in diagnosis["findings"] if each["effect"] in effects]


ROBOTS = Path(pdoik.__file__).parent / "robots"


@dataclass(frozen=True, slots=True, kw_only=True)
class Machine:
    """A machine whose recordings may be there."""

    name: str  # of the recordings' folder
    title: str
    withheld: str  # the physics that its model does not have
    doubtful: str  # what keeps these recordings from proving more
    known: dict[str, Callable[[Content], Said]]  # facts, and whether a diagnosis agrees
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
        known={
            "every joint of a geared arm rubs": friction_everywhere,
            "friction of joints 1 to 3 passes smoothly through zero speed (its authors)": partial(
                none_of,
                effects=("stribeck_friction",),
                joints=("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"),
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
            "both drives rub": friction_everywhere,
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
                delay_between, least=0.04, most=0.16
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
            "a geared servo rubs": friction_everywhere,
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
            "its authors' simulation: dry 0.2, damping 0.6 N m s/rad": partial(
                friction_within, least=0.05, most=0.6
            ),
            "nothing was added to it": partial(no_load_beyond, most=0.3),
        },
        build=_go2,
    ),
)
