"""What a machine is made of: a figure per joint, by name, for drive, rotor, bearing, gear, link.

The figures of all joints are one array, so that compiled code can read them; a fault is a change
of some of them, from the start or from a time on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_FIGURES = {
    # drive; torques are as the drive's own computer believes them, seen at the joint
    "gain": "true torque of a believed one; 1",
    "lag": "time constant of the current loop [s]",
    "limit": "largest torque [N m]",
    "stall": "torque that the voltage gives at rest [N m]",
    "no_load": "speed at which the voltage gives none [rad/s]",
    "cogging": "amplitude of the torque that depends on the rotor's angle [N m]",
    "cogging_cycles": "its cycles per turn of the joint",
    "cogging_phase": "[rad]",
    "rotor": "inertia of rotor and gear seen at the joint [kg m^2]",
    # bearing and seals: LuGre bristles, a Stribeck curve, sublinear viscosity
    "coulomb": "level [N m]",
    "stiction": "more than the level at rest [N m]",
    "stribeck_speed": "[rad/s]",
    "stribeck_shape": "exponent",
    "viscous": "torque at 1 rad/s [N m]",
    "viscous_power": "exponent of the speed",
    "load_share": "friction per torque through the gear",
    "asymmetry": "more one way than the other, of the level",
    "bristle": "deflection before sliding [rad]",
    "turn_share": "of the level, once per turn of the joint",
    "turn_phase": "[rad]",
    "warm": "viscosity lost per kelvin [1/K]",
    "warm_level": "level lost per kelvin [1/K]",
    # gear
    "stiffness": "[N m/rad]",
    "hardening": "more stiffness per square of the twist [N m/rad^3]",
    "gear_damping": "[N m s/rad]",
    "gap": "backlash, whole [rad]",
    "hysteresis": "level of the gear's inner friction [N m]",
    "hysteresis_twist": "twist over which it builds up [rad]",
    "loss_driving": "torque lost per torque when the motor drives",
    "loss_driven": "when the load drives",
    "error": "kinematic error, amplitude [rad]",
    "error_cycles": "per turn of the joint",
    "error_phase": "[rad]",
    "coupled": "turns per turn of the joint before",
    # link
    "spring": "of cables or a balancer [N m/rad]",
    "spring_onset": "[rad]",
    "spring_side": "1 pulls above the onset, -1 below, 0 everywhere",
    "drag": "per square of the speed [N m s^2/rad^2]",
    "snag": "hysteresis of a cable that is dragged along [N m]",
    "snag_reach": "[rad]",
    "brake": "drag of a brake that touches now and then [N m]",
    "slip": "torque above which the link slips on its shaft [N m]; 0: never",
    # encoder
    "offset": "reading at zero [rad]",
    "delay": "of the commands [s]",
}

NAMES = tuple(_FIGURES)
COUNT = len(NAMES)
INDEX = {name: k for k, name in enumerate(NAMES)}

_WHOLE = {
    "gravity_x": 0.0,  # [m/s^2]
    "gravity_y": 0.0,
    "gravity_z": -9.81,
    "mode_mass": 0.0,  # of a mass on a spring at the tip: structure, or a liquid [kg]
    "mode_rate": 100.0,  # [rad/s]
    "mode_loss": 0.02,  # damping ratio
    "mode_x": 1.0,  # direction in the last link's frame
    "mode_y": 0.0,
    "mode_z": 0.0,
    "spin": 0.0,  # angular momentum of a tool about the last link's x axis [kg m^2/s]
    "sag": 0.0,  # of the drives' gain per sum of relative torques
    "rattle": 0.0,  # half of the play of a loose mass along the mode's direction [m]
}
"""Figures of the whole machine and their defaults."""

WHOLE_NAMES = tuple(_WHOLE)
WHOLE_INDEX = {name: k for k, name in enumerate(WHOLE_NAMES)}


class Figures:
    """A machine's figures, by name; copies are changed, never the original."""

    def __init__(self, joints: Array, whole: Array) -> None:
        self.joints, self.whole = joints, whole

    @classmethod
    def empty(cls, n: int) -> Figures:
        """A machine without physics: everything zero but what cannot be."""
        figures = cls(np.zeros((n, COUNT)), np.array(list(_WHOLE.values())))
        ones = {"gain": 1.0, "lag": 1e-3, "limit": 1e6, "stall": 1e6, "no_load": 1e6}
        ones |= {"rotor": 0.1, "stribeck_speed": 0.1, "stribeck_shape": 1.0, "viscous_power": 1.0}
        ones |= {"bristle": 1e-3, "stiffness": 1e4, "gear_damping": 1.0, "snag_reach": 0.1}
        ones |= {"hysteresis_twist": 1e-3}
        for name, value in ones.items():
            figures.joints[:, INDEX[name]] = value
        return figures

    def of(self, name: str) -> Array:
        """One figure of all joints, (n,)."""
        return self.joints[:, INDEX[name]]

    def with_joint(self, joint: int, **values: float) -> Figures:
        """Another machine in which one joint has other figures."""
        joints = self.joints.copy()
        for name, value in values.items():
            joints[joint, INDEX[name]] = value
        return Figures(joints, self.whole)

    def with_whole(self, **values: float) -> Figures:
        """Another machine with other figures of the whole."""
        whole = self.whole.copy()
        for name, value in values.items():
            whole[WHOLE_INDEX[name]] = value
        return Figures(self.joints, whole)
