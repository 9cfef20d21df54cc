"""What is hidden in a joint: changed figures of the machine, and how they are reported.

Sizes go by what the motions ask of the joint (`Robot.load`, `Robot.speed`), so that they matter
compared with the sensors' noise and are none that one sees with the naked eye.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bench.sim2real.legged.machine import Hidden, Machine

Figures = dict[str, float]
Draw = Callable[["Scene"], tuple[Machine, Hidden]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """The machine so far, random numbers, and torques of the machine without what is hidden."""

    machine: Machine
    rng: np.random.Generator
    peaks: Callable[[], np.ndarray]  # (n,) what the commands ask for at most [N m]

    def sign(self) -> float:
        return float(self.rng.choice([-1.0, 1.0]))

    def share(self, low: float, high: float, j: int) -> float:
        """A random share of a joint's load [N m]."""
        return self.rng.uniform(low, high) * self.machine.robot.load[j]


def at_a_joint(make: Callable[[Scene, int], tuple[Figures, Figures]]) -> Draw:
    """Draw an effect at any joint; the effect has the function's name."""

    def draw(scene: Scene) -> tuple[Machine, Hidden]:
        machine, robot = scene.machine, scene.machine.robot
        j = int(scene.rng.integers(robot.n))
        figures, said = make(scene, j)
        for name, value in figures.items():
            machine = machine.at(name, j, value)
        return machine, Hidden(effect=make.__name__, joints=(robot.joints[j],), parameters=said)

    return draw


def coulomb_friction(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """Dry friction, in addition to what there is."""
    total = float(scene.machine.coulomb[j]) + float(scene.share(0.15, 0.4, j))
    return {"coulomb": total}, {"level": total}


def viscous_friction(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """Friction in proportion to speed, in addition to what there is."""
    machine = scene.machine
    total = float(machine.viscous[j] + scene.share(0.2, 0.45, j) / machine.robot.speed[j])
    return {"viscous": total}, {"coefficient": total}


def torque_gain(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """A motor that is weaker than its drive says, seldom one that is stronger."""
    rng = scene.rng
    share = float(rng.uniform(0.7, 0.88) if rng.random() < 0.8 else rng.uniform(1.12, 1.25))
    return {"drive_gain": share}, {"gain": float(scene.machine.sensor_gain[j]) / share}


def torque_offset(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """A torque sensor whose zero is off."""
    extra = scene.sign() * scene.rng.uniform(0.2, 0.45) * scene.machine.robot.load[j]
    total = float(scene.machine.sensor_offset[j] + extra)
    return {"sensor_offset": total}, {"offset": total}


def rotor_inertia(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """A rotor that is heavier than given."""
    given = scene.machine.robot.rotor[j]
    rotor = float(scene.machine.rotor[j] + scene.rng.uniform(0.8, 2.0) * given)
    return {"rotor": rotor}, {"inertia": rotor - float(given)}


def joint_offset(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """An encoder whose zero is off."""
    offset = float(scene.sign() * scene.rng.uniform(0.03, 0.08))
    return {"joint_offset": offset}, {"offset": offset}


def position_dependent_spring(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """A cable that pulls the joint to some angle."""
    stiffness = float(scene.share(0.3, 0.7, j) / 0.35)
    onset = float(scene.machine.robot.rest[j] + scene.rng.uniform(-0.25, 0.25))
    parameters = {"stiffness": stiffness, "onset": onset, "side": 0.0}
    return {"spring": stiffness, "spring_rest": onset}, parameters


def torque_saturation(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """A drive that gives less at most than the motions ask for."""
    level = float(scene.rng.uniform(0.65, 0.9) * scene.peaks()[j])
    return {"limit": level}, {"level": level}


def command_delay(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """A drive that gets its commanded positions late."""
    delay = 1e-3 * float(scene.rng.integers(4, 13)) * 2.0
    return {"delay": delay}, {"delay": delay}


def backlash(scene: Scene, j: int) -> tuple[Figures, Figures]:
    """Play between motor and link."""
    gap = float(scene.rng.uniform(0.012, 0.035))
    return {"gap": gap}, {"gap": gap}
