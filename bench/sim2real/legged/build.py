"""Build a study folder from a spec: draw the machine, hide something, let it move, write files."""

from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from bench.sim2real.frame.study_files import write_study, write_truth
from bench.sim2real.legged import draw_base, draw_joint
from bench.sim2real.legged.draw_joint import Draw, Scene, at_a_joint
from bench.sim2real.legged.gait import Trot
from bench.sim2real.legged.legs import Legs
from bench.sim2real.legged.machine import FRICTION, Hidden, Machine, as_given, dense
from bench.sim2real.legged.postures import hang, home, stand
from bench.sim2real.legged.robots import Robot, robot
from bench.sim2real.legged.run import FallenError, Policy, Rows, simulate
from bench.sim2real.legged.sensors import Sensors, measured, sensors, write_log
from bench.sim2real.legged.spec import HEALTHY, JOINT_KINDS, KINDS, Array, Spec
from bench.sim2real.legged.visibility import visibility
from bench.sim2real.legged.world import GRAVITY, build, massive_links

SCHEMA = "pdoik.legged/1"
ATTEMPTS = 8  # at something that the robot bears
FIT, VALIDATE = "fit", "validate"
PLANS = {
    "go2": {FIT: ("trot", "stand", "hang"), VALIDATE: ("trot", "stand")},
    "h1": {FIT: ("stand", "hang", "stand"), VALIDATE: ("stand", "hang")},
}
"""Motions of the recordings by their role."""

