"""What is hidden in a joint: the changed machine, and the answer.

Sizes go by what the motions ask of the joint (`Robot.load`, `Robot.speed`), so that they matter
beside the sensors' noise and are none that one sees with the naked eye.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.sim2real.legged.hidden import Hidden
from bench.sim2real.legged.machine import Machine

Draw = Callable[["Scene"], tuple[Machine, Hidden]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """The machine so far, random numbers, and torques of the machine without what is hidden."""

    machine: Machine
    rng: np.random.Generator
    peaks: Callable[[], np.ndarray]  # (n,) what the commands ask for at most [N m]

    def joint(self) -> int:
        """Any."""
        return int(self.rng.integers(self.machine.robot.n))

    def sign(self) -> float:
        """Either."""
        return float(self.rng.choice([-1.0, 1.0]))


def _told(scene: Scene, effect: str, j: int, **parameters: float) -> Hidden:
    return Hidden(effect=effect, joints=(scene.machine.robot.joints[j],), parameters=parameters)


def coulomb_friction(scene: Scene) -> tuple[Machine, Hidden]:
    """Dry friction, beside what there is."""
    machine, j = scene.machine, scene.joint()
    level = float(scene.rng.uniform(0.15, 0.4) * machine.robot.load[j])
    total = float(machine.coulomb[j]) + level
    return machine.at("coulomb", j, total), _told(scene, "coulomb_friction", j, level=total)


def viscous_friction(scene: Scene) -> tuple[Machine, Hidden]:
    """Friction in proportion to speed, beside what there is."""
    machine, j, robot = scene.machine, scene.joint(), scene.machine.robot
    total = float(
        machine.viscous[j] + scene.rng.uniform(0.2, 0.45) * robot.load[j] / robot.speed[j]
    )
    return machine.at("viscous", j, total), _told(scene, "viscous_friction", j, coefficient=total)


def torque_gain(scene: Scene) -> tuple[Machine, Hidden]:
    """A motor that is weaker than its drive says, seldom one that is stronger."""
    machine, j, rng = scene.machine, scene.joint(), scene.rng
    share = float(rng.uniform(0.7, 0.88) if rng.random() < 0.8 else rng.uniform(1.12, 1.25))
    gain = float(machine.sensor_gain[j]) / share
    return machine.at("drive_gain", j, share), _told(scene, "torque_gain", j, gain=gain)


def torque_offset(scene: Scene) -> tuple[Machine, Hidden]:
    """A torque sensor whose zero is off."""
    machine, j = scene.machine, scene.joint()
    extra = scene.sign() * scene.rng.uniform(0.2, 0.45) * machine.robot.load[j]
    total = float(machine.sensor_offset[j] + extra)
    return machine.at("sensor_offset", j, total), _told(scene, "torque_offset", j, offset=total)


def rotor_inertia(scene: Scene) -> tuple[Machine, Hidden]:
    """A rotor that is heavier than told."""
    machine, j = scene.machine, scene.joint()
    rotor = float(machine.rotor[j] + scene.rng.uniform(0.8, 2.0) * machine.robot.rotor[j])
    extra = rotor - float(machine.robot.rotor[j])
    return machine.at("rotor", j, rotor), _told(scene, "rotor_inertia", j, inertia=extra)


def joint_offset(scene: Scene) -> tuple[Machine, Hidden]:
    """An encoder whose zero is off."""
    machine, j = scene.machine, scene.joint()
    offset = float(scene.sign() * scene.rng.uniform(0.03, 0.08))
    return machine.at("joint_offset", j, offset), _told(scene, "joint_offset", j, offset=offset)


def position_dependent_spring(scene: Scene) -> tuple[Machine, Hidden]:
    """A cable that pulls the joint to some angle."""
    machine, j, robot = scene.machine, scene.joint(), scene.machine.robot
    stiffness = float(scene.rng.uniform(0.3, 0.7) * robot.load[j] / 0.35)
    onset = float(robot.rest[j] + scene.rng.uniform(-0.25, 0.25))
    changed = machine.at("spring", j, stiffness).at("spring_rest", j, onset)
    figures = {"stiffness": stiffness, "onset": onset, "side": 0.0}
    return changed, _told(scene, "position_dependent_spring", j, **figures)


def torque_saturation(scene: Scene) -> tuple[Machine, Hidden]:
    """A drive that gives less at most than the motions ask for."""
    machine, j = scene.machine, scene.joint()
    level = float(scene.rng.uniform(0.65, 0.9) * scene.peaks()[j])
    return machine.at("limit", j, level), _told(scene, "torque_saturation", j, level=level)


def command_delay(scene: Scene) -> tuple[Machine, Hidden]:
    """A drive that gets its commanded positions late."""
    machine, j = scene.machine, scene.joint()
    delay = 1e-3 * float(scene.rng.integers(4, 13)) * 2.0
    return machine.at("delay", j, delay), _told(scene, "command_delay", j, delay=delay)


def backlash(scene: Scene) -> tuple[Machine, Hidden]:
    """Play between motor and link."""
    machine, j = scene.machine, scene.joint()
    gap = float(scene.rng.uniform(0.012, 0.035))
    return machine.at("gap", j, gap), _told(scene, "backlash", j, gap=gap)
