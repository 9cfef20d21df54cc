"""A real hobby arm: what `pdoik compare` finds from positions alone, of a public simulator.

    python -m bench.sim2real.simulators.so101 SHARED/recordings/so101_sage
    python -m bench.sim2real.simulators.so101 SHARED/recordings/so101_sage --figures so101

Nobody knows the servos' gains. So the user's simulator is so101.urdf of example-robot-data with
the figures of one of two public simulators of such arms. Two whole motions are held out. The jaw
is left out: it was logged as a share of its range, and the simulator holds it.
"""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import mujoco
import numpy as np
import typer

from bench.common.descriptions import published
from bench.sim2real.simulators.robots import compared, position_servos, told_of
from pdoik.sim2real.simulation import build_plant, mjcf_text, movable_joints, read_description

LOGGED = {
    "shoulder_pan": "rotation",
    "shoulder_lift": "pitch",
    "elbow_flex": "elbow",
    "wrist_flex": "wrist_pitch",
    "wrist_roll": "wrist_roll",
}
"""What the log calls the joints, by the description's names; signs and zeros are the same."""
HELD_OUT = ("pick_place", "random_waypoints")
CHANNELS = ("q", "dq", "q_des")


@dataclass(frozen=True, slots=True, kw_only=True)
class Figures:
    """Figures of every joint alike."""

    kp: float  # [N m/rad]
    kv: float | None  # [N m s/rad]; None: critically damped, as MuJoCo's dampratio="1" says
    limit: float  # of the torque [N m]
    damping: float  # [N m s/rad]
    frictionloss: float  # [N m]
    armature: float  # [kg m^2]
    timestep: float  # [s]


class Public(StrEnum):
    """Whose figures they are."""

    SO_ARM100 = "so_arm100"
    SO101 = "so101"


FIGURES = {
    # trs_so_arm100 of github google-deepmind/mujoco_menagerie @ f3475402
    Public.SO_ARM100: Figures(
        kp=50.0, kv=None, limit=3.5, damping=0.0, frictionloss=0.1, armature=0.1, timestep=2e-3
    ),
    # robotstudio_so101 of the same @ 191a7ba5
    Public.SO101: Figures(
        kp=998.22,
        kv=2.731,
        limit=2.94,
        damping=0.6,
        frictionloss=0.052,
        armature=0.028,
        timestep=5e-3,
    ),
}


def simulator(figures: Figures) -> str:
    """MJCF of the arm without its shapes, under position actuators."""
    urdf = published("so_arm_description/urdf/so101.urdf")
    joints = movable_joints(read_description(urdf))
    plant = build_plant(urdf, joints)
    model, dof = plant.model, list(plant.dof)
    model.dof_damping[dof], model.dof_frictionloss[dof] = figures.damping, figures.frictionloss
    model.dof_armature[dof] = figures.armature
    mujoco.mj_setConst(model, mujoco.MjData(model))
    critical = 2.0 * np.sqrt(figures.kp * model.dof_M0[dof])
    damped = critical if figures.kv is None else np.full(len(dof), figures.kv)
    limits = f"{-figures.limit:g} {figures.limit:g}"
    servos = position_servos(joints, [figures.kp] * len(dof), damped, forcerange=limits)
    return mjcf_text(model, actuators=servos, timestep=figures.timestep)


def study(folder: Path) -> dict[str, Any]:
    """The keys of the YAML as a user would write it, but for the simulator."""
    files = sorted(folder.resolve().glob("*.csv"))
    return {
        "joints": list(LOGGED),
        "columns": {
            channel: {joint: f"{channel}.{name}" for joint, name in LOGGED.items()}
            for channel in CHANNELS
        },
        "ignore": [f"{channel}.jaw" for channel in CHANNELS],
        "recordings": [
            {"file": str(file), "role": "validate" if file.stem in HELD_OUT else "fit"}
            for file in files
        ],
    }


def main(
    folder: Annotated[Path, typer.Argument(help="With the recordings.")],
    figures: Annotated[Public, typer.Option(help="Public simulator.")] = Public.SO_ARM100,
) -> None:
    """Compare, print the table and what was found."""
    typer.echo(told_of(compared(simulator(FIGURES[figures]), study(folder))))


if __name__ == "__main__":
    typer.run(main)