DRAWS: dict[str, Draw] = {
    **{kind: at_a_joint(getattr(draw_joint, kind)) for kind in JOINT_KINDS},
    **{kind: getattr(draw_base, kind) for kind in KINDS if kind not in JOINT_KINDS},
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Take:
    """One recording to be made."""

    motion: str
    role: str
    seconds: float
    hold: Array | None  # pose of the held base

    @property
    def entry(self) -> dict[str, str]:
        """What the study says of it, but for its file."""
        return {"role": self.role, **({} if self.hold is None else {"base": "held"})}


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """A world that was moved."""

    spec: Spec
    machine: Machine
    hidden: tuple[Hidden, ...]
    takes: list[Take]
    rows: list[Rows]
    sensors: Sensors
    attempts: int  # until it stayed up


@cache
def legs_of(name: str) -> Legs:
    return Legs(robot(name))


def background(spec: Spec) -> Machine:
    """The machine before anything is hidden in it."""
    kind = robot(spec.robot)
    if spec.background == "plain":
        return as_given(kind)
    return dense(kind, massive_links(kind), spec.stream("machine"))


def takes_of(spec: Spec) -> list[Take]:
    """The recordings, with times and held poses drawn."""
    rng, takes = spec.stream("takes"), []
    plan = [(motion, role) for role, motions in PLANS[spec.robot].items() for motion in motions]
    for motion, role in plan:
        seconds = spec.seconds or float(np.round(rng.uniform(15.0, 18.0)))
        tilt = Rotation.from_euler("xyz", rng.uniform(-0.25, 0.25, 3)).as_quat(scalar_first=True)
        pose = np.concatenate([rng.uniform(-0.1, 0.1, 2), rng.uniform(1.1, 1.4, 1), tilt])
        takes.append(
            Take(motion=motion, role=role, seconds=seconds, hold=pose if motion == "hang" else None)
        )
    return takes


def policy_of(spec: Spec, index: int, take: Take) -> Policy:
    legs, rng = legs_of(spec.robot), spec.stream(f"motion{index}")
    if take.hold is not None:
        return hang(legs, take.hold, take.seconds, rng)
    if take.motion == "trot":
        return Trot(legs, take.seconds, rng)
    return stand(legs, take.seconds, rng)


def moved(spec: Spec, machine: Machine, takes: list[Take], rate: int) -> list[Rows]:
    """All takes."""
    rows = []
    for index, take in enumerate(takes):
        policy = policy_of(spec, index, take)
        start = _start(machine.robot, machine, policy, take)
        rows.append(simulate(build(machine, take.hold), policy, take.seconds, rate, start))
    return rows


def _start(kind: Robot, machine: Machine, policy: Policy, take: Take) -> tuple[Array, Array]:
    base, feet = home(kind)
    if take.hold is not None:
        return take.hold, policy.command(0.0, None)  # type: ignore[arg-type]
    q = legs_of(kind.name).solved(base, kind.rest.copy(), feet, steps=15)
    base[2] += machine.ground
    return base, q


def made(spec: Spec) -> Made:
    """Draws and moves the world, again where the robot does not bear what is hidden."""
    before, takes = background(spec), takes_of(spec)
    legs = legs_of(spec.robot)
    weight = GRAVITY * float(legs.model.body_mass.sum())
    sense = sensors(before, weight, spec.stream("sensors"))

    def peaks() -> Array:
        first = moved(spec, before, takes[:2], sense.rate)
        asked = np.concatenate([np.abs(rows.tau_cmd) for rows in first])
        return np.asarray(np.quantile(asked, 0.998, axis=0))

    said = ""
    for attempt in range(ATTEMPTS):
        machine: Machine = before
        hidden: tuple[Hidden, ...] = ()
        if spec.kind != HEALTHY:
            rng = spec.stream(f"{spec.kind}{attempt}")
            machine, one = DRAWS[spec.kind](Scene(machine=before, rng=rng, peaks=peaks))
            hidden = (one,)
        try:
            rows = moved(spec, machine, takes, sense.rate)
        except FallenError as error:
            said = str(error)
            if spec.kind == HEALTHY:
                break
            continue
        return Made(
            spec=spec,
            machine=machine,
            hidden=hidden,
            takes=takes,
            rows=rows,
            sensors=sense,
            attempts=attempt + 1,
        )
    raise FallenError(f"{spec.name}: {said}")


def truth_of(world: Made) -> dict[str, Any]:
    spec, machine = world.spec, world.machine
    return {
        "schema": SCHEMA,
        "spec": asdict(spec),
        "effects": [each.to_json() for each in world.hidden],
        "joints": list(machine.robot.joints),
        "feet": list(machine.robot.feet),
        "base": machine.robot.base,
        "mass": float(legs_of(spec.robot).model.body_mass.sum()),
        "background": background(spec).facts(),
        "machine": machine.facts(),
        "sensors": world.sensors.facts(),
        "motions": [take.motion for take in world.takes],
        "attempts": world.attempts,
        "visibility": visibility(legs_of(spec.robot), world.rows, world.sensors.tau),
    }


def make_study(folder: Path, spec: Spec, truth_folder: Path | None = None) -> Made:
    """Writes study.yaml, robot.urdf and recordings; the truth only where asked for."""
    world = made(spec)
    if truth_folder is not None:
        write_truth(truth_folder, folder, truth_of(world))
    folder.mkdir(parents=True, exist_ok=True)
    entries = []
    for k, (take, rows) in enumerate(zip(world.takes, world.rows, strict=True)):
        rng, name = spec.stream(f"noise{k}"), f"rec{k + 1}.csv"
        held = take.hold is not None
        write_log(folder / name, measured(rows, world.machine, world.sensors, rng, held=held))
        entries.append({"file": name, **take.entry})
    kind = world.machine.robot
    write_study(folder, kind.urdf.read_text(), study_of(kind, entries))
    return world


def study_of(kind: Robot, recordings: list[dict[str, str]]) -> dict[str, Any]:
    return {
        "robot": "robot.urdf",
        "joints": list(kind.joints),
        "recordings": recordings,
        "controller": {
            "type": "pd",
            "kp": kind.kp.tolist(),
            "kd": kind.kd.tolist(),
            "gravity_compensation": False,
            "torque_limit": kind.effort.tolist(),
        },
        "rotor_inertia": kind.rotor.tolist(),
        "base": {
            "imu": {"position": list(kind.imu_position), "rpy": list(kind.imu_rpy)},
            "feet": {foot: {"sole": kind.sole} for foot in kind.feet},
            "ground": {"friction": FRICTION, "height": 0.0},
        },
    }
